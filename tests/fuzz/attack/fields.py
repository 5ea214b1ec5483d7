"""The fields of a file: where its numbers stand, and the bytes of the file with another number there."""
import json
import re
import struct

#: What a field says falsely, besides numbers near the true one.
LIES = (0, 1, 2, 127, 255, 0x7FFF, 0xFFFF, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF, 1 << 40, (1 << 63) - 1, 1 << 63, (1 << 64) - 1)
TEXT_LIES = ("0", "1", "-1", "2147483647", "2147483648", "4294967295", "4294967296", "9223372036854775807",
             "18446744073709551615", "1e9", "1e308", "nan", "65536", "999999999")
SIZES = {1: "B", 2: "H", 4: "I", 8: "Q"}


def near(value):
    return (value - 1, value + 1, value * 2, value // 2, value + 8, value * 1000)


def put(data, at, width, value, big=False):
    """The bytes with a number at a place."""
    packed = struct.pack((">" if big else "<") + SIZES[width], value % (1 << 8 * width))
    return data[:at] + packed + data[at + width:]


def get(data, at, width, big=False):
    return struct.unpack_from((">" if big else "<") + SIZES[width], data, at)[0]


def binary_lies(data, fields, big=False):
    """The file with each lie in each field (at, width)."""
    for at, width in fields:
        if at < 0 or at + width > len(data):
            continue
        true = get(data, at, width, big)
        for value in dict.fromkeys(v % (1 << 8 * width) for v in (*LIES, *near(true))):
            if value != true:
                yield put(data, at, width, value, big)


def text_lies(data, most=200):
    """The file with each lie in the place of each number of a text, or of the header before binary data."""
    end = re.search(rb"end_header\r?\n|\nDATA [a-z_]+\r?\n|\0", data)
    head = data[:end.end()] if end else data
    for match in list(re.finditer(rb"(?<![\w.])-?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?", head))[:most]:
        for lie in TEXT_LIES:
            if match.group() != lie.encode():
                yield data[:match.start()] + lie.encode() + data[match.end():]


def json_lies(data, most=400):
    """The JSON document with other values in the place of each value."""
    document = json.loads(data)

    def places(value):
        for key, part in value.items() if isinstance(value, dict) else enumerate(value):
            yield value, key
            if isinstance(part, (dict, list)):
                yield from places(part)
    for holder, key in list(places(document))[:most]:
        true = holder[key]
        lies = (*LIES[-6:], -1, 1e308, "", [], {}, None) if not isinstance(true, (dict, list)) else ([], {}, 0, None)
        for lie in lies:
            holder[key] = lie
            yield json.dumps(document).encode()
        holder[key] = true


def zip_fields(data):
    """Of local headers, the directory and its end: versions, flags, method, sizes, counts and offsets."""
    local, central = ((6, 2), (8, 2), (14, 4), (18, 4), (22, 4), (26, 2), (28, 2)), \
        ((8, 2), (10, 2), (16, 4), (20, 4), (24, 4), (28, 2), (30, 2), (32, 2), (34, 2), (42, 4))
    for mark, of in ((b"PK\3\4", local), (b"PK\1\2", central), (b"PK\5\6", ((4, 2), (8, 2), (10, 2), (12, 4), (16, 4), (20, 2)))):
        for match in re.finditer(re.escape(mark), data):
            yield from ((match.start() + at, width) for at, width in of)


def tiff_fields(data):
    """Of the first directory: the number of entries, and of each its tag, type, count and value."""
    at = get(data, 4, 4)
    count = get(data, at, 2)
    yield from ((4, 4), (at, 2))
    for entry in range(at + 2, at + 2 + 12 * count, 12):
        yield from ((entry, 2), (entry + 2, 2), (entry + 4, 4), (entry + 8, 4))


def varint(value):
    out = bytearray()
    while value > 127:
        out.append(value & 127 | 128)
        value >>= 7
    return bytes(out + bytes([value]))


def message_fields(data, begin, end, depth=0):
    """Yields (place, bytes) of the lengths and numbers of a protobuf message and of the messages in it."""
    at = begin

    def number():
        nonlocal at
        value = shift = 0
        while True:
            byte = data[at]
            at, value, shift = at + 1, value | (byte & 127) << shift, shift + 7
            if byte < 128:
                return value
            if shift > 63 or at >= end:
                raise ValueError
    while at < end:
        key = number()
        start, wire = at, key & 7
        if wire == 0:
            number()
            yield start, at - start
        elif wire in (1, 5):
            at += 8 if wire == 1 else 4
        elif wire == 2:
            size = number()
            yield start, at - start
            if at + size > end:
                raise ValueError
            found = []
            try:
                found = list(message_fields(data, at, at + size, depth + 1)) if depth < 8 else []
            except (ValueError, IndexError):
                found = []  # a text or bytes
            yield from found
            at += size
        else:
            raise ValueError


def osi_lies(data, most=150):
    """The first message of a trace with lies in its length and in the lengths and numbers inside."""
    size = get(data, 0, 4)
    yield from binary_lies(data, [(0, 4)])
    places = list(message_fields(data, 4, 4 + size))
    for at, width in places[::max(1, len(places) // most)]:
        for lie in (0, 1, 127, 1 << 31, (1 << 32) - 1, (1 << 63), (1 << 64) - 1):
            changed = data[4:at] + varint(lie) + data[at + width:4 + size]
            yield struct.pack("<I", len(changed)) + changed + data[4 + size:]
    for endless in (b"\xff" * 11, b"\x0a" * 5000, b"\x0b" * 5000):  # a number without an end, messages without
        yield struct.pack("<I", len(endless)) + endless
