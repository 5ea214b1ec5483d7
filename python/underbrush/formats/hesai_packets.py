"""Layouts of Hesai's point cloud packets, as given by their headers.

Sources: the maker's manuals (Pandar40P, Pandar64, PandarXT) and drivers (HesaiLidar_SDK_2.0, HesaiLidar_General_SDK),
and Tier IV's driver Nebula (which has AT128, OT128 and both QT, too).
"""
from __future__ import annotations

import dataclasses
import functools
from typing import Any

import numpy as np
import numpy.typing as npt

#: Return modes of the tail: number of returns of a firing, and words for it.
MODES = {
    0x33: (1, "first return"), 0x34: (1, "second return"), 0x35: (1, "third return"), 0x36: (1, "fourth return"), 0x37: (1, "strongest return"), 0x38: (1, "last return"),
    0x39: (2, "dual return"), 0x3A: (2, "dual return"), 0x3B: (2, "dual return"), 0x3C: (2, "dual return"),
    0x3D: (3, "triple return"), 0x3E: (2, "dual return")}

_SEQUENCE, _INERTIAL, _SAFETY, _SIGNATURE = 1, 2, 4, 8  #: Flags of the header.
#: Flags of the header: each adds a byte to a return of protocol 1.4, and the first one to one of protocol 3.2.
_UNIT_BYTES = (0x10, 0x20, 0x40)
SELF_DEFINED = 0x40  #: Flag of the header of protocol 3.2: the user has chosen which channels fire.
PANDAR40, PANDAR64 = (0, 0), (0, 1)  #: Protocols that have no number: packets without a header, and with a short one.
XT, AT128, QT64, QT128, PANDAR128 = (6, 1), (4, 3), (3, 1), (3, 2), (1, 4)
#: Version of the protocol -> length of the tail and places in it of return mode, date and microseconds.
_TAILS = {PANDAR40: (22, 14, 16, 10), PANDAR64: (22, 14, 16, 10), XT: (24, 10, 13, 19), AT128: (32, 24, 26, 20),
          QT64: (24, 16, 18, 12), QT128: (26, 12, 15, 21), PANDAR128: (26, 12, 15, 21)}
#: Protocols with a check sum before the tail and one behind it; a flag adds 17 bytes of functional safety before it.
_SAFE = (QT128, PANDAR128)
#: Protocols with other bodies, which are recognised in order to name them.
_OTHERS = {(1, 8), (4, 7), (7, 2)}
_PANDAR40_BYTES = 10 * (4 + 40 * 3) + 22


@dataclasses.dataclass(frozen=True)
class Layout:
    """The layout that a packet's header gives."""

    protocol: tuple[int, int]
    lasers: int
    blocks: int
    unit_mm: int  #: Step of the range.
    flags: int  #: Optional parts.

    def difference(self, other: Layout | None) -> str:
        """How packets of another layout differ; empty where they do not."""
        if other is None or dataclasses.replace(other, flags=self.flags) != self:
            return "packets of another model"
        return "" if other == self else "packets whose flags (optional parts) are others than those of most packets"

    @property
    def is_decoded(self) -> bool:
        return self.protocol in _TAILS

    @property
    def sizes(self) -> tuple[int, ...]:
        """The lengths in bytes that packets may have; without a flag for it, the number of the packet may be absent."""
        size = self.packet.itemsize
        if self.protocol in (PANDAR40, PANDAR64):
            return size, size + 4
        check = 4 * (self.protocol == AT128 or self.protocol in _SAFE)  # Another one stands behind the blocks.
        inertial = 22 * bool(self.protocol == PANDAR128 and self.flags & _INERTIAL)
        signed = 32 * bool(self.protocol != QT64 and self.flags & _SIGNATURE)
        return (size + check + 4 * bool(self.flags & _SEQUENCE) + inertial + signed,)

    @property
    def packet(self) -> np.dtype[Any]:
        """Header, blocks and tail, without the optional parts at the end."""
        return _packet_of(self.protocol, self.lasers, self.blocks, self.flags)


@functools.lru_cache(maxsize=64)
def _packet_of(protocol: tuple[int, int], lasers: int, blocks: int, flags: int) -> np.dtype[Any]:
    """As `Layout.packet`."""
    headless, short, mirror = protocol == PANDAR40, protocol == PANDAR64, protocol == AT128
    if protocol in _SAFE:
        added = sum(bool(flags & flag) for flag in _UNIT_BYTES[:3 if protocol == PANDAR128 else 1])
    else:
        added = 0 if headless or short else 1
    unit = [("range", "<u2"), ("intensity", "u1"), ("more", "u1", (added,))]
    block = [*([("flag", "<u2")] if headless else []), ("azimuth", "<u2"), *([("fine", "u1")] if mirror else []),
             ("lasers", unit, (lasers,))]
    size, mode, date, stamp = _TAILS[protocol]
    names, formats, offsets = ["mode", "date", "stamp_us"], ["u1", ("u1", (6,)), "<u4"], [mode, date, stamp]
    if protocol in _SAFE:
        names += ["loop", "states", "operation"]
        formats += ["u1", "<u2", "u1"]
        offsets += [5, 9, 11]
    tail = np.dtype({"names": names, "formats": formats, "offsets": offsets, "itemsize": size})
    header = np.dtype((np.void, 0 if headless else 8 if short else 12))
    safety = 17 if protocol in _SAFE and flags & _SAFETY else 0
    fields = [*([] if headless else [("header", header)]), ("blocks", block, (blocks,)),
              *([("check", "<u4")] if mirror or protocol in _SAFE else []), ("safety", "u1", (safety,)), ("tail", tail)]
    return np.dtype(fields)


def layout_of(data: bytes) -> Layout | None:
    """The layout of a datagram; None where it is no point cloud of Hesai."""
    if len(data) < 12:
        return None
    if data[:2] == b"\xff\xee" and len(data) in (_PANDAR40_BYTES, _PANDAR40_BYTES + 4):
        return Layout(PANDAR40, 40, 10, 4, 0)
    if data[:2] != b"\xee\xff":
        return None
    version = (data[2], data[3])
    if version in _OTHERS or version in _TAILS and version[0]:
        lasers, blocks, unit_mm, flags = data[6], data[7], data[9], data[11]
    else:
        version, lasers, blocks, unit_mm, flags = PANDAR64, data[2], data[3], data[5], 0
    if not (lasers and blocks and unit_mm) or lasers * blocks > 2048:
        return None
    found = Layout(version, lasers, blocks, unit_mm, flags)
    return found if not found.is_decoded or len(data) in found.sizes else None


def seconds_of(date: npt.NDArray[np.uint8]) -> npt.NDArray[np.float64]:
    """Seconds since 1970 of (n, 6) dates: year, month, day, hour, minute, second; or 0 and whole seconds, big endian.

    Years count from 1900 or, below 70, from 2000. Dates that do not exist give some time, too: the clock jumps there.
    """
    year, month, day, hour, minute, second = (date[:, k].astype(np.int64) for k in range(6))
    year = np.where(year < 70, year + 2000, year + 1900)
    months = (year - 1970) * 12 + month - 1
    days = months.astype("datetime64[M]").astype("datetime64[D]").astype(np.int64) + day - 1
    calendar = ((days * 24 + hour) * 60 + minute) * 60 + second
    whole = date[:, 2:].astype(np.int64) @ (1 << np.array([24, 16, 8, 0]))
    # A year 0 whose seconds are those of a time after 2001 is no year.
    counted = (date[:, 0] == 0) & (date[:, 1] == 0) & (whole >= 10**9)
    return np.where(counted, whole, calendar).astype(np.float64)
