"""Packets of Hesai's AT128 and its correction file, as the maker's drivers describe them."""
from __future__ import annotations

import pathlib
import struct

import numpy as np
import numpy.typing as npt

import hesai_unit as hu
from packet_files import T0, Floats

STARTS = (23.0, 143.0, 263.0)  #: Degrees of the mirror at which its faces begin.
AZIMUTH = np.where(np.arange(128) % 2 == 0, -2.4, 0.65)
ELEVATION = 12.9 - 0.2 * np.arange(128)
STEPS = np.arange(180)
#: Corrections in steps of 0.02 degrees by every second degree of the mirror.
AZIMUTHS = np.round(10 * np.sin(np.radians(2 * STEPS)) + np.arange(128)[:, None] % 5).astype(np.int8)
ELEVATIONS = np.round(6 * np.cos(np.radians(4 * STEPS)) - np.arange(128)[:, None] % 3).astype(np.int8)


def correction(path: pathlib.Path) -> pathlib.Path:
    """The unit's file, whose unit of angles is twice the smallest one."""
    unit = 2 / 25600
    data = b"\xee\xff\x01\x05" + bytes([128, 3, 3]) + b"\1\2\4" + b"\0" * 5 + b"\2"
    for values in (STARTS, (*STARTS[1:], STARTS[0])):
        data += struct.pack("<3I", *(round(value / unit) for value in values))
    for column in (AZIMUTH, ELEVATION):
        data += struct.pack("<128i", *(round(value / unit) for value in column))
    path.write_bytes(data + AZIMUTHS.tobytes() + ELEVATIONS.tobytes() + b"\0" * 32)
    return path


def direction_at(mirror_deg: Floats) -> Floats:
    """(n, 128, 3) directions: twice the mirror's way, less the laser's own azimuth, corrected."""
    begin = np.array(STARTS)[np.searchsorted(STARTS, mirror_deg % 360, side="right") - 1]
    places = np.append(2 * STEPS, 360)
    azimuth, elevation = (np.array([np.interp(mirror_deg % 360, places, 0.02 * np.append(row, row[0])) for row in table]).T
                          for table in (AZIMUTHS, ELEVATIONS))
    clockwise = np.radians(2 * ((mirror_deg - begin) % 360)[:, None] - AZIMUTH + azimuth)
    up = np.radians(ELEVATION + elevation)
    return np.stack([np.sin(clockwise) * np.cos(up), np.cos(clockwise) * np.cos(up), np.sin(up)], -1)


def packets(columns_deg: Floats, time_s: Floats, counts: npt.NDArray[np.int64], returns: int,
            flags: int = 1) -> list[tuple[float, bytes]]:
    """Packets of two blocks: columns at azimuths of the mirror and times (s), with (n, returns, 128) counts."""
    out = []
    for begin in range(0, len(time_s), 2 // returns):
        body = b""
        for column in range(begin, begin + 2 // returns):
            for which in range(returns):
                fine = round(columns_deg[column] * 25600) % (360 * 25600)
                body += struct.pack("<HB", fine >> 8, fine & 255) + b"".join(
                    struct.pack("<HBB", count, count % 200, 9) for count in counts[column, which].tolist())
        stamp_s = time_s[begin + 2 // returns - 1] + (9.249 + 41.666) * 1e-6
        head = b"\xee\xff\4\3\0\0" + bytes([128, 2, returns - 1, 4, returns, flags])
        tail = b"\0" * 18 + struct.pack("<hI", 200, round(stamp_s % 1 * 1e6)) + bytes([0x37 if returns == 1 else 0x39, 0x42])
        tail += hu.date_of(stamp_s, "whole") + (b"\1\0\0\0" if flags & 1 else b"") + b"\3\2\1\0" + b"s" * (4 * (flags & 8))
        out.append((stamp_s + 1e-4, head + body + b"\1\2\3\4" + tail))
    return out


def sweeps(number: int) -> tuple[Floats, Floats]:
    """Azimuths of the mirror and times of columns: 1200 a sweep of 50 ms, seen by one face after the other."""
    columns = np.arange(1200)
    mirror = np.concatenate([STARTS[k % 3] + 15 + 0.05 * columns for k in range(number)]) + 1 / 512
    return mirror, T0 + np.concatenate([0.1 * k + 41.666e-6 * columns for k in range(number)])
