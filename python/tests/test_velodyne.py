"""Velodyne's packets: closed forms in a room for all models and modes, damage, and real captures."""
from __future__ import annotations

import dataclasses
import math
import pathlib
import struct

import numpy as np
import pytest

import mutate_packets
import packet_files as pf
from packet_files import T0, Floats
from underbrush.errors import FormatError
from underbrush.formats import velodyne
from underbrush.formats.packets import PacketRecording
from velodyne_unit import MODES, UNITS, calibration_file, hdl64e_status, joined, observe, packets_of, save, vls128


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("name", UNITS)
def test_every_beam_in_a_room(tmp_path: pathlib.Path, name: str, mode: str) -> None:
    unit = UNITS[name]
    firings = 24 * max(12, 1440 // len(unit.elevation))
    truth = observe(unit, firings)
    path = save(tmp_path / "a.pcap", packets_of(unit, truth, MODES[mode]))
    metadata = calibration_file(tmp_path / "c.yaml", unit) if name == "hdl64e" else None
    recording = PacketRecording(path, metadata)
    assert recording.sensor == unit.sensor
    scans = list(recording.scans())
    assert not recording.skipped

    rows = joined(scans, "echo")
    beam = np.cumsum(rows <= 1) - 1
    assert beam[-1] + 1 == len(truth.ring) == firings * len(unit.elevation)
    assert (joined(scans, "ring") == truth.ring[beam]).all()
    assert np.abs(joined(scans, "beam_time_s") - truth.time_s[beam]).max() < 2e-6
    angle = np.arccos(np.clip((joined(scans, "direction") * truth.direction[beam]).sum(axis=1), -1, 1))
    assert np.degrees(angle).max() < 0.011  # Azimuths are in steps of 0.01 degrees.

    two = (truth.strongest != truth.last) & (truth.strongest > 0) & (truth.last > 0)
    first = truth.last if mode == "last" and name != "hdl64e" else truth.strongest
    if mode == "dual":
        first = np.where(truth.strongest > 0, truth.strongest, truth.last)
        assert (joined(scans, "echoes") == ((first > 0) + two.astype(int))[beam]).all()
        assert (rows[1:][beam[1:] == beam[:-1]] == 2).all() and two.sum() == (rows == 2).sum() > 0
        nearer = np.minimum(first, np.where(two, truth.last, first))
        expected = np.where(rows == 2, np.maximum(truth.last, truth.strongest)[beam], nearer[beam])
    else:
        expected = first[beam]
        assert (joined(scans, "echoes") == (first > 0)).all()
    range_m = np.where(expected > 0, expected * unit.step_m + unit.range_m, np.inf)
    assert (np.isinf(joined(scans, "range_m")) == (rows == 0)).all()
    assert joined(scans, "range_m") == pytest.approx(range_m, abs=1e-4)
    shade = np.where(expected == truth.strongest[beam], expected % 200, expected % 199)
    if mode != "last":
        assert (joined(scans, "intensity") == shade).all()
    hit = (rows == 1) & (expected == truth.strongest[beam])
    points = joined(scans, "direction")[hit] * joined(scans, "range_m")[hit][:, None]
    assert pf.off_walls(points).max() < 0.5 * unit.step_m + 0.005  # Angle of a step at 20 m.

    found = " ".join(recording.found())
    assert ("dual return" in found) == (mode == "dual")
    assert [scan.number for scan in scans] == list(range(len(scans)))


def test_revolutions_begin_at_the_rear(tmp_path: pathlib.Path) -> None:
    unit = UNITS["vlp16"]
    truth = observe(unit, 24 * 200)
    scans = list(PacketRecording(save(tmp_path / "a.pcap", packets_of(unit, truth, 0x37))).scans())
    assert len(scans) == 4
    for scan in scans[1:]:
        assert scan.direction is not None and scan.beam_time_s is not None
        assert math.degrees(math.atan2(scan.direction[0, 1], scan.direction[0, 0])) % 360 == pytest.approx(180, abs=0.5)
    for scan in scans[1:-1]:
        assert scan.beam_time_s is not None
        assert np.ptp(scan.beam_time_s) == pytest.approx(0.1, abs=3e-4)


@pytest.mark.parametrize("factor", [1.2, 1.084])
def test_firmware_with_another_period(tmp_path: pathlib.Path, factor: float) -> None:
    """The HDL-64E S3 fires every 57.6 us, and new firmware of the VLS-128 every 57.8 us."""
    unit = UNITS["hdl64e" if factor == 1.2 else "vls128"]
    unit = dataclasses.replace(unit, period_us=unit.period_us * factor, laser_us=[t * factor for t in unit.laser_us])
    truth = observe(unit, 600)
    recording = PacketRecording(save(tmp_path / "a.pcap", packets_of(unit, truth, 0x37)),
                                calibration_file(tmp_path / "c.yaml", unit) if factor == 1.2 else None)
    scans = list(recording.scans())
    assert np.abs(joined(scans, "beam_time_s") - truth.time_s).max() < 4e-6
    angle = np.arccos(np.clip((joined(scans, "direction") * truth.direction).sum(axis=1), -1, 1))
    assert np.degrees(angle).max() < 0.02


def test_hdl64e_takes_its_calibration_from_the_packets(tmp_path: pathlib.Path) -> None:
    unit = UNITS["hdl64e"]
    unit = dataclasses.replace(unit, elevation=[round(angle, 2) for angle in unit.elevation])
    truth = observe(unit, 12)
    packets = packets_of(unit, truth, 0x37)
    status = hdl64e_status(unit)
    many = [(T0 + 288e-6 * k, packets[k % 2][1][:-6] + struct.pack("<I", round(200e6 + 288 * k))
             + status[2 * (k + 1000) % len(status):][:2]) for k in range(8320)]
    recording = PacketRecording(save(tmp_path / "a.pcap", many))
    assert "status bytes" in " ".join(recording.found())
    scan = next(iter(recording.scans()))
    assert scan.direction is not None and scan.range_m is not None and scan.ring is not None
    assert scan.direction[:32] == pytest.approx(truth.direction[:32], abs=2e-4)
    hit = truth.strongest[:64] > 0
    assert scan.range_m[:64][hit] == pytest.approx(truth.strongest[:64][hit] * 0.002 + 1.4, abs=1e-4)
    assert (scan.ring[:64] == truth.ring[:64]).all()

    few = PacketRecording.__new__(PacketRecording)
    with pytest.raises(FormatError, match="an HDL-64E needs its calibration.*--metadata db.xml"):
        few.__init__(save(tmp_path / "b.pcap", many[:4000]))  # type: ignore[misc]


def test_calibrations_agree_in_both_forms(tmp_path: pathlib.Path) -> None:
    unit = UNITS["hdl64e"]
    truth = observe(unit, 60)
    path = save(tmp_path / "a.pcap", packets_of(unit, truth, 0x37))
    yaml = calibration_file(tmp_path / "c.yaml", unit, vert_offset_correction=0.2, horiz_offset_correction=0.026,
                            dist_correction_x=1.45, dist_correction_y=1.35)
    rows = "".join(
        f"<item><px><id_>{laser}</id_><rotCorrection_>{-unit.clockwise[laser]!r}</rotCorrection_><vertCorrection_>"
        f"{unit.elevation[laser]!r}</vertCorrection_><distCorrection_>140</distCorrection_><distCorrectionX_>145"
        "</distCorrectionX_><distCorrectionY_>135</distCorrectionY_><vertOffsetCorrection_>20</vertOffsetCorrection_>"
        "<horizOffsetCorrection_>2.6</horizOffsetCorrection_></px></item>" for laser in range(64))
    xml = tmp_path / "db.xml"
    xml.write_text('<?xml version="1.0"?><!DOCTYPE boost_serialization><boost_serialization><DB>'
                   f"<distLSB_>0.2</distLSB_><enabled_>{'<item>1</item>' * 64}</enabled_><points_>{rows}</points_>"
                   "</DB></boost_serialization>")
    one, other = (list(PacketRecording(path, file).scans()) for file in (yaml, xml))
    for name in ("direction", "range_m", "origin", "ring"):
        assert joined(one, name) == pytest.approx(joined(other, name), abs=1e-6)
    # The maker's formula, for one laser: corrections by axis within 25 m, then the offsets.
    scan, row = one[0], 3
    assert scan.origin is not None and scan.direction is not None and scan.range_m is not None
    raw = truth.strongest[row] * 0.002
    ahead, left, up = truth.direction[row]
    near_x, near_y = abs((raw + 1.4) * left), abs((raw + 1.4) * ahead)
    at_x = 1.45 + (1.4 - 1.45) * (near_x - 2.4) / (25.04 - 2.4)
    at_y = 1.35 + (1.4 - 1.35) * (near_y - 1.93) / (25.04 - 1.93)
    flat = math.hypot(ahead, left)
    point = [(raw + at_y) * ahead - 0.026 * left / flat, (raw + at_x) * left + 0.026 * ahead / flat,
             (raw + (at_x + at_y) / 2) * up + 0.2]
    assert scan.origin[row] + scan.direction[row] * scan.range_m[row] == pytest.approx(point, abs=2e-3)


@pytest.mark.parametrize("text", ["", "lasers: 3", "lasers: [{laser_id: 0}]", "<a>", "lasers: [{laser_id: 1e400}]",
                                  "lasers: [{laser_id: 0, vert_correction: .nan}]", "a: [", "\0"])
def test_bad_calibrations_have_one_line(tmp_path: pathlib.Path, text: str) -> None:
    path = save(tmp_path / "a.pcap", packets_of(UNITS["vlp16"], observe(UNITS["vlp16"], 48), 0x37))
    (tmp_path / "c.yaml").write_text(text)
    with pytest.raises(FormatError) as error:
        PacketRecording(path, tmp_path / "c.yaml")
    assert "\n" not in str(error.value) and "alibration" in str(error.value)


# Clocks.


def test_lost_packets_leave_a_gap(tmp_path: pathlib.Path) -> None:
    truth = observe(UNITS["vlp16"], 24 * 400)
    packets = packets_of(UNITS["vlp16"], truth, 0x37)
    lost = packets[:30] + packets[130:]  # More than a revolution.
    scans = list(PacketRecording(save(tmp_path / "a.pcap", lost)).scans())
    keep = np.ones(len(truth.time_s), dtype=bool)
    keep[30 * 384:130 * 384] = False
    assert joined(scans, "beam_time_s") == pytest.approx(truth.time_s[keep], abs=3e-6)
    angle = np.arccos(np.clip((joined(scans, "direction") * truth.direction[keep]).sum(axis=1), -1, 1))
    assert np.degrees(angle).max() < 0.011
    assert max(np.ptp(scan.beam_time_s) for scan in scans if scan.beam_time_s is not None) < 0.11


def test_a_sensor_that_stands_still_gives_bounded_scans(tmp_path: pathlib.Path) -> None:
    truth = observe(UNITS["hdl32e"], 12, rate_deg_s=0)
    data = packets_of(UNITS["hdl32e"], truth, 0x37, 0)[0][1]
    packets = [(T0 + k * 553e-6, data[:-6] + struct.pack("<I", 553 * k) + data[-2:]) for k in range(4000)]
    scans = list(PacketRecording(save(tmp_path / "a.pcap", packets)).scans())
    assert sum(map(len, scans)) == 384 * 4000
    assert max(np.ptp(scan.beam_time_s) for scan in scans if scan.beam_time_s is not None) < 1.0


def test_a_sector_without_firings(tmp_path: pathlib.Path) -> None:
    """A sensor that is told to fire from 90 to 270 degrees only jumps on within a packet; stamps go on meanwhile."""
    unit = UNITS["hdl32e"]
    truth = observe(unit, 12 * 400, 7200, start_deg=0)
    packets = packets_of(unit, truth, 0x37, 7200, start_deg=0)
    fired = [(time_s, data) for time_s, data in packets if 9000 <= int.from_bytes(data[2:4], "little") <= 27000]
    jump = bytearray(fired[60][1])
    for block in range(6, 12):  # As a whole turn of blocks that were not sent.
        jump[100 * block + 2:100 * block + 4] = struct.pack("<H", 9000 + 33 * block)
    fired[60] = (fired[60][0], bytes(jump))
    scans = list(PacketRecording(save(tmp_path / "a.pcap", fired)).scans())
    assert sum(map(len, scans)) == 384 * len(fired)
    assert 6 <= len(scans) <= 7 and max(map(len, scans)) < 20_000


def test_a_file_beside_that_is_no_metadata_does_not_matter(tmp_path: pathlib.Path) -> None:
    path = save(tmp_path / "a.pcap", packets_of(UNITS["vlp16"], observe(UNITS["vlp16"], 48), 0x37))
    (tmp_path / "a.json").write_text("notes on the drive")
    assert sum(map(len, PacketRecording(path).scans())) == 48 * 16
    with pytest.raises(FormatError, match="a.json: is no metadata"):
        PacketRecording(path, tmp_path / "a.json")


def test_a_long_capture_is_read_piece_by_piece(tmp_path: pathlib.Path) -> None:
    one = packets_of(UNITS["vlp16"], observe(UNITS["vlp16"], 24), 0x37)[0][1]
    packets = [(T0 + k * 1327.104e-6, b"".join(
        one[100 * block:100 * block + 2] + struct.pack("<H", (40 * (12 * k + block)) % 36000)
        + one[100 * block + 4:100 * block + 100] for block in range(12))
        + struct.pack("<IBB", round(200e6 + k * 1327.104), 0x37, 0x22)) for k in range(9000)]
    recording = PacketRecording(save(tmp_path / "a.pcap", packets))
    assert recording.bytes_done == 0
    assert "of the file's beginning" in " ".join(recording.found())
    scans = recording.scans()
    number = len(next(scans))
    assert 0 < recording.bytes_done < recording.bytes_total / 4
    number += sum(map(len, scans))
    assert number == 9000 * 384 and recording.bytes_done == recording.bytes_total
    assert "9000 packets in 11.94" in recording.found()[1]


def test_what_is_left_out_is_counted(tmp_path: pathlib.Path) -> None:
    packets = packets_of(UNITS["vlp16"], observe(UNITS["vlp16"], 24 * 40), 0x37)
    damaged = [
        packets[0],
        (packets[1][0], packets[1][1][:100] + b"\0\0" + packets[1][1][102:]),  # The flag of a block.
        (packets[2][0], packets[2][1][:2] + b"\xff\xff" + packets[2][1][4:]),  # The azimuth of a block.
        packets[3], packets[3],
        (packets[4][0], packets[4][1][:-1] + b"\x28"),  # Another model.
        (packets[5][0], packets[5][1][:-2] + b"\x40\x22"),  # An unknown mode.
        (packets[6][0], packets[6][1][:-1]),
        *packets[7:]]
    recording = PacketRecording(save(tmp_path / "a.pcap", damaged))
    rows = sum(map(len, recording.scans()))
    assert rows == 384 * 37 - 2 * 32
    assert recording.skipped == {
        "blocks with a wrong flag or azimuth": 2, "packets captured twice": 1, "packets of another length": 1,
        "packets of another model": 1, "packets with an unknown return mode": 1}
    assert sum("left out" in line for line in recording.found()) == 5


def test_the_return_mode_may_change(tmp_path: pathlib.Path) -> None:
    unit = UNITS["vlp16"]
    truth = observe(unit, 24 * 30)
    single, dual = (packets_of(unit, truth, mode) for mode in (0x37, 0x39))
    later = [(time_s + 1, data[:-6] + struct.pack("<I", struct.unpack("<I", data[-6:-2])[0] + 1_000_000) + data[-2:])
             for time_s, data in dual]
    recording = PacketRecording(save(tmp_path / "a.pcap", single + later))
    scans = list(recording.scans())
    assert sum(int((scan.echo <= 1).sum()) for scan in scans if scan.echo is not None) == 2 * len(truth.time_s)
    assert "dual return and strongest return" in recording.found()[0]


def test_two_sensors_are_told_apart(tmp_path: pathlib.Path) -> None:
    one, two = (packets_of(UNITS[name], observe(UNITS[name], 240), 0x37) for name in ("vlp16", "hdl32e"))
    records = sorted([(time_s, pf.udp(data)[0]) for time_s, data in one]
                     + [(time_s, pf.udp(data, source="192.168.1.202", port=2369)[0]) for time_s, data in two])
    path = tmp_path / "a.pcap"
    path.write_bytes(pf.pcap(records))
    with pytest.raises(FormatError, match=r"2 sensors: add --topic 192.168.1.20\d:23\d\d or --topic"):
        PacketRecording(path)
    for stream in ("192.168.1.202:2369", "2369", "192.168.1.202"):
        recording = PacketRecording(path, stream=stream)
        assert recording.sensor == "velodyne-hdl32e"
        assert sum(map(len, recording.scans())) == 240 * 32
        assert recording.skipped == {"datagrams to other ports or of other senders": len(one)}
    with pytest.raises(FormatError, match="no packets of '99'"):
        PacketRecording(path, stream="99")


def test_a_model_that_the_packets_do_not_tell(tmp_path: pathlib.Path) -> None:
    truth = observe(UNITS["hdl32e"], 1200)
    packets = [(time_s, data[:-2] + b"\0\0") for time_s, data in packets_of(UNITS["hdl32e"], truth, 0x37)]
    path = save(tmp_path / "a.pcap", packets)
    with pytest.raises(FormatError, match="product number 0x00; name the sensor with --sensor velodyne"):
        PacketRecording(path)
    assert sum(map(len, PacketRecording(path, sensor="velodyne-hdl32e").scans())) == len(truth.time_s)
    with pytest.raises(FormatError, match="no Velodyne"):
        PacketRecording(path, sensor="ouster-os1-64")


def test_packets_of_another_model_than_the_named_one(tmp_path: pathlib.Path) -> None:
    path = save(tmp_path / "a.pcap", packets_of(UNITS["hdl32e"], observe(UNITS["hdl32e"], 1200), 0x37))
    for other in ("velodyne-vlp16", "velodyne-vlp32c", "velodyne-hdl64e"):
        with pytest.raises(FormatError, match=f"those of a velodyne-hdl32e, not of --sensor {other}"):
            PacketRecording(path, sensor=other)


def test_other_traffic_has_one_line(tmp_path: pathlib.Path) -> None:
    path = tmp_path / "a.pcap"
    path.write_bytes(pf.pcap([(T0, pf.udp(b"hello", port=53)[0])] * 3))
    with pytest.raises(FormatError, match="no packets of a Velodyne, Ouster, Hesai or Livox; it has 3 of 5 bytes to port 53"):
        PacketRecording(path)


def test_mutants_are_read_or_refused(tmp_path: pathlib.Path) -> None:
    """A few of those that `mutate_packets.py` makes."""
    assert sum(mutate_packets.run("velodyne", 90, 20, tmp_path).values()) == 90


# Real captures.

@pytest.mark.parametrize("name, sensor, packets, misses", [
    ("sample_velodyne_hdl32.pcap", "velodyne-hdl32e", 500, 23.6),
    ("sample_velodyne_vlp16_gps.pcap", "velodyne-vlp16", 293, 34.7)])
def test_real_captures(name: str, sensor: str, packets: int, misses: float) -> None:
    recording = PacketRecording(pf.data_folder() / name)
    assert recording.sensor == sensor
    scans = list(recording.scans())
    echo, ranges = joined(scans, "echo"), joined(scans, "range_m")
    assert len(echo) == packets * 384
    assert 100 * np.mean(echo == 0) == pytest.approx(misses, abs=0.05)
    assert f"{packets} packets" in recording.found()[1] and f"{misses} %" in recording.found()[2]
    assert (np.diff(joined(scans, "beam_time_s")) >= 0).all()
    if sensor == "velodyne-hdl32e":
        assert np.median(ranges[echo > 0]) == pytest.approx(5.8, abs=0.05)
        assert ranges[echo > 0].max() == pytest.approx(81, abs=1)
    else:
        assert "set by GPS" in " ".join(recording.found())
        assert scans[0].time_s == pytest.approx(1453364282.34, abs=0.001)  # 08:18:02 UTC by its GPS sentence.


def plane(points: Floats, level: bool) -> tuple[int, float]:
    """Number of points within 8 cm of the largest upright or level plane, and their RMS distance (m); seed 0."""
    random = np.random.default_rng(0)
    best = np.zeros(len(points), dtype=bool)
    for _ in range(300):
        a, b, c = points[random.choice(len(points), 3, replace=False)]
        normal = np.cross(b - a, c - a)
        normal /= max(float(np.linalg.norm(normal)), 1e-9)
        if abs(normal[2]) > 0.95 if level else abs(normal[2]) < 0.1:
            near = np.abs((points - a) @ normal) < 0.08
            best = near if near.sum() > best.sum() else best
    for _ in range(3):
        normal = np.linalg.eigh(np.cov(points[best].T))[1][:, 0]
        best = np.abs((points - points[best].mean(axis=0)) @ normal) < 0.08
    return int(best.sum()), float(np.sqrt(np.linalg.eigvalsh(np.cov(points[best].T))[0]))


def real_points(name: str) -> Floats:
    scan = list(PacketRecording(pf.data_folder() / name).scans())[1]
    assert scan.range_m is not None and scan.direction is not None
    hit = np.isfinite(scan.range_m) & (scan.range_m > 1)
    points: Floats = scan.direction[hit] * scan.range_m[hit][:, None]
    return points


@pytest.mark.parametrize("name, level, size, residual_m", [
    ("sample_velodyne_vlp16_gps.pcap", False, 4000, 0.02), ("sample_velodyne_hdl32.pcap", True, 12000, 0.04)])
def test_real_walls_and_floors_are_flat(monkeypatch: pytest.MonkeyPatch, name: str, level: bool, size: int,
                                        residual_m: float) -> None:
    """The largest wall or floor is flat to a few cm. With the lasers in another order it is not."""
    found, flat_m = plane(real_points(name), level)
    assert found > size and flat_m < residual_m
    order = velodyne.rings_of_lasers
    monkeypatch.setattr(velodyne, "rings_of_lasers", lambda model, file: np.sort(order(model, file)))
    found, flat_m = plane(real_points(name), level)
    assert not (found > size and flat_m < residual_m)
