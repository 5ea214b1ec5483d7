"""Checks a LAS or LAZ file before a library reads it: every count in it must fit the file.

laspy and lazrs do not check the counts of a file. If a count is damaged, they allocate as much memory as it states, or
read billions of records that are not there, and lazrs then ends the whole process.
"""
from __future__ import annotations

import dataclasses
import struct
from typing import Any, BinaryIO

import numpy as np

from ..errors import FormatError
from ._files import PathLike, guarded, need

_LAYERS = {10: 9, 11: 1, 12: 2, 13: 1}  # Layers of a LAZ item by its type; of type 14 one a byte.
_LARGEST_CHUNK = 64 << 20  # bytes of points; lazrs keeps whole chunks only where it works in parallel.


@dataclasses.dataclass(frozen=True)
class LasFacts:
    """Facts from the header of a checked file."""

    points: int
    compressed: bool
    parallel: bool  #: Whether the chunks of a LAZ file are small enough to be decoded in parallel.
    crs_record: bytes  #: The WKT of an extended record; empty where there is none.


def check_las(path: PathLike, file: BinaryIO, size: int) -> LasFacts:
    """Checks the header, the lengths of records and the chunk table. Raises `FormatError`."""
    def fail(place: str, reason: str) -> FormatError:
        return FormatError(path, place, reason)

    file.seek(0)
    head = file.read(375)
    if len(head) < 227:
        raise fail("header", "truncated")
    minor, header_size, offset, records = head[25], *struct.unpack_from("<HII", head, 94)
    point_format, point_size, points = head[104], *struct.unpack_from("<HI", head, 105)
    if header_size > offset or offset > size:
        raise fail("header", f"points begin at byte {offset} of {size}: truncated")
    if records * 54 > offset - header_size:
        raise fail("header", f"{records} records do not fit before the points")
    evlr_at = evlrs = 0
    if minor >= 4 and len(head) == 375:
        evlr_at, evlrs, points = struct.unpack_from("<QIQ", head, 235)
    if point_size < 20:
        raise fail("header", f"points of {point_size} bytes")
    crs = _extended_crs(file, evlr_at, evlrs, size, fail)
    if not point_format & 0xC0:
        if points * point_size > size - offset:
            raise fail(f"byte {size}", f"states {points} points, has {(size - offset) // point_size}: truncated")
        return LasFacts(points, False, False, crs)
    file.seek(header_size)
    vlr = _laz_record(file, records, offset)
    if vlr is None:
        raise fail("header", "no record with the compression of the points")
    if points == 0:
        return LasFacts(0, True, False, crs)
    parallel = _check_chunks(path, file, size, offset, point_size, points, vlr)
    return LasFacts(points, True, parallel, crs)


def _extended_crs(file: BinaryIO, at: int, count: int, size: int, fail: Any) -> bytes:
    """The WKT of an extended record. Others, waveforms among them, are skipped."""
    if count and (at > size or count * 60 > size - at):
        raise fail("header", f"{count} extended records do not fit the file")
    for _ in range(count):
        file.seek(at)
        head = file.read(60)
        if len(head) < 60:
            raise fail(f"byte {at}", "an extended record is truncated")
        number, length = struct.unpack_from("<HQ", head, 18)
        if length > size - at - 60:
            raise fail(f"byte {at}", f"an extended record of {length} bytes does not fit the file")
        if head[2:18].rstrip(b"\0") == b"LASF_Projection" and number == 2112 and length < 1 << 20:
            return file.read(length).rstrip(b"\0")
        at += 60 + length
    return b""


def _laz_record(file: BinaryIO, records: int, end: int) -> bytes | None:
    for _ in range(records):
        head = file.read(54)
        if len(head) < 54 or file.tell() > end:
            return None
        number, length = struct.unpack_from("<HH", head, 18)
        data = file.read(length)
        if head[2:18].rstrip(b"\0") == b"laszip encoded" and number == 22204 and len(data) >= 34:
            return data
    return None


def _check_chunks(path: PathLike, file: BinaryIO, size: int, offset: int, point_size: int, points: int,
                  vlr: bytes) -> bool:
    """Checks the chunk table; returns whether the chunks may be decoded in parallel."""
    compressor, = struct.unpack_from("<H", vlr, 0)
    chunk_points, = struct.unpack_from("<I", vlr, 12)
    count, = struct.unpack_from("<H", vlr, 32)
    if len(vlr) < 34 + 6 * count:
        raise FormatError(path, "LAZ record", "truncated")
    items = np.frombuffer(vlr, "<u2", 3 * count, 34).reshape(-1, 3)
    if int(items[:, 1].sum(dtype=np.int64)) != point_size:
        raise FormatError(path, "LAZ record", f"items of {items[:, 1].sum()} bytes, points of {point_size}")
    if compressor == 1:  # One stream of points without chunks.
        return False
    file.seek(offset)
    table = int.from_bytes(file.read(8), "little", signed=True)
    if table <= offset:
        file.seek(size - 8)
        table = int.from_bytes(file.read(8), "little", signed=True)
    if not offset < table <= size - 8:
        raise FormatError(path, "chunk table", f"lies at byte {table} of {size}: truncated")
    file.seek(table + 4)
    chunks = int.from_bytes(file.read(4), "little")
    if chunks * point_size > size:
        raise FormatError(path, "chunk table", f"{chunks} chunks do not fit {size} bytes")
    file.seek(offset)
    lazrs = need("lazrs")
    with guarded(path, "chunk table"):
        entries = np.array(lazrs.read_chunk_table(file, lazrs.LazVlr(vlr)), np.float64).reshape(-1, 2)
    if entries[:, 1].sum() > size - offset or entries.min(initial=0) < 0:
        raise FormatError(path, "chunk table", "the chunks are longer than the file")
    held = entries[:, 0].sum()
    if held < points or (chunk_points != 0xFFFFFFFF and held - points >= max(1, chunk_points)):
        raise FormatError(path, "chunk table", f"{points} points in {len(entries)} chunks of {chunk_points}")
    if entries[:, 0].max(initial=0) > 0xFFFFFFFF or (chunk_points == 0xFFFFFFFF and held > points):
        raise FormatError(path, "chunk table", f"{held:.0f} points in the chunks, {points} in the header")
    layers = sum(_LAYERS.get(int(kind), int(width) if kind == 14 else 0) for kind, width, _ in items)
    if layers:
        _check_layers(path, file, offset + 8, entries[:, 1], point_size, layers)
    return bool(entries[:, 0].max(initial=0) * point_size <= _LARGEST_CHUNK)


def _check_layers(path: PathLike, file: BinaryIO, at: int, lengths: Any, point_size: int, layers: int) -> None:
    head = point_size + 4 + 4 * layers
    for number, length in enumerate(lengths):
        if length == 0:
            continue
        file.seek(at)
        data = file.read(head)
        if len(data) < head or head + int(np.frombuffer(data, "<u4", layers, point_size + 4).sum()) > length:
            raise FormatError(path, f"chunk {number}", "its layers are longer than the chunk")
        at += int(length)
