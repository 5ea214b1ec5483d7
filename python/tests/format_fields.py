"""The fields in which a recording says something of its own structure: lengths, counts, offsets and codes."""
from __future__ import annotations

import re
import struct
from collections.abc import Iterable, Iterator

#: A place, its number of bytes, and whether the highest byte comes first.
Field = tuple[int, int, bool]


def get(data: bytes, field: Field) -> int:
    at, width, big = field
    return int.from_bytes(data[at:at + width], "big" if big else "little")


def put(data: bytes, field: Field, value: int) -> bytes:
    at, width, big = field
    return data[:at] + (value % (1 << 8 * width)).to_bytes(width, "big" if big else "little") + data[at + width:]


def little(*places: tuple[int, int]) -> Iterator[Field]:
    for at, width in places:
        yield at, width, False


def las(data: bytes) -> Iterator[Field]:
    """Header, variable-length records, laszip's record and the table of chunks."""
    yield from little((6, 2), (24, 1), (25, 1), (94, 2), (96, 4), (100, 4), (104, 1), (105, 2), (107, 4), (111, 4))
    header = get(data, (94, 2, False))
    if header >= 375:
        yield from little((227, 8), (235, 8), (243, 4), (247, 8), (255, 8), (263, 8))
    at = header
    for _ in range(get(data, (100, 4, False))):
        length = get(data, (at + 20, 2, False))
        yield from little((at + 18, 2), (at + 20, 2))
        if data[at + 2:at + 16] == b"laszip encoded":
            body = at + 54
            yield from little((body, 2), (body + 2, 2), (body + 8, 4), (body + 12, 4), (body + 16, 8), (body + 24, 8),
                              (body + 32, 2))
            yield from little(*((body + 34 + 6 * k + j, 2) for k in range(get(data, (body + 32, 2, False)))
                                for j in (0, 2, 4)))
        at += 54 + length
    points = get(data, (96, 4, False))
    if b"laszip encoded" in data[:points]:
        yield points, 8, False
        table = get(data, (points, 8, False))
        yield from little((table, 4), (table + 4, 4), (table + 8, 4))


def e57(data: bytes) -> Iterator[Field]:
    """The header of the file and those of the first section and its first packet."""
    yield from little((8, 4), (12, 4), (16, 8), (24, 8), (32, 8), (40, 8))
    found = re.search(rb'fileOffset="(\d+)"', data)
    section = int(found.group(1)) if found else 48
    yield from little((section, 1), (section + 8, 8), (section + 16, 8), (section + 24, 8))
    packet = get(data, (section + 16, 8, False))
    yield from little((packet, 1), (packet + 1, 1), (packet + 2, 2), (packet + 4, 2), (packet + 6, 2), (packet + 8, 2))


def mcap(data: bytes) -> Iterator[Field]:
    """The length of each record, and the numbers at its beginning."""
    at = 8
    while at + 9 <= len(data) - 8:
        length = get(data, (at + 1, 8, False))
        yield from little((at, 1), (at + 1, 8))
        words = {6: [(0, 8), (8, 8), (16, 8), (24, 4), (28, 4), (36, 8)], 2: [(0, 8), (8, 8), (16, 4)],
                 8: [(0, 8), (8, 8), (16, 8), (24, 8), (32, 4)], 5: [(0, 2), (2, 4), (6, 8), (14, 8)],
                 7: [(0, 2), (2, 4)], 11: [(0, 8), (8, 2), (10, 4)], 14: [(0, 1), (1, 8), (9, 8)]}
        yield from little(*((at + 9 + place, width) for place, width in words.get(data[at], [(0, 4), (2, 4)])
                            if place + width <= length))
        at += 9 + length


def ros1(data: bytes) -> Iterator[Field]:
    """The lengths of each record's header, of its fields and of its data, and numbers in the header."""
    at = data.index(b"\n") + 1
    while at + 8 <= len(data):
        header = get(data, (at, 4, False))
        yield at, 4, False
        place = at + 4
        while place < at + 4 + header:
            length = get(data, (place, 4, False))
            yield place, 4, False
            name, _, value = data[place + 4:place + 4 + length].partition(b"=")
            if len(value) in (1, 4, 8):
                yield place + 5 + len(name), len(value), False
            place += 4 + length
        body = at + 4 + header
        yield body, 4, False
        at = body + 4 + get(data, (body, 4, False))


def sqlite3(data: bytes) -> Iterator[Field]:
    """The header of the file and that of its first page."""
    for at, width in ((16, 2), (18, 1), (19, 1), (20, 1), (24, 4), (28, 4), (32, 4), (36, 4), (44, 4), (52, 4), (56, 4),
                      (100, 1), (101, 2), (103, 2), (105, 2), (107, 1), (108, 2), (110, 2)):
        yield at, width, True


def zip_archive(data: bytes) -> Iterator[Field]:
    """Local headers, the directory and its end."""
    widths = {b"PK\3\4": ((4, 2), (6, 2), (8, 2), (14, 4), (18, 4), (22, 4), (26, 2), (28, 2)),
              b"PK\1\2": ((8, 2), (10, 2), (16, 4), (20, 4), (24, 4), (28, 2), (30, 2), (32, 2), (42, 4)),
              b"PK\5\6": ((8, 2), (10, 2), (12, 4), (16, 4), (20, 2))}
    for sign, places in widths.items():
        at = data.find(sign)
        while at >= 0:
            yield from little(*((at + place, width) for place, width in places))
            at = data.find(sign, at + 4)


FIELDS = {"las": las, "laz": las, "old-laz": las, "e57": e57, "mcap": mcap, "mcap-zstd": mcap, "sqlite3": sqlite3,
          "ros1": ros1, "ros1-lz4": ros1, "npz": zip_archive}
_LIES = (0, 1, 2, 0x7F, 0xFF, 0x7FFF, 0xFFFF, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF, 1 << 40, (1 << 63) - 1, 1 << 63,
         (1 << 64) - 1)


def lies(kind: str, data: bytes) -> list[tuple[Field, int]]:
    """Each field of a file with each number that it could say falsely: limits of its width and what is near."""
    return _false(data, FIELDS[kind](data) if kind in FIELDS else ())


def _false(data: bytes, fields: Iterable[Field]) -> list[tuple[Field, int]]:
    out: list[tuple[Field, int]] = []
    for field in dict.fromkeys(fields):
        at, width, _ = field
        if at < 0 or at + width > len(data):
            continue
        true, most = get(data, field), 1 << 8 * width
        near = (true - 1, true + 1, true * 2, true // 2, true + 8, true * 1000)
        out.extend((field, value) for value in dict.fromkeys(v % most for v in (*_LIES, *near)) if value != true)
    return out


def lies_in(data: bytes, fields: Iterable[Field]) -> Iterator[bytes]:
    """The file with each of these numbers in each field."""
    yield from (put(data, field, value) for field, value in _false(data, fields))


def zeros_in_mcap(packed: bytes, compression: str, told: int) -> bytes:
    """An MCAP file of one chunk, which says that `packed` has `told` bytes."""
    def record(code: int, body: bytes) -> bytes:
        return struct.pack("<BQ", code, len(body)) + body

    def text(words: str) -> bytes:
        return struct.pack("<I", len(words)) + words.encode()

    chunk = struct.pack("<QQQI", 0, 1, told, 0) + text(compression) + struct.pack("<Q", len(packed)) + packed
    magic = b"\x89MCAP0\r\n"
    return (magic + record(1, text("ros2") + text("")) + record(6, chunk) + record(15, struct.pack("<I", 0)) +
            record(2, struct.pack("<QQI", 0, 0, 0)) + magic)


def bag_with_chunk(good: bytes, packed: bytes, compression: str, told: int) -> bytes:
    """A bag of ROS 1 whose only chunk is `packed`, which it says to have `told` bytes."""
    at = good.index(b"\n") + 1
    out, grown = good[:at], 0
    index: int | None = None
    while at < len(good):
        header = get(good, (at, 4, False))
        fields = {}
        place = at + 4
        while place < at + 4 + header:
            length = get(good, (place, 4, False))
            name, _, value = good[place + 4:place + 4 + length].partition(b"=")
            fields[name] = value
            place += 4 + length
        size = get(good, (place, 4, False))
        end, body = place + 4 + size, good[place + 4:place + 4 + size]
        if fields[b"op"] == b"\3":
            index = out.__len__() + good[at:end].index(b"index_pos=") + 10
        if fields[b"op"] == b"\5":
            assert grown == 0, "several chunks"
            fields |= {b"compression": compression.encode(), b"size": struct.pack("<I", told)}
            body = packed
        parts = [name + b"=" + value for name, value in fields.items()]
        head = b"".join(struct.pack("<I", len(part)) + part for part in parts)
        record = struct.pack("<I", len(head)) + head + struct.pack("<I", len(body)) + body
        grown += len(record) - (end - at)
        out += record
        at = end
    assert index is not None
    return put(out, (index, 8, False), get(out, (index, 8, False)) + grown)
