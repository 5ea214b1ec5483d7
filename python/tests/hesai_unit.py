"""Hesai units whose packets the tests write, as their manuals describe them, with what their beams measured."""
from __future__ import annotations

import dataclasses
import datetime
import pathlib
import struct

import numpy as np
import numpy.typing as npt

import packet_files as pf
from packet_files import T0, Floats

Ints = npt.NDArray[np.int64]

#: Pandar40P: lasers in order of time, the last one first, and the steps between them: A is 0, B 1.304, C 1.968 µs.
PANDAR40_LASERS = (4, 40, 36, 28, 12, 16, 32, 24, 29, 17, 3, 39, 35, 25, 9, 13, 31, 21, 26, 14, 2, 38, 34, 6, 22, 10, 30,
                   18, 23, 11, 1, 37, 33, 5, 19, 7, 27, 15, 20, 8)
PANDAR40_STEPS = "ABBCABCBCBABBCABCBCBABCACBCCCBABCACBCCC"
#: Pandar64: channels that fire at the same time, the last ones first; then steps of 1.304 µs and of 1.968 µs.
PANDAR64_PAIRS = ((51, 61), (45, 60), (39, 57), (9, 55), (49, 63), (43, 59), (7, 56), (53, 64), (47, 62), (41, 58),
                  (6, 54), (5, 48), (4, 50), (3, 52), (2, 46), (1, 44), (24, 33), (27, 42), (21, 36), (15, 30), (22, 37),
                  (16, 31), (10, 25), (19, 34), (13, 28), (20, 35), (14, 29), (8, 23), (17, 32), (11, 26), (18, 38),
                  (12, 40))
PANDAR64_ELEVATIONS = {1: 14.708, 5: 2.866, 20: -0.511, 54: -6.235, 63: -19.063, 64: -25.071}
PANDAR64_AZIMUTHS = {1: -1.042, 7: 1.042, 8: 3.125, 9: 5.208, 10: -5.208, 11: -3.125, 64: -1.042}


@dataclasses.dataclass
class Unit:
    """A sensor as its manual describes it. Times are of channels, µs after the time of the block."""

    sensor: str
    lasers: int
    blocks: int
    kind: str  #: pandar40, pandar64, xt or qt.
    elevation: list[float]
    clockwise: list[float]
    laser_us: list[float]
    block_us: float  #: Time of the last block after the packet's stamp.
    period_us: float
    step_mm: int = 4
    needs_file: bool = False
    stamps_first: bool = False  #: The stamp counts from the packet's first block, and `block_us` is the time of that.


def qt64_us() -> list[float]:
    """The times of channels 1 to 64: groups of eight, whose steps the manual rounds to 0.01 µs."""
    groups = (2.31, 19.16, 36.61, 53.45, 70.9, 87.75, 105.2, 122.05)
    steps = (0, 2.06, 4.12, 6.18, 8.23, 10.29, 12.35, 14.4)
    return [group + step for group in groups for step in steps]


def pandar40_us() -> list[float]:
    """The times of lasers 1 to 40."""
    times, at = [0.0] * 40, 3.62
    for place, laser in enumerate(PANDAR40_LASERS):
        times[laser - 1] = -at
        at += {"A": 0.0, "B": 1.304, "C": 1.968, "": 0.0}[PANDAR40_STEPS[place:place + 1]]
    return times


def pandar64_us() -> list[float]:
    times = [0.0] * 64
    for place, pair in enumerate(PANDAR64_PAIRS):
        for channel in pair:
            times[channel - 1] = -(3.62 + 1.304 * min(place, 15) + 1.968 * max(place - 15, 0))
    return times


def pandar64() -> Unit:
    """Angles of channels that the test does not list are the catalogue's."""
    from underbrush.formats import catalogue
    file = catalogue.load("hesai-pandar64")
    elevation, clockwise = file.elevation_deg.tolist(), (-file.azimuth_deg).tolist()
    assert {channel: elevation[channel - 1] for channel in PANDAR64_ELEVATIONS} == PANDAR64_ELEVATIONS
    assert {channel: clockwise[channel - 1] for channel in PANDAR64_AZIMUTHS} == PANDAR64_AZIMUTHS
    return Unit("hesai-pandar64", 64, 6, "pandar64", elevation, clockwise, pandar64_us(), -42.58, 55.56)


UNITS = {
    "pandar40p": Unit("", 40, 10, "pandar40", [15 - 0.9 * k for k in range(40)], [(k % 5 - 2) * 2.1 for k in range(40)],
                      pandar40_us(), -28.58, 55.56, needs_file=True),
    "pandar64": pandar64(),
    "xt32": Unit("hesai-xt32", 32, 8, "xt", [15.0 - k for k in range(32)], [0.0] * 32,
                 [0.368 + 1.512 * k for k in range(32)], 5.632, 50),
    "xt16": Unit("", 16, 8, "xt", [15.0 - 2 * k for k in range(16)], [0.0] * 16, [0.368 + 3.024 * k for k in range(16)],
                 5.632, 50),
    "xt32m": Unit("", 32, 6, "xt", [19.5 - 1.3 * k for k in range(32)], [0.01 * k for k in range(32)],
                  [0.368 + 2.888 * (k % 16) for k in range(32)], 5.632, 50, 5, needs_file=True),
    "qt64": Unit("", 64, 4, "qt", [52.1 - 1.65 * k for k in range(64)], [8.7 - 0.27 * k for k in range(64)], qt64_us(),
                 25.71, 500 / 3, needs_file=True, stamps_first=True),
}
MODES = {"strongest": (0x37, 1), "first": (0x33, 1), "dual": (0x39, 2), "first and last": (0x3B, 2)}


@dataclasses.dataclass
class Truth:
    """What a sensor in the room sees: (firings, channels) each; returns (firings, returns, channels) in counts."""

    direction: Floats
    time_s: Floats
    counts: Ints
    block_s: Floats  #: (firings,)
    azimuth_deg: Floats  #: (firings,), of the rotor.


def observe(unit: Unit, firings: int, returns: int = 1, rate_deg_s: float = 3600.0, start_deg: float = 350.0,
            start_s: float = T0) -> Truth:
    """Beams above 8 degrees are misses; those of every third channel have a return behind the first one."""
    block_s = np.arange(firings) * unit.period_us * 1e-6
    after_s = block_s[:, None] + np.array(unit.laser_us) * 1e-6
    azimuth = np.radians(start_deg + rate_deg_s * after_s + np.array(unit.clockwise))
    elevation = np.radians(np.broadcast_to(unit.elevation, azimuth.shape))
    direction = np.stack([np.sin(azimuth) * np.cos(elevation), np.cos(azimuth) * np.cos(elevation), np.sin(elevation)], -1)
    near = np.round(pf.room_range(direction) / (unit.step_mm * 0.001)).astype(np.int64)
    near[np.degrees(elevation) > 8] = 0
    channel = np.arange(unit.lasers)
    counts = np.stack([np.where((channel % 3 < k) & (near > 0), near + 300 * k, near) for k in (2, 0, 1)[:returns]], axis=1)
    if returns > 1:
        counts[:, 0, channel % 7 == 5] = 0  # Either may be absent.
        counts[:, 1, channel % 7 == 6] = 0
    return Truth(direction, start_s + after_s, counts, start_s + block_s, start_deg + rate_deg_s * block_s)


def date_of(time_s: float, form: str) -> bytes:
    """The six bytes of a time's date and second."""
    if form == "whole":
        return b"\0\0" + struct.pack(">I", int(time_s))
    day = datetime.datetime.fromtimestamp(int(time_s), datetime.timezone.utc)
    year = day.year - (1900 if form == "1900" else 2000)
    return bytes([year, day.month, day.day, day.hour, day.minute, day.second])


def packet(unit: Unit, truth: Truth, begin: int, mode: int, returns: int, flags: int = 1, form: str = "") -> bytes:
    """The packet whose first firing is `begin`."""
    firings = unit.blocks // returns
    body = b""
    for k in range(begin, begin + firings):
        for which in range(returns):
            counts = truth.counts[k, min(which, truth.counts.shape[1] - 1)].tolist()
            body += b"\xff\xee" if unit.kind == "pandar40" else b""
            body += struct.pack("<H", round(truth.azimuth_deg[k] * 100) % 36000)
            for count in counts:
                body += struct.pack("<HB", count, count % 200) + (b"\x07" if unit.kind in ("xt", "qt") else b"")
    stamp_s = truth.block_s[begin if unit.stamps_first else begin + firings - 1] - unit.block_us * 1e-6
    micro = struct.pack("<I", round(stamp_s % 1 * 1e6))
    sequence = b"\1\0\0\0" if flags & 1 else b""
    if unit.kind == "qt":
        head = b"\xee\xff\3\1\0\0" + bytes([unit.lasers, unit.blocks, returns - 1, unit.step_mm, returns, flags])
        tail = b"\0" * 10 + struct.pack("<H", 600) + micro + bytes([mode, 0x42])
        return head + body + tail + date_of(stamp_s, form or "1900") + sequence
    if unit.kind != "xt":
        head = b"" if unit.kind == "pandar40" else bytes([0xEE, 0xFF, unit.lasers, unit.blocks, returns - 1, unit.step_mm, 0, 0])
        tail = b"\0" * 5 + b"\0" + b"\0\0" + struct.pack("<H", 600) + micro + bytes([mode, 0x42])
        return head + body + tail + date_of(stamp_s, form or "2000") + sequence
    head = b"\xee\xff\6\1\0\0" + bytes([unit.lasers, unit.blocks, returns - 1, unit.step_mm, returns, flags])
    tail = b"\0" * 9 + b"\0" + bytes([mode]) + struct.pack("<H", 600) + date_of(stamp_s, form or "1900") + micro + b"\x42"
    return head + body + tail + sequence + (b"s" * 32 if flags & 8 else b"")


def packets_of(unit: Unit, truth: Truth, mode: int = 0x37, returns: int = 1, **options: str | int) -> list[tuple[float, bytes]]:
    """Times (s) and data of the packets."""
    firings = unit.blocks // returns
    starts = range(0, len(truth.block_s) // firings * firings, firings)
    return [(float(truth.block_s[begin + firings - 1]) + 120e-6, packet(unit, truth, begin, mode, returns, **options))
            for begin in starts]  # type: ignore[arg-type]


def correction(path: pathlib.Path, unit: Unit, title: str = "Channel,Elevation,Azimuth") -> pathlib.Path:
    """A unit's angle correction file."""
    rows = [f"{k + 1},{elevation:.3f},{azimuth:.3f}" for k, (elevation, azimuth) in
            enumerate(zip(unit.elevation, unit.clockwise))]
    path.write_text("\r\n".join([title, *rows, ""]))
    return path
