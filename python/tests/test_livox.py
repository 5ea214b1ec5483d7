"""Livox's packets: closed forms in a room for all kinds of data, clocks, damage."""
from __future__ import annotations

import pathlib
import struct

import numpy as np
import pytest

import mutate_packets
import packet_files as pf
from livox_unit import KINDS, observe, packet, packets_of
from packet_files import T0
from underbrush.errors import FormatError
from underbrush.formats.packets import PacketRecording
from velodyne_unit import joined, save

NO_DIRECTION = "points without a return, whose direction is not in the packets"


@pytest.mark.parametrize("name", KINDS)
def test_every_beam_in_a_room(tmp_path: pathlib.Path, name: str) -> None:
    kind = KINDS[name]
    count = 40
    truth = observe(kind, count)
    recording = PacketRecording(save(tmp_path / "a.pcap", packets_of(name, count, truth), ))
    assert recording.sensor == kind.sensor
    scans = list(recording.scans())
    cartesian = kind.form in ("mm", "cm")
    assert recording.organised != cartesian
    far = truth.depth_mm.max(axis=1)
    kept = far > 0 if cartesian else np.ones(len(far), dtype=bool)
    assert recording.skipped == ({NO_DIRECTION: int((~kept).sum())} if cartesian else {}) and (far == 0).any()
    assert any("misses: none" in line for line in recording.found()) == cartesian

    rows, echoes = joined(scans, "echo"), joined(scans, "echoes")
    beam = np.flatnonzero(kept)[np.cumsum(rows <= 1) - 1]
    ordered = np.sort(np.where(truth.depth_mm > 0, truth.depth_mm, 1 << 30), axis=1)
    unique = (ordered < 1 << 30) & (np.diff(ordered, axis=1, prepend=0) > 0)
    assert (echoes == unique.sum(axis=1)[beam]).all() and echoes.max() == kind.returns
    depth = np.array([sorted(set(row) - {0})[echo - 1] if echo else 0 for row, echo in
                      zip(truth.depth_mm[beam].tolist(), rows.tolist())])
    step_mm = 10 if kind.form == "cm" else 1
    expected = np.where(rows > 0, depth * 0.001, np.inf)
    np.testing.assert_allclose(joined(scans, "range_m"), expected, atol=0.001 * step_mm if cartesian else 1e-6)
    angle = np.arccos(np.clip((joined(scans, "direction") * truth.direction[beam]).sum(axis=1), -1, 1))
    assert angle.max() < (0.001 * step_mm / 2 if cartesian else 1e-6)
    assert np.abs(joined(scans, "beam_time_s") - truth.time_s[beam]).max() < 2e-6
    assert (joined(scans, "intensity") == depth % 200).all()
    lines = {10_000: 1, 5000: 4}.get(kind.step_ns, 6)
    assert (joined(scans, "ring") == beam % kind.points % lines).all()
    wall = (rows > 0) & (beam % 3 > 0)
    assert pf.off_walls(joined(scans, "direction")[wall] * joined(scans, "range_m")[wall][:, None]).max() < 0.001 * step_mm
    if kind.has_tag:
        tags = np.concatenate([scan.extra["tag"] for scan in scans])
        assert (truth.depth_mm[beam, tags >> 4][rows > 0] == depth[rows > 0]).all()
    words = ("single", "dual", "triple")[kind.returns - 1]
    assert f"{words} return" in recording.found()[0]


def test_scans_are_a_tenth_of_a_second_long(tmp_path: pathlib.Path) -> None:
    kind = KINDS["mid360 spherical"]
    one = packet(kind, observe(kind, 1), 0)
    packets = [(T0 + 480e-6 * k, one[:28] + struct.pack("<Q", round((T0 + 480e-6 * k) * 1e9)) + one[36:]) for k in range(700)]
    scans = list(PacketRecording(save(tmp_path / "a.pcap", packets)).scans())
    assert [len(scan) for scan in scans] == pytest.approx([20000, 20000, 20000, 7200], abs=100)
    assert sum(map(len, scans)) == 700 * 96 and [scan.number for scan in scans] == [0, 1, 2, 3]
    still = [(time_s, data[:28] + struct.pack("<Q", 10**9) + data[36:44] + struct.pack("<H", k) + data[46:])
             for k, (time_s, data) in enumerate(packets * 4)]
    scans = list(PacketRecording(save(tmp_path / "b.pcap", still)).scans())
    assert sum(map(len, scans)) == 2800 * 96 and max(map(len, scans)) < 250_000


@pytest.mark.parametrize(("stamp", "offset_s"), [(0, -1e9), (1, 0.0), (3, 0.0), (4, 0.0)])
def test_stamps_of_all_kinds(tmp_path: pathlib.Path, stamp: int, offset_s: float) -> None:
    """Since the start (0), of PTP (1), in UTC (3) and since the last pulse (4)."""
    name = "extended spherical"
    truth = observe(KINDS[name], 600)
    own = observe(KINDS[name], 600, T0 + offset_s)
    packets = packets_of(name, 600, own, stamp)
    if stamp == 4:
        packets = [(time_s, data[:10] + struct.pack("<Q", int.from_bytes(data[10:18], "little") % 10**9) + data[18:])
                   for time_s, data in packets]
    recording = PacketRecording(save(tmp_path / "a.pcap", [(time_s - offset_s, data) for time_s, data in packets]))
    found = joined(list(recording.scans()), "beam_time_s")
    late_s = 600e-6 if stamp == 0 else 0.0
    np.testing.assert_allclose(found, truth.time_s + late_s, atol=3e-6)
    assert ("not set" in " ".join(recording.found())) == (stamp == 0)


def test_the_name_of_the_sensor_may_be_given(tmp_path: pathlib.Path) -> None:
    path = save(tmp_path / "a.pcap", packets_of("extended spherical", 20))
    assert "Avia, Horizon, Tele-15" in PacketRecording(path).found()[0] and PacketRecording(path).sensor == ""
    recording = PacketRecording(path, sensor="livox-avia")
    assert recording.sensor == "livox-avia" and "Livox Avia (livox-avia)" in recording.found()[0]
    for other in ("hesai-xt32", "livox-mid360"):
        with pytest.raises(FormatError, match=f"'{other}' does not send these packets, which are those of a Livox"):
            PacketRecording(path, sensor=other)
    with pytest.raises(FormatError, match="leave out --metadata angles.csv"):
        PacketRecording(path, "angles.csv")


def test_late_packets_and_a_clock_that_goes_back(tmp_path: pathlib.Path) -> None:
    kind = KINDS["mid360 spherical"]
    one = packet(kind, observe(kind, 1), 0)

    def at(time_s: float) -> bytes:
        return one[:28] + struct.pack("<Q", round(time_s * 1e9)) + one[36:]
    data = [at(T0 + 480e-6 * k) for k in range(410)]
    data[205:215] = data[214:204:-1]  # about the border of the first scans
    came = [(T0 + 480e-6 * k, piece) for k, piece in enumerate(data)]
    scans = list(PacketRecording(save(tmp_path / "late.pcap", came)).scans())
    assert [len(scan) // 1000 for scan in scans] == [19, 19] and sum(map(len, scans)) == 410 * 96
    back = came + [(T0 + 0.3 + 480e-6 * k, at(T0 - 50 + 480e-6 * k)) for k in range(410)]
    scans = list(PacketRecording(save(tmp_path / "back.pcap", back), clock="sensor").scans())
    assert sum(map(len, scans)) == 820 * 96 and 4 <= len(scans) <= 6


def test_packets_of_the_other_coordinates_are_left_out(tmp_path: pathlib.Path) -> None:
    first = packets_of("extended spherical", 30)
    then = packets_of("extended cartesian", 20, observe(KINDS["extended cartesian"], 20, T0 + 0.3))
    recording = PacketRecording(save(tmp_path / "a.pcap", first + then))
    assert recording.organised and sum(map(len, recording.scans())) == 30 * 96
    assert recording.skipped == {"packets of the other kind of coordinates": 20}


def test_the_kind_of_data_may_change(tmp_path: pathlib.Path) -> None:
    first = packets_of("extended spherical", 30)
    then = packets_of("dual spherical", 30, observe(KINDS["dual spherical"], 30, T0 + 0.3))
    recording = PacketRecording(save(tmp_path / "a.pcap", first + then))
    scans = list(recording.scans())
    assert sum(int((scan.echo <= 1).sum()) for scan in scans if scan.echo is not None) == 30 * (96 + 48)
    assert "dual return and single return" in recording.found()[0]


def test_what_is_left_out_is_counted(tmp_path: pathlib.Path) -> None:
    packets = packets_of("mid360 spherical", 20)
    inertial = b"\0" + struct.pack("<HHHHBBB", 60, 0, 1, 1, 0, 0, 1) + b"\0" * 16 + b"\0" * 8 + b"\0" * 24
    blank = packets[5][1][:36 + 10 * 7] + b"\0" * 10 + packets[5][1][36 + 10 * 8:]  # Neither depth nor angles.
    damaged = [*packets[:3], (packets[3][0], packets[3][1][:-1]), packets[4], packets[4], (packets[5][0], blank),
               (packets[6][0], b"\1" + packets[6][1][1:]), (packets[7][0], inertial), *packets[8:]]
    recording = PacketRecording(save(tmp_path / "a.pcap", damaged))
    assert sum(map(len, recording.scans())) == 17 * 96 - 1
    assert recording.skipped == {"packets of another length": 2, "packets captured twice": 1, NO_DIRECTION: 1,
                                 "packets of the sensor's inertial unit": 1}


def test_two_sensors_are_told_apart(tmp_path: pathlib.Path) -> None:
    one, two = packets_of("mid360 spherical", 30), packets_of("extended spherical", 20)
    path = tmp_path / "a.pcap"
    path.write_bytes(pf.pcapng(sorted(
        [(time_s, pf.udp(data, source="192.168.1.3", port=56301)[0]) for time_s, data in one]
        + [(time_s, pf.udp(data, source="192.168.1.4", port=56001)[0]) for time_s, data in two])))
    with pytest.raises(FormatError, match=r"2 sensors: add --topic 192.168.1.\d:56\d01 or --topic"):
        PacketRecording(path)
    recording = PacketRecording(path, stream="192.168.1.3")
    assert recording.sensor == "livox-mid360" and sum(map(len, recording.scans())) == 30 * 96
    assert recording.skipped == {"datagrams to other ports or of other senders": 20}


def test_mutants_are_read_or_refused(tmp_path: pathlib.Path) -> None:
    """A few of those that `mutate_packets.py` makes."""
    assert sum(mutate_packets.run("livox", 96, 22, tmp_path).values()) == 96
