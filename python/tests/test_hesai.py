"""Hesai's packets: closed forms in a room for all models and modes, angle corrections, damage."""
from __future__ import annotations

import dataclasses
import math
import pathlib
import struct

import numpy as np
import pytest

import hesai_unit as hu
import mutate_packets
import packet_files as pf
from hesai_unit import MODES, UNITS, Unit, correction, observe, packets_of
from packet_files import T0
from underbrush.errors import FormatError
from underbrush.formats.hesai_packets import layout_of, seconds_of
from underbrush.formats.packets import PacketRecording
from velodyne_unit import joined, save


def recorded(tmp_path: pathlib.Path, unit: Unit, packets: list[tuple[float, bytes]]) -> PacketRecording:
    path = save(tmp_path / "a.pcap", packets)
    return PacketRecording(path, correction(tmp_path / "c.csv", unit) if unit.needs_file else None)


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("name", UNITS)
def test_every_beam_in_a_room(tmp_path: pathlib.Path, name: str, mode: str) -> None:
    unit, (code, returns) = UNITS[name], MODES[mode]
    firings = 6 * unit.blocks * max(1, 400 // unit.lasers)
    truth = observe(unit, firings, returns)
    recording = recorded(tmp_path, unit, packets_of(unit, truth, code, returns))
    assert recording.sensor == unit.sensor and recording.organised
    scans = list(recording.scans())
    assert not recording.skipped
    assert ("dual return" in recording.found()[0]) == (returns == 2)

    order = np.argsort(unit.laser_us, kind="stable")  # Rows are in order of time.
    direction, time_s = truth.direction[:, order].reshape(-1, 3), truth.time_s[:, order].ravel()
    counts = truth.counts[:, :, order].swapaxes(1, 2).reshape(-1, returns)
    rows = joined(scans, "echo")
    beam = np.cumsum(rows <= 1) - 1
    assert beam[-1] + 1 == firings * unit.lasers
    assert (joined(scans, "ring") == np.tile(order, firings)[beam]).all()
    assert np.abs(joined(scans, "beam_time_s") - time_s[beam]).max() < 2e-6
    assert (np.diff(joined(scans, "beam_time_s")) > -1e-6).all()
    angle = np.arccos(np.clip((joined(scans, "direction") * direction[beam]).sum(axis=1), -1, 1))
    assert np.degrees(angle).max() < 0.016  # Azimuths are in steps of 0.01 degrees, and speeds in these a firing.

    far, near = counts.max(axis=1), np.where(counts > 0, counts, 1 << 20).min(axis=1)
    number = (far > 0).astype(int) + ((far > 0) & (near < far) & (returns > 1))
    assert (joined(scans, "echoes") == number[beam]).all() and (number == 2).any() == (returns == 2)
    expected = np.where(rows == 0, 0, np.where(rows == 2, far[beam], near[beam]))
    assert (np.isinf(joined(scans, "range_m")) == (far[beam] == 0)).all() and (rows == 0).any()
    np.testing.assert_allclose(joined(scans, "range_m"), np.where(expected, expected * unit.step_mm * 0.001, np.inf),
                               atol=1e-4)
    assert (joined(scans, "intensity") == expected % 200).all()
    wall = (rows == 1) & (np.arange(unit.lasers)[joined(scans, "ring")] % 3 == 2)  # Without a return behind it.
    points = joined(scans, "direction")[wall] * joined(scans, "range_m")[wall][:, None]
    assert pf.off_walls(points).max() < 0.5e-3 * unit.step_mm + 0.005


def test_triple_returns_are_three_rows_of_a_beam(tmp_path: pathlib.Path) -> None:
    unit = UNITS["xt32m"]
    truth = observe(unit, 60)
    first = truth.counts[:, 0]
    truth.counts = np.stack([first, np.where(first > 0, first + 500, 0), np.where(first > 0, first + 200, 0)], axis=1)
    truth.counts[:, 1, 15] = truth.counts[:, 0, 15]  # The last return is the first one.
    recording = recorded(tmp_path, unit, packets_of(unit, truth, 0x3D, 3))
    scans = list(recording.scans())
    ring, echo, echoes, range_m = (joined(scans, name) for name in ("ring", "echo", "echoes", "range_m"))
    assert "triple return" in recording.found()[0]
    assert echo[ring == 20][:6].tolist() == [1, 2, 3, 1, 2, 3] and set(echoes[ring == 20]) == {3}
    assert (np.diff(range_m[ring == 20][:3]) / 0.005).tolist() == pytest.approx([200, 300], abs=0.01)
    assert echo[ring == 15][:4].tolist() == [1, 2, 1, 2] and set(echoes[ring == 15]) == {2}
    assert (echo == 0).sum() == (first == 0).sum()


@pytest.mark.parametrize("name", ["pandar64", "xt32"])
def test_revolutions_begin_at_the_makers_y_axis(tmp_path: pathlib.Path, name: str) -> None:
    unit = UNITS[name]
    truth = observe(unit, 8 * unit.blocks * 100, start_deg=100)
    scans = list(recorded(tmp_path, unit, packets_of(unit, truth)).scans())
    assert len(scans) == 1 + math.floor((100 + 3600 * 8 * unit.blocks * 100 * unit.period_us * 1e-6) / 360)
    for scan in scans[1:]:
        assert scan.direction is not None and scan.beam_time_s is not None
        flat = scan.direction[0] - [0, 0, scan.direction[0, 2]]
        assert math.degrees(math.atan2(flat[1], flat[0])) == pytest.approx(90, abs=6)
    for scan in scans[1:-1]:
        assert scan.beam_time_s is not None and np.ptp(scan.beam_time_s) == pytest.approx(0.1, abs=3e-4)


def test_firing_times_are_those_of_the_manuals() -> None:
    us = hu.pandar64_us()
    assert us[4] == pytest.approx(-17.964) and us[50] == us[60] == -3.62 and us[11] == us[39] == pytest.approx(-54.668)
    us = hu.pandar40_us()
    assert us[7] == pytest.approx(-54.67, abs=0.02) and us[3] == us[39] == -3.62
    assert us[18] == us[4] == pytest.approx(-45.49, abs=0.02)


@pytest.mark.parametrize("title", ["Channel,Elevation,Azimuth", "\ufeffLaser id,Elevation,Azimuth",
                                   "EEFF,1,1\nLaser id,Elevation,Azimuth"])
def test_a_units_own_angles(tmp_path: pathlib.Path, title: str) -> None:
    unit = dataclasses.replace(UNITS["xt32"], elevation=[14.9 - 0.97 * k for k in range(32)],
                               clockwise=[0.3 - 0.02 * k for k in range(32)])
    truth = observe(unit, 80)
    path, angles = save(tmp_path / "a.pcap", packets_of(unit, truth)), correction(tmp_path / "own.csv", unit, title)
    angles.write_text(angles.read_text() + "5e4a3fe9\n")  # A check sum.
    recording = PacketRecording(path, angles)
    found = joined(list(recording.scans()), "direction")
    assert np.abs(found - truth.direction.reshape(-1, 3)).max() < 3e-4
    assert any(line.endswith("own.csv") for line in recording.found())
    assert np.abs(joined(list(PacketRecording(path).scans()), "direction") - found).max() > 5e-3


def test_angles_that_are_not_known_are_asked_for(tmp_path: pathlib.Path) -> None:
    unit = UNITS["pandar40p"]
    path = save(tmp_path / "a.pcap", packets_of(unit, observe(unit, 40)))
    with pytest.raises(FormatError, match="a Hesai Pandar40P needs the angles.*--metadata CORRECTION.csv"):
        PacketRecording(path)
    other = correction(tmp_path / "other.csv", UNITS["xt32"])
    with pytest.raises(FormatError, match="other.csv has 32 channels, but a Hesai Pandar40P has 40"):
        PacketRecording(path, other)


@pytest.mark.parametrize("text", ["", "hello", "1,2", "2,1,1\n", "1,nan,1\n", "1,1,1\n3,1,1\n", "1,95,1\n", "1,x,1\n",
                                  "1,1,1e999\n", "".join(f"{k},1,1\n" for k in range(1, 400)), "\0"])
def test_bad_angles_have_one_line(tmp_path: pathlib.Path, text: str) -> None:
    unit = UNITS["pandar40p"]
    path = save(tmp_path / "a.pcap", packets_of(unit, observe(unit, 40)))
    (tmp_path / "c.csv").write_text(text)
    with pytest.raises(FormatError, match="c.csv: ") as error:
        PacketRecording(path, tmp_path / "c.csv")
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(("name", "flags"), [("xt32", 0), ("xt32", 1), ("xt32", 9), ("xt16", 8), ("pandar64", 0), ("qt64", 0),
                                             ("pandar40p", 0)])
def test_optional_parts_change_the_length(tmp_path: pathlib.Path, name: str, flags: int) -> None:
    unit = UNITS[name]
    truth = observe(unit, 16 * unit.blocks)
    packets = packets_of(unit, truth, flags=flags)
    assert len({len(data) for _, data in packets} | {len(data) for _, data in packets_of(unit, truth)}) <= 2
    recording = recorded(tmp_path, unit, packets)
    assert sum(map(len, recording.scans())) == truth.time_s.size and not recording.skipped
    assert layout_of(packets[0][1][:-1]) is None and layout_of(packets[0][1] + b"\0\0") is None


@pytest.mark.parametrize(("name", "form"), [("pandar64", "1900"), ("pandar64", "2000"), ("xt32", "1900"),
                                            ("xt32", "whole")])
def test_dates_in_all_forms(tmp_path: pathlib.Path, name: str, form: str) -> None:
    unit = UNITS[name]
    truth = observe(unit, 80, start_s=T0 + 0.9995)  # A second begins within it.
    recording = recorded(tmp_path, unit, packets_of(unit, truth, form=form))
    order = np.argsort(unit.laser_us, kind="stable")
    found = joined(list(recording.scans()), "beam_time_s")
    np.testing.assert_allclose(found, truth.time_s[:, order].ravel()[:len(found)], atol=2e-6)
    assert "which is set and 0.000 s behind the capture's" in " ".join(recording.found())


def test_a_clock_that_is_not_set_only_counts(tmp_path: pathlib.Path) -> None:
    unit = UNITS["xt32"]
    truth = observe(unit, 240, start_s=86400.0 * 365 * 30)
    packets = [(time_s + 1e8, data) for time_s, data in packets_of(unit, truth)]
    found = joined(list(recorded(tmp_path, unit, packets).scans()), "beam_time_s")
    np.testing.assert_allclose(found - found[0], truth.time_s.ravel() - truth.time_s[0, 0], atol=2e-6)
    assert found[0] == pytest.approx(packets[0][0], abs=1e-3)


def test_dates_without_sense_do_not_fail() -> None:
    dates = np.array([[0] * 6, [255] * 6, [126, 2, 30, 25, 61, 61], [0, 0, 255, 255, 255, 255]], np.uint8)
    assert np.isfinite(seconds_of(dates)).all()
    assert seconds_of(np.array([[126, 11, 27, 16, 17, 33], [26, 11, 27, 16, 17, 33]], np.uint8)).tolist() == [1795796253] * 2


def test_what_is_left_out_is_counted(tmp_path: pathlib.Path) -> None:
    unit = UNITS["pandar64"]
    truth = observe(unit, 240)
    packets = packets_of(unit, truth)

    def changed(number: int, place: int, new: bytes) -> tuple[float, bytes]:
        time_s, data = packets[number]
        place %= len(data)
        return time_s, data[:place] + new + data[place + len(new):]

    damaged = [
        packets[0], changed(1, 8, b"\xff\xff"),  # The azimuth of a block.
        changed(2, 8 + 6 * 194 + 14, b"\x99"),  # The return mode.
        changed(3, 3, b"\5"), changed(4, 5, b"\6"),  # Another number of blocks, another unit.
        (packets[5][0], packets[5][1][:-1]), packets[6], packets[6], *packets[7:]]
    recording = recorded(tmp_path, unit, damaged)
    assert sum(map(len, recording.scans())) == 64 * (240 - 4 * 6 - 1)
    assert recording.skipped == {
        "blocks with a wrong flag or azimuth": 1, "packets captured twice": 1, "packets of another length": 1,
        "packets of another model": 2, "packets with an unknown return mode": 1}


def test_an_empty_datagram_is_no_packet(tmp_path: pathlib.Path) -> None:
    unit = UNITS["xt32"]
    packets = packets_of(unit, observe(unit, 240))
    recording = recorded(tmp_path, unit, [*packets[:3], (packets[3][0], b""), *packets[3:]])
    assert sum(map(len, recording.scans())) == 32 * 240


def test_packets_with_other_flags_are_told(tmp_path: pathlib.Path) -> None:
    unit = UNITS["xt32"]
    packets = packets_of(unit, observe(unit, 240))
    time_s, data = packets[1]
    packets[1] = time_s, data[:11] + bytes([data[11] | 0x40]) + data[12:]  # An unknown flag; the length is the same.
    recording = recorded(tmp_path, unit, packets)
    assert sum(map(len, recording.scans())) == 32 * (240 - 8)
    assert recording.skipped == {"packets whose flags (optional parts) are others than those of most packets": 1}


def test_the_return_mode_may_change(tmp_path: pathlib.Path) -> None:
    unit = UNITS["xt32"]
    single = packets_of(unit, observe(unit, 80))
    dual = packets_of(unit, observe(unit, 80, 2, start_s=T0 + 0.5), 0x39, 2)
    recording = recorded(tmp_path, unit, single + dual)
    scans = list(recording.scans())
    assert sum(int((scan.echo <= 1).sum()) for scan in scans if scan.echo is not None) == 160 * 32
    assert "dual return and strongest return" in recording.found()[0]


def test_a_gap_and_a_sector_keep_times_and_directions(tmp_path: pathlib.Path) -> None:
    unit = UNITS["xt32"]
    truth = observe(unit, 8 * 500)
    packets = packets_of(unit, truth)
    keep = np.ones(500, dtype=bool)
    keep[40:400] = False  # More than a revolution.
    scans = list(recorded(tmp_path, unit, [packet for packet, kept in zip(packets, keep) if kept]).scans())
    rows = np.repeat(keep, 8)
    np.testing.assert_allclose(joined(scans, "beam_time_s"), truth.time_s[rows].ravel(), atol=3e-6)
    np.testing.assert_allclose(joined(scans, "direction"), truth.direction[rows].reshape(-1, 3), atol=3e-4)


def test_two_sensors_are_told_apart(tmp_path: pathlib.Path) -> None:
    one, two = (packets_of(UNITS[name], observe(UNITS[name], 240)) for name in ("xt32", "pandar64"))
    path = tmp_path / "a.pcap"
    path.write_bytes(pf.pcap(sorted(
        [(time_s, pf.udp(data)[0]) for time_s, data in one]
        + [(time_s, pf.udp(data, source="192.168.1.202", port=2369)[0]) for time_s, data in two])))
    with pytest.raises(FormatError, match=r"2 sensors: add --topic 192.168.1.20\d:23\d\d or --topic"):
        PacketRecording(path)
    for stream in ("192.168.1.202:2369", "2369"):
        recording = PacketRecording(path, stream=stream)
        assert recording.sensor == "hesai-pandar64" and sum(map(len, recording.scans())) == 240 * 64
        assert recording.skipped == {"datagrams to other ports or of other senders": len(one)}


def test_other_sensors_are_refused_by_name(tmp_path: pathlib.Path) -> None:
    unit = UNITS["xt32"]
    packets = packets_of(unit, observe(unit, 80))
    path = save(tmp_path / "a.pcap", packets)
    assert PacketRecording(path, sensor="hesai-xt32").sensor == "hesai-xt32"
    with pytest.raises(FormatError, match="'hesai-pandar64' does not send these packets.* of a Hesai PandarXT-32"):
        PacketRecording(path, sensor="hesai-pandar64")
    save(path, [(time_s, data[:2] + struct.pack("BB", 1, 8) + data[4:]) for time_s, data in packets])
    with pytest.raises(FormatError, match=r"Hesai's protocol 1.8 with 32 channels and 8 blocks are not decoded"):
        PacketRecording(path)


def test_mutants_are_read_or_refused(tmp_path: pathlib.Path) -> None:
    """A few of those that `mutate_packets.py` makes."""
    assert sum(mutate_packets.run("hesai", 90, 21, tmp_path).values()) == 90
