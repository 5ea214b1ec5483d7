"""Times of Velodyne packets: stamps, hours, clocks that are not set."""
from __future__ import annotations

import pathlib
import struct

import numpy as np
import pytest

import packet_files as pf
from packet_files import T0, Floats
from underbrush.errors import FormatError
from underbrush.formats import velodyne
from underbrush.formats.packets import PacketRecording
from velodyne_unit import UNITS, joined, observe, packets_of, save


def times_of(tmp_path: pathlib.Path, packets: list[tuple[float, bytes]]) -> tuple[Floats, PacketRecording]:
    recording = PacketRecording(save(tmp_path / "a.pcap", packets))
    scans = list(recording.scans())
    return joined(scans, "beam_time_s"), recording


def test_stamps_that_begin_again_every_hour(tmp_path: pathlib.Path) -> None:
    start = T0 - 200.0 - 0.05
    truth = observe(UNITS["vlp16"], 24 * 80, start_s=start)
    times, recording = times_of(tmp_path, packets_of(UNITS["vlp16"], truth, 0x37, start_s=start))
    assert times == pytest.approx(truth.time_s, abs=3e-6)
    assert "which is set" in " ".join(recording.found())


@pytest.mark.parametrize("off", [700.0, 1800.0, 3000.0])
def test_a_clock_that_is_not_set_starts_at_the_capture(tmp_path: pathlib.Path, off: float) -> None:
    """It runs over the hour within the recording, and also lies half an hour off, where hours are ambiguous."""
    truth = observe(UNITS["vlp16"], 24 * 80)
    packets = [(time_s + 1e-4 * (-1)**k, data[:-6] + struct.pack("<I", round((time_s + off) % 3600 * 1e6)) + data[-2:])
               for k, (time_s, data) in enumerate(packets_of(UNITS["vlp16"], truth, 0x37))]
    times, recording = times_of(tmp_path, packets)
    assert times - times[0] == pytest.approx(truth.time_s - truth.time_s[0], abs=3e-6)
    assert times[0] == pytest.approx(packets[0][0], abs=1e-6)
    assert "is not set" in " ".join(recording.found())


@pytest.mark.parametrize("off", [-13.0, 700.0])
def test_which_clock_is_believed(tmp_path: pathlib.Path, off: float) -> None:
    truth = observe(UNITS["vlp16"], 24 * 40)
    path = save(tmp_path / "a.pcap", [(time_s - off, data) for time_s, data in packets_of(UNITS["vlp16"], truth, 0x37)])
    begins = {clock: next(PacketRecording(path, clock=clock).scans()).time_s for clock in ("auto", "sensor", "capture")}
    captured = T0 - off + 24 * 55.296e-6
    expected = {"sensor": T0, "capture": captured, "auto": T0 if abs(off) < 60 else captured}
    assert begins == pytest.approx(expected, abs=2e-6)
    with pytest.raises(FormatError, match="clock 'x' is none of auto, sensor, capture"):
        PacketRecording(path, clock="x")


def test_a_jump_of_the_clock_is_told(tmp_path: pathlib.Path) -> None:
    truth = observe(UNITS["vlp16"], 24 * 80)
    packets = [(time_s, data[:-6] + struct.pack("<I", round((time_s - T0 + 400 + 400 * (k > 40)) * 1e6)) + data[-2:])
               for k, (time_s, data) in enumerate(packets_of(UNITS["vlp16"], truth, 0x37))]
    times, recording = times_of(tmp_path, packets)
    assert times == pytest.approx(truth.time_s + packets[0][0] - T0, abs=3e-6)
    assert "number of jumps: 1" in " ".join(recording.found())


def test_a_damaged_stamp_moves_its_own_packet_only(tmp_path: pathlib.Path) -> None:
    truth = observe(UNITS["vlp16"], 24 * 80)
    packets = [(time_s + 1e-3 * (k % 3), data[:-6] + struct.pack(
        "<I", round((time_s - T0 + 400) * 1e6) ^ (k == 40) << 30) + data[-2:])
        for k, (time_s, data) in enumerate(packets_of(UNITS["vlp16"], truth, 0x37))]
    times, recording = times_of(tmp_path, packets)
    keep = np.repeat(np.arange(80) != 40, 384)
    assert times[keep] == pytest.approx(truth.time_s[keep] + packets[0][0] - T0, abs=3e-6)
    assert np.abs(times - truth.time_s).max() < 0.01
    assert "number of jumps: 2" in " ".join(recording.found())


def test_the_hour_comes_from_gps(tmp_path: pathlib.Path) -> None:
    """The clock of the recording computer is wrong by 5 hours, 50 minutes."""
    unit, wrong = UNITS["vlp16"], 21000.0
    truth = observe(unit, 24 * 80)
    packets = [(time_s + wrong, data) for time_s, data in packets_of(unit, truth, 0x37)]
    sentence = b"$GPRMC,120319.00,A,3649.74,N,00224.45,W,0.034,212.5,130920,0.0,E,A*2E\r\n"  # T0 - 1 s.
    position = (bytes(198) + struct.pack("<I", 200_000_000) + b"\2\0\0\0" + sentence).ljust(512, b"\0")
    records = [(time_s, pf.udp(data)[0]) for time_s, data in packets]
    path = tmp_path / "a.pcap"
    path.write_bytes(pf.pcap([(T0 + wrong, pf.udp(position, port=8308)[0]), *records]))
    recording = PacketRecording(path)
    assert joined(list(recording.scans()), "beam_time_s") == pytest.approx(truth.time_s, abs=3e-6)
    assert "set by GPS" in " ".join(recording.found())
    assert velodyne.utc_of(position.replace(b",A,", b",V,")) is None
    assert velodyne.utc_of(b"") is None


def test_packets_without_stamps_get_the_time_of_capture(tmp_path: pathlib.Path) -> None:
    truth = observe(UNITS["vlp16"], 24 * 80)
    packets = [(time_s, data[:-6] + b"\0" * 4 + data[-2:]) for time_s, data in packets_of(UNITS["vlp16"], truth, 0x37)]
    times, recording = times_of(tmp_path, packets)
    assert times == pytest.approx(truth.time_s, abs=3e-6)
    assert "no stamps" in " ".join(recording.found())


# Odd captures.
