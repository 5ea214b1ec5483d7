"""Encodes and decodes OSI's messages as far as the tests need them, without a protobuf library."""
from __future__ import annotations

import struct


def varint(value: int) -> bytes:
    """A number of at most 64 bits."""
    out = bytearray()
    while value > 0x7F:
        out.append(value & 0x7F | 0x80)
        value >>= 7
    return bytes([*out, value])


def number(tag: int, value: int) -> bytes:
    """A whole number."""
    return varint(tag << 3) + varint(value)


def real(tag: int, value: float) -> bytes:
    """A double."""
    return varint(tag << 3 | 1) + struct.pack("<d", value)


def part(tag: int, *contents: bytes) -> bytes:
    """A message within a message."""
    body = b"".join(contents)
    return varint(tag << 3 | 2) + varint(len(body)) + body


def vector(tag: int, *values: float) -> bytes:
    """Up to three doubles."""
    return part(tag, *(real(k + 1, v) for k, v in enumerate(values)))


def stamp(tag: int, nanos: int) -> bytes:
    """A time in nanoseconds."""
    return part(tag, number(1, nanos // 10**9), number(2, nanos % 10**9))


def vehicle(tag: int, index: int, x: float, y: float, yaw: float, vx: float) -> bytes:
    """A car of 4.6 x 1.8 x 1.5 m that stands on z = 0."""
    base = part(2, vector(1, 4.6, 1.8, 1.5), vector(2, x, y, 0.75), vector(3, 0, 0, yaw), vector(4, vx, 0, 0))
    return part(tag, part(1, number(1, index)), base, number(3, 2), part(5, vector(4, -1.4, 0, -0.45)),
                part(6, number(1, 4)))


VERSION = part(1, number(1, 3), number(2, 8), number(3, 0))


def sensor_view(nanos: int, movers: list[bytes], host: int | None = 1, *more: bytes) -> bytes:
    """A SensorView with a ground truth of these moving objects."""
    truth = VERSION + stamp(2, nanos) + (part(3, number(1, host)) if host is not None else b"") + b"".join(movers)
    return VERSION + stamp(2, nanos) + part(3, number(1, 7)) + part(7, truth) + \
        (part(8, number(1, host)) if host is not None else b"") + b"".join(more)


def fields(data: bytes) -> list[tuple[int, int | float | bytes]]:
    """The fields of a message: tag, and a number, a double or bytes."""
    found: list[tuple[int, int | float | bytes]] = []
    at = 0

    def read() -> int:
        nonlocal at
        value = shift = 0
        while True:
            byte = data[at]
            at += 1
            value |= (byte & 0x7F) << shift
            shift += 7
            if byte < 0x80:
                return value

    while at < len(data):
        key = read()
        if key & 7 == 0:
            found.append((key >> 3, read()))
        elif key & 7 == 1:
            found.append((key >> 3, struct.unpack_from("<d", data, at)[0]))
            at += 8
        else:
            size = read()
            found.append((key >> 3, data[at:at + size]))
            at += size
    return found


def parts(data: bytes, *path: int) -> list[bytes]:
    """The messages at a path of tags."""
    found = [data]
    for tag in path:
        found = [v for message in found for t, v in fields(message) if t == tag and isinstance(v, bytes)]
    return found


def value(data: bytes, *path: int) -> int | float:
    """The first number at a path of tags."""
    for message in parts(data, *path[:-1]):
        for tag, found in fields(message):
            if tag == path[-1] and not isinstance(found, bytes):
                return found
    raise KeyError(path)


def frames(trace: bytes) -> list[bytes]:
    """The messages of a trace file."""
    found, at = [], 0
    while at < len(trace):
        size = struct.unpack_from("<I", trace, at)[0]
        found.append(trace[at + 4:at + 4 + size])
        at += 4 + size
    return found
