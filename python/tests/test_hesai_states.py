"""Packets of Hesai's QT128, Pandar128 and OT128, whose channels do not all fire at a time: closed forms in a room."""
from __future__ import annotations

import dataclasses
import pathlib
import struct

import numpy as np
import pytest

import packet_files as pf
from hesai_unit import date_of
from packet_files import T0, Floats
from underbrush.errors import FormatError
from underbrush.formats.packets import PacketRecording
from velodyne_unit import joined, save

LASERS, RATE_DEG_S, START_DEG = 128, 3600.0, 350.0
ELEVATION, CLOCKWISE = 24.0 - 0.375 * np.arange(LASERS), 0.5 * (np.arange(LASERS) % 5 - 2)


@dataclasses.dataclass(frozen=True)
class Kind:
    """A model as its manual describes it, in one mode of operation; times are µs."""

    protocol: tuple[int, int]
    period_us: float
    first_us: float  #: Time after the stamp of the packet's first block (`stamps_first`) or of its last one; as the SDK.
    stamps_first: bool
    states: tuple[int, ...]  #: States of successive firings, in turn.
    operation: int = 0
    columns: int = 2  #: Columns that the file of firing times has for a state.


KINDS = {
    "qt128": Kind((3, 2), 111.11, 9.0, True, (0, 1)),
    "pandar128, high resolution": Kind((1, 4), 27.778, 3.148, False, (0, 1, 2, 3)),
    "pandar128, standard": Kind((1, 4), 2 * 27.778, 3.148, False, (4, 5), 2),
    "pandar128, energy saving": Kind((1, 4), 2 * 27.778, 3.148, False, (6, 7), 3),
    "ot128, high resolution": Kind((1, 4), 27.778, 0.0, False, (0, 1, 2, 3), 0, 1),
    "ot128, standard": Kind((1, 4), 2 * 27.778, 0.0, False, (4, 5), 2, 1),
}
#: Flags of the header: sequence, inertial unit, safety, signature, and bytes of a return.
FLAGS = {"plain": 0, "usual": 0x15, "all": 0x7F}


def times_us(kind: Kind) -> Floats:
    """(states, lasers): three of four channels fire in a state, but all in the modes of half the resolution."""
    state, laser = np.mgrid[:2 if kind.protocol == (3, 2) else 8 if kind.columns == 2 else 6, :LASERS]
    times = 1.456 + 0.168 * ((laser * 37 + state * 11) % LASERS)
    return np.where((laser + state) % 4 == 0, np.nan, times) if state.max() == 1 else np.where(
        (state < 4) & ((laser + state) % 4 == 0), np.nan, times)


def folder(path: pathlib.Path, kind: Kind) -> pathlib.Path:
    """The unit's two files."""
    path.mkdir(exist_ok=True)
    rows = [f"{k + 1},{ELEVATION[k]:.3f},{CLOCKWISE[k]:.3f}" for k in range(LASERS)]
    (path / "angles.csv").write_text("\r\n".join(["Laser id,Elevation,Azimuth", *rows, ""]))
    us = times_us(kind)
    if kind.protocol == (3, 2):
        shots = [[(k + 1, us[loop, k]) for k in np.argsort(us[loop]) if us[loop, k] == us[loop, k]] for loop in (0, 1)]
        lines = ["EEFF,1,1,", "Horizontal Resolution Mode,1,LoopNum,2", "Loop1,Firetime1,Loop2,Firetime2"]
        lines += [",".join(f"{channel},{time:.3f}" for channel, time in pair) for pair in zip(*shots)] + ["5e4a3fe9"]
    elif kind.columns == 2:
        lines = ["\ufeff2.85" + ",distance>=A1,distance<A1" * 8, "operation mode" + ",0" * 8 + ",2" * 4 + ",3" * 4,
                 "angle state,0,0,1,1,2,2,3,3,0,0,1,1,0,0,1,1"]
        lines += [f"{k + 1}," + ",".join(f"{time:.0f},{time + 765:.0f}" if time == time else "0,0"
                                         for time in us[:, k] * 1000) for k in range(LASERS)]
    else:
        lines = ["Operational State,0,0,0,0,2,2", "Azimuth State,0,1,2,3,0,1"]
        lines += [f"{k + 1}," + ",".join(f"{time:.3f}" if time == time else "-" for time in us[:, k])
                  for k in range(LASERS)]
    (path / "times.csv").write_text("\n".join([*lines, ""]), encoding="utf-8")
    return path


@dataclasses.dataclass
class Seen:
    """What the sensor sees: (firings, lasers) each. Counts of channels that do not fire are 0, as those of misses."""

    direction: Floats
    time_s: Floats
    after_s: Floats  #: Since the start of the firing.
    counts: np.ndarray
    state: np.ndarray
    block_s: Floats


def observe(kind: Kind, firings: int) -> Seen:
    block_s = T0 + np.arange(firings) * kind.period_us * 1e-6
    state = np.resize(kind.states, firings)
    after_s = np.round(times_us(kind), 3)[state] * 1e-6
    azimuth = np.radians(START_DEG + RATE_DEG_S * (block_s[:, None] - T0 + after_s) + CLOCKWISE)
    elevation = np.radians(np.broadcast_to(ELEVATION, azimuth.shape))
    direction = np.stack([np.sin(azimuth) * np.cos(elevation), np.cos(azimuth) * np.cos(elevation), np.sin(elevation)], -1)
    counts = np.where(np.isnan(after_s) | (ELEVATION > 18), 0, np.round(pf.room_range(direction) / 0.004))
    return Seen(direction, block_s[:, None] + after_s, after_s, counts.astype(np.int64), state, block_s)


def packets_of(kind: Kind, seen: Seen, flags: int, returns: int = 1) -> list[tuple[float, bytes]]:
    """Two blocks a packet; with two returns they are of one firing, and the second return is 100 counts farther."""
    groups, is_qt = 2 // returns, kind.protocol == (3, 2)
    more = b"m" * sum(bool(flags & flag) for flag in ((0x10,) if is_qt else (0x10, 0x20, 0x40)))
    out = []
    for begin in range(0, len(seen.block_s) - groups + 1, groups):
        data = b"\xee\xff" + bytes([*kind.protocol, 0, 0, LASERS, 2, 0, 4, returns, flags])
        for block in range(2):
            k = begin + block // returns
            rotor = START_DEG + RATE_DEG_S * (seen.block_s[k] - T0)
            data += struct.pack("<H", round(rotor * 100) % 36000)
            for count in seen.counts[k].tolist():
                data += struct.pack("<HB", count + (100 if block and returns == 2 and count else 0), count % 200) + more
        at = begin if kind.stamps_first else begin + groups - 1
        stamp_s = seen.block_s[at] - kind.first_us * 1e-6
        loop = (int(seen.state[begin]) + 1) % 2 if is_qt else 0
        states = 0
        for block in range(2):
            states |= (int(seen.state[begin + block // returns]) - min(kind.states)) << (2 * (7 - block))
        data += b"c" * 4 + (b"f" * 17 if flags & 4 else b"") + b"\0" * 5 + bytes([loop]) + b"\0" * 3
        data += struct.pack("<HBB", states, kind.operation, 0x39 if returns == 2 else 0x37) + struct.pack("<H", 600)
        data += date_of(stamp_s, "1900") + struct.pack("<I", round(stamp_s % 1 * 1e6)) + b"\x42"
        data += b"\1\0\0\0" * (flags & 1) + (b"i" * 22 if flags & 2 and not is_qt else b"") + b"c" * 4
        data += b"s" * 32 if flags & 8 else b""
        out.append((float(seen.block_s[begin + groups - 1]) + 150e-6, data))
    return out


@pytest.mark.parametrize("returns", [1, 2])
@pytest.mark.parametrize("flags", FLAGS)
@pytest.mark.parametrize("name", KINDS)
def test_what_fires_is_read_and_nothing_else(tmp_path: pathlib.Path, name: str, flags: str, returns: int) -> None:
    kind = KINDS[name]
    seen = observe(kind, 240)
    set_flags = FLAGS[flags] & (0x3F if kind.protocol == (3, 2) else 0xFF)  # Its last one: channels of the user's choice.
    path = save(tmp_path / "a.pcap", packets_of(kind, seen, set_flags, returns))
    recording = PacketRecording(path, folder(tmp_path / "unit", kind))
    scans = list(recording.scans())
    assert not recording.skipped and ("dual return" in recording.found()[0]) == (returns == 2)
    fired = np.isfinite(seen.time_s)
    assert fired.all() == (min(kind.states) >= 4)
    order = np.lexsort((seen.after_s[fired], np.nonzero(fired)[0]))
    ring, echo = joined(scans, "ring"), joined(scans, "echo")
    beam = np.cumsum(echo <= 1) - 1
    assert beam[-1] + 1 == fired.sum()
    assert (ring == np.nonzero(fired)[1][order][beam]).all()
    assert np.abs(joined(scans, "beam_time_s") - seen.time_s[fired][order][beam]).max() < 2e-6
    angle = np.arccos(np.clip((joined(scans, "direction") * seen.direction[fired][order][beam]).sum(axis=1), -1, 1))
    assert np.degrees(angle).max() < 0.04  # Azimuths are in steps of 0.01 degrees, and so are speeds in 28 µs.
    counts = seen.counts[fired][order][beam]
    assert ((counts == 0) == (echo == 0)).all() and (echo == 0).any()
    expected = np.where(counts == 0, np.inf, (counts + 100 * (echo == 2)) * 0.004)
    np.testing.assert_allclose(joined(scans, "range_m"), expected, atol=1e-4)


def test_a_folder_with_both_files_is_asked_for(tmp_path: pathlib.Path) -> None:
    kind = KINDS["qt128"]
    path, unit = save(tmp_path / "a.pcap", packets_of(kind, observe(kind, 40), 0x15)), folder(tmp_path / "unit", kind)
    for given in (None, unit / "angles.csv"):
        with pytest.raises(FormatError, match="a Hesai QT128 fires some of its channels at a time.*--metadata FOLDER"):
            PacketRecording(path, given)
    with pytest.raises(FormatError, match="absent: no such file or folder"):
        PacketRecording(path, tmp_path / "absent")
    with pytest.raises(FormatError, match="the firing times in .* are not those of a Hesai QT128"):
        PacketRecording(path, folder(tmp_path / "other", KINDS["ot128, standard"]))
    (unit / "more.csv").write_text((unit / "angles.csv").read_text())
    with pytest.raises(FormatError, match="unit: has 2 files of angles and 1 of firing times of a Hesai"):
        PacketRecording(path, unit)
    chosen = save(tmp_path / "chosen.pcap", packets_of(kind, observe(kind, 40), 0x55))
    (unit / "more.csv").unlink()
    with pytest.raises(FormatError, match="QT128 whose channels the user has chosen are not decoded"):
        PacketRecording(chosen, unit)


LOOPS, STATES = "EEFF,1,1\na,1,LoopNum,", "Operational State,0,0,0,0,2,2\nAzimuth State,0,1,2,3,0,1\n"


@pytest.mark.parametrize("text", [
    LOOPS + "9\nx\n", LOOPS + "2\nx\n1,2,3,x\n", LOOPS + "1\nx\n300,1\n", LOOPS + "1\nx\n", LOOPS + "2\nx\n1,2,3\n",
    LOOPS + "2\nx\n1,2,0,0\n", LOOPS + "1\nx\n1,2\n1,3\n", STATES + "2,1,1,1,1,1,1\n", STATES + "1,1,1,1,1,1,1e9\n",
    STATES + "1,1,1\n2,1\n", STATES + "1,1,1,1,-,1,1\n", STATES, "Operational State,0\nAzimuth State\n1,1\n",
    STATES.replace("0,2,2", "2,2,0") + "1,1,1,1,1,1,1\n", "2.85\noperation mode\nx\n"])
def test_bad_times_have_one_line(tmp_path: pathlib.Path, text: str) -> None:
    kind = KINDS["qt128"]
    path, unit = save(tmp_path / "a.pcap", packets_of(kind, observe(kind, 40), 0x15)), folder(tmp_path / "unit", kind)
    (unit / "times.csv").write_text(text)
    with pytest.raises(FormatError) as error:
        PacketRecording(path, unit)
    assert "\n" not in str(error.value) and "times.csv: is no file of firing times" in str(error.value)


def test_other_files_of_the_folder_do_not_matter(tmp_path: pathlib.Path) -> None:
    kind = KINDS["qt128"]
    path, unit = save(tmp_path / "a.pcap", packets_of(kind, observe(kind, 40), 0x15)), folder(tmp_path / "unit", kind)
    (unit / "channels.csv").write_text("EEFF,1,1\nLaserNum,128,BlockNum,2\n1,2\n")
    (unit / "notes.txt").write_text("Elevation")
    (unit / "folder.csv").mkdir()
    (unit / "angles.csv").rename(unit / "angles.CSV")
    assert sum(map(len, PacketRecording(path, unit).scans())) == 96 * 40
    one = (unit / "times.csv").read_text().replace("LoopNum,2", "LoopNum,1")
    (unit / "times.csv").write_text("".join(",".join(line.split(",")[:2]) + "\n" if line.count(",") == 3 and line[0].isdigit()
                                            else line + "\n" for line in one.splitlines()))
    with pytest.raises(FormatError, match="whose channels the user has chosen are not decoded"):
        PacketRecording(path, unit)


def test_ranges_of_an_ot128_that_are_codes(tmp_path: pathlib.Path) -> None:
    kind = KINDS["ot128, standard"]
    seen = observe(kind, 240)
    code = np.resize([0, 1, 2, 3, 4], seen.counts.shape)
    seen.counts = np.where(seen.counts > 0, np.where(code < 4, code, seen.counts), 3)
    recording = PacketRecording(save(tmp_path / "a.pcap", packets_of(kind, seen, 0)), folder(tmp_path / "unit", kind))
    scans = list(recording.scans())
    close = np.isin(seen.counts, (1, 2))
    assert recording.skipped == {"beams that end too close to be measured": close.sum()}
    assert sum(map(len, scans)) == (~close).sum()
    order = np.lexsort((seen.after_s.ravel(), np.nonzero(seen.counts >= 0)[0]))
    kept = seen.counts.ravel()[order][~close.ravel()[order]]
    np.testing.assert_allclose(joined(scans, "range_m"), np.where(kept > 3, kept * 0.004, np.inf), atol=1e-4)
    with pytest.raises(FormatError, match="a Hesai Pandar128 or OT128 fires some of its channels at a time"):
        PacketRecording(tmp_path / "a.pcap", tmp_path / "unit" / "angles.csv")


def test_returns_of_channels_that_do_not_fire_are_counted(tmp_path: pathlib.Path) -> None:
    kind = KINDS["qt128"]
    seen = observe(kind, 240)
    packets = packets_of(kind, dataclasses.replace(seen, state=1 - seen.state), 0x15)  # The loops are exchanged.
    recording = PacketRecording(save(tmp_path / "a.pcap", packets), folder(tmp_path / "unit", kind))
    list(recording.scans())
    assert recording.skipped["returns of channels that do not fire then"] > 1000


def test_unknown_modes_are_counted(tmp_path: pathlib.Path) -> None:
    kind = KINDS["pandar128, standard"]
    packets = packets_of(kind, observe(kind, 240), 0)
    tail = len(packets[0][1]) - 4 - 26
    for number, operation in ((10, 9), (11, 1), (12, 0)):  # The last one is a mode of another period.
        time_s, data = packets[number]
        packets[number] = time_s, data[:tail + 11] + bytes([operation]) + data[tail + 12:]
    recording = PacketRecording(save(tmp_path / "a.pcap", packets), folder(tmp_path / "unit", kind))
    assert sum(map(len, recording.scans())) == 128 * (240 - 6)
    assert recording.skipped == {"blocks in an unknown mode of firing": 4,
                                 "blocks in another mode of firing than the first ones": 2}
