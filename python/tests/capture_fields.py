"""The fields of captures: lengths of records, blocks, packets and datagrams, and numbers at the beginning of payloads."""
from __future__ import annotations

import struct
from collections.abc import Iterator

from format_fields import Field, get, lies_in

_SHOWN = 3  #: Records of which all fields lie.
_PAYLOAD = (*((at, 1) for at in range(40)), *((at, 2) for at in range(0, 40, 2)), *((at, 4) for at in range(0, 32, 4)))


def frame(data: bytes, at: int, end: int) -> Iterator[Field]:
    """Of a frame of Ethernet or cooked Linux: the kind of its content, and all that tells a length within."""
    kinds = (b"\x08\x00", b"\x86\xdd", b"\x81\x00", b"\x88\xa8")
    place = next((k for k in (at + 12, at, at + 14) if data[k:k + 2] in kinds), None)
    if place is None:
        return
    start = place + 2 if place != at else at + 20
    yield place, 2, True
    while data[place:place + 2] in kinds[2:]:
        place, start = start + 2, start + 4
        yield place, 2, True
    if data[start] >> 4 == 4:
        yield from ((start, 1, True), (start + 2, 2, True), (start + 4, 2, True), (start + 6, 2, True), (start + 9, 1, True))
        inner = start + 20
    else:
        yield from ((start, 1, True), (start + 4, 2, True), (start + 6, 1, True))
        inner = start + 40
        if data[start + 6] == 44:
            yield from ((inner, 1, True), (inner + 2, 2, True), (inner + 4, 4, True))
            inner += 8
    yield from ((inner + 2, 2, True), (inner + 4, 2, True))
    yield from ((inner + 8 + place, width, False) for place, width in _PAYLOAD if inner + 8 + place + width <= end)


def pcap(data: bytes) -> Iterator[Field]:
    """The header of a classic capture, and its records."""
    big = data[:4] in (b"\xa1\xb2\xc3\xd4", b"\xa1\xb2\x3c\x4d")
    yield from ((at, width, big) for at, width in ((0, 4), (4, 2), (6, 2), (8, 4), (12, 4), (16, 4), (20, 4)))
    at, number = 24, 0
    while at + 16 <= len(data):
        stored = get(data, (at + 8, 4, big))
        if number < _SHOWN or at + 16 + stored >= len(data):
            yield from ((at + k, 4, big) for k in (0, 4, 8, 12))
            yield from frame(data, at + 16, at + 16 + stored)
        at, number = at + 16 + stored, number + 1


def pcapng(data: bytes) -> Iterator[Field]:
    """The blocks: their kinds and lengths at both ends, and the fields of interfaces and packets."""
    big = data[8:12] == b"\x1a\x2b\x3c\x4d"
    at, packets = 0, 0
    while at + 12 <= len(data):
        kind, size = get(data, (at, 4, big)), get(data, (at + 4, 4, big))
        is_packet = kind in (2, 3, 6)
        packets += is_packet
        if not is_packet or packets <= _SHOWN:
            yield from ((at, 4, big), (at + 4, 4, big), (at + size - 4, 4, big))
        if kind == 1:
            yield from ((at + place, width, big) for place, width in ((8, 2), (12, 4), (16, 2), (18, 2), (20, 1), (24, 2), (26, 2)))
        elif kind == 0x0A0D0D0A:
            yield from ((at + place, width, big) for place, width in ((8, 4), (12, 2), (14, 2), (16, 8)))
        elif kind == 6 and packets <= _SHOWN:
            yield from ((at + place, 4, big) for place in (8, 12, 16, 20, 24))
            yield from frame(data, at + 28, at + size - 4)
        at += size


def lies(data: bytes) -> list[bytes]:
    """The capture with each false number in each field, in its lengths and in those of the packets."""
    fields = pcapng(data) if data[:4] == b"\x0a\x0d\x0d\x0a" else pcap(data)
    out = [bytes(lie) for lie in lies_in(data, fields)]
    return [*out, *overlapping(data)]


def overlapping(data: bytes) -> Iterator[bytes]:
    """A capture whose records stand in each other, and one with a damaged record behind each sound one."""
    if data[:4] != b"\xd4\xc3\xb2\xa1":
        return
    head, record = data[:24], data[24:40 + get(data, (32, 4, False))]
    yield head + record + b"".join(record[:k] + record for k in range(1, 40))
    seconds = record[:4]
    yield head + (record[:40] + struct.pack("<4s3I", seconds, 0, 1 << 30, 1 << 30)) * 200
