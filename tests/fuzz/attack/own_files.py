"""Lies in the program's own binary files. Their checksums fit, so that the lies reach the readers."""
import ctypes
import ctypes.util
import json
import re
import struct
import zlib

import fields
from fields import get, put

SCALARS = {"char": "b", "uchar": "B", "short": "h", "ushort": "H", "int": "i", "uint": "I", "float": "f", "double": "d",
           "int8": "b", "uint8": "B", "int16": "h", "uint16": "H", "int32": "i", "uint32": "I", "float32": "f", "float64": "d"}
NUMBERS = (float("nan"), float("inf"), -float("inf"), -1.0, 0.0, 1e-30, 1e30, 3.4e38)


# PLY

def ply_places(data):
    """(place, type) of each number of the first, the middle and the last row of each element of a binary PLY file."""
    head = data[:data.index(b"end_header\n") + 11]
    at, order = len(head), ">" if b"big_endian" in head else "<"
    for count, body in re.findall(rb"element \w+ (\d+)\n((?:property .*\n|comment .*\n)*)", head):
        properties = [line.split()[1:-1] for line in body.decode().splitlines() if line.startswith("property")]
        shown = {0, int(count) // 2, int(count) - 1}
        for row in range(int(count)):
            for words in properties:
                types = [words[1]] if words[0] == "list" else [words[0]]
                if words[0] == "list":
                    types += [words[2]] * struct.unpack_from(order + SCALARS[words[1]], data, at)[0]
                for one in types:
                    if row in shown:
                        yield at, order + SCALARS[one]
                    at += struct.calcsize(SCALARS[one])


def ply_lies(data):
    """Of the rows: counts and numbers in lists, numbers of other things, and values beyond all bounds."""
    for at, form in ply_places(data):
        if form[1] in "fd":
            double = form[1] == "d"
            for value in (*NUMBERS, *((1e300, 2.0**53) if double else ())):
                yield data[:at] + struct.pack(form, value) + data[at + struct.calcsize(form):]
        else:
            yield from fields.binary_lies(data, [(at, struct.calcsize(form))], big=form[0] == ">")


# Compact logs

def library(name):
    return ctypes.CDLL(ctypes.util.find_library(name))


def xxh3(data):
    hashed = library("xxhash").XXH3_64bits
    hashed.restype, hashed.argtypes = ctypes.c_uint64, (ctypes.c_char_p, ctypes.c_size_t)
    return hashed(data, len(data))


def zstd(data):
    out = ctypes.create_string_buffer(len(data) + 1000)
    pack = library("zstd").ZSTD_compress
    pack.restype, pack.argtypes = ctypes.c_size_t, (ctypes.c_char_p, ctypes.c_size_t, ctypes.c_char_p, ctypes.c_size_t, ctypes.c_int)
    size = pack(out, len(out), data, len(data), 1)
    return out.raw[:size]


def unzstd(data, size):
    out = ctypes.create_string_buffer(size)
    unpack = library("zstd").ZSTD_decompress
    unpack.argtypes = (ctypes.c_char_p, ctypes.c_size_t, ctypes.c_char_p, ctypes.c_size_t)
    unpack(out, size, data, len(data))
    return out.raw


def compact(chunks, index, told=None):
    """A compact log of chunks and an index, which says that the index has `told` bytes."""
    block = zstd(index)
    ends = struct.pack("<3Q", 8 + len(chunks), len(index) if told is None else told % (1 << 64), xxh3(block))
    return b"UBLOG\r\n\1" + chunks + block + ends + struct.pack("<Q", xxh3(ends)) + b"UBLOGEND"


def index_fields(index):
    """(place, width) of the counts, of the extra columns, and of the facts about the first and the last chunk; and where
    the facts of the first chunk begin."""
    at, found = 24, [(0, 8), (8, 4), (12, 4), (16, 4), (20, 4)]
    for _ in range(get(index, 20, 4)):
        found += [(at, 1), (at + 1, 2)]
        at += 3 + get(index, at + 1, 2)
    at += get(index, 16, 4)
    last = at + 136 * (get(index, 12, 4) - 1)
    return [*found, *((begin + 8 * k, 8) for begin in dict.fromkeys((at, last)) for k in range(17))], at


def skip_column(data, at, width, rows, found):
    """Adds the fields of a column of a chunk, and returns its end."""
    found.append((at, 1))
    planes, at = width, at + 1
    if data[at - 1] & 3 == 3:
        found += [(at, 2), (at + 2, width)]
        planes, at = 1, at + 2 + width * get(data, at, 2)
    for _ in range(planes):
        found.append((at, 1))
        kind, at = data[at], at + 1
        if kind == 2:
            found += [(at, 4), (at + 4, 4), (at + 8, 4)]  # A frame begins with a magic number and the sizes of its parts.
        at += (1, rows, 4 + get(data, at, 4) if kind == 2 else 0)[kind]
    return at


def chunk_fields(data, rows):
    """Of a chunk: the kinds of its columns, their tables and frames, the segments of the track, and the pattern."""
    found, at = [], 0
    for width in (2, 4, 4, 1, 8):
        at = skip_column(data, at, width, rows, found)
    segments = get(data, at, 2)
    found += [(at, 2), *((at + 2 + 8 * k, 8) for k in range(16 * min(1, segments)))]
    at += 2 + 128 * segments
    found.append((at, 1))
    at += 1
    for _ in range(3):
        at = skip_column(data, at, 8, rows, found)
    return [*found, *((at + k, 1) for k in range(4)), *((at + 2 + 8 * k, 8) for k in range(8))]


def compact_lies(data):
    """Of the end, the index and the first chunk."""
    end = len(data) - 40
    at, size = get(data, end, 8), get(data, end + 8, 8)
    chunks, index = data[8:at], unzstd(data[at:end], size)
    facts, first = index_fields(index)
    for value in (0, 1, size - 1, size + 1, 1 << 28, (1 << 28) + 1, 1 << 31, -1):
        yield compact(chunks, index, value)
    for lie in fields.binary_lies(data, [(end, 8)]):
        yield lie[:end + 24] + struct.pack("<Q", xxh3(lie[end:end + 24])) + lie[end + 32:]
    yield from (compact(chunks, lie) for lie in fields.binary_lies(index, facts))
    length = get(index, first, 8)
    chunk, rest = chunks[:length], chunks[length:]
    for lie in fields.binary_lies(chunk, chunk_fields(chunk, min(get(index, 0, 8), get(index, 8, 4)))):
        yield compact(lie + rest, put(index, first + 8, 8, xxh3(lie)))


# What `serve` keeps

def octree_lies(data):
    """Of the header, the nodes, the runs, the description, and the points of the root."""
    nodes, at, runs, run_count, described = (get(data, *field) for field in ((12, 4), (24, 8), (32, 8), (40, 8), (48, 8)))
    yield from fields.binary_lies(data, [(8, 4), (12, 4), *((k, 8) for k in range(16, 64, 8))])
    for row in dict.fromkeys((0, 1, nodes - 1)):
        begin = at + 24 * row
        yield from fields.binary_lies(data, [(begin, 8), (begin + 8, 4), (begin + 12, 4), (begin + 16, 1), (begin + 17, 1)])
    for row in dict.fromkeys((0, run_count - 1)):
        begin = runs + 32 * row
        yield from fields.binary_lies(data, [(begin, 8), (begin + 8, 8), (begin + 16, 4), (begin + 20, 4), (begin + 24, 8)])
    for lie in fields.json_lies(data[described:described + get(data, 56, 8)]):
        yield data[:48] + struct.pack("<QQ", len(data), len(lie)) + data[64:] + lie
    begin, points = get(data, at, 8), get(data, at + 8, 4)
    yield from fields.binary_lies(data, [(begin, 4), (begin + 12 * points, 4), (begin + 16 * points, 4),
                                         (begin + 20 * points, 4), (begin + 24 * points, 2), (begin + 26 * points, 2)])


def frames(journal):
    """The contents of a journal: its header and its records."""
    at, out = 8, []
    while at < len(journal):
        size = get(journal, at, 4)
        out.append(journal[at + 8:at + 8 + size])
        at += 8 + size
    return out


def journal(contents):
    return b"UBLABEL1" + b"".join(struct.pack("<II", len(c), zlib.crc32(c)) + c for c in contents)


def varints(change):
    """(place, width) of the numbers of a change: those of the lists in it too."""
    at, found = 0, []

    def number():
        nonlocal at
        begin, value = at, 0
        while True:
            value |= (change[at] & 127) << 7 * (at - begin)
            at += 1
            if change[at - 1] < 128:
                found.append((begin, at - begin))
                return value

    def numbers_until(end):
        while at < end:
            number()
    number()
    number()
    at += number()  # the name
    numbers_until(number() + at)
    for _ in range(number()):
        number()
        number()
        numbers_until(number() + at)
    return found


def record_lies(record):
    """Other records in the place of one."""
    kind, body = record[:1], record[1:]
    yield from (b"", b"?" + body, kind, record + b"\0", record[:-1])
    if kind in b"0c":
        for at, width in varints(body):
            for lie in (0, 1, 127, 1 << 16, (1 << 32) - 1, 1 << 32, 1 << 40, (1 << 63) - 1, (1 << 64) - 1):
                yield kind + body[:at] + fields.varint(lie) + body[at + width:]
    elif kind == b"b":
        yield from (kind + lie for lie in fields.json_lies(body))
    else:
        yield from (kind + lie for lie in (b"", b"0", b"-1", b"9", b"1e3", b"x", b"4294967296", b"18446744073709551616"))


def journal_lies(data):
    """Of the header, of each record, of the lengths, and records in another order."""
    contents = frames(data)
    header = json.loads(contents[0])
    yield from (journal([lie, *contents[1:]]) for lie in fields.json_lies(json.dumps(header).encode()))
    for k in range(1, len(contents)):
        yield from (journal([*contents[:k], lie, *contents[k + 1:]]) for lie in record_lies(contents[k]))
        yield journal([*contents[:k], *contents[k:][::-1]])
        yield journal([*contents[:k + 1], *[contents[k]] * 1000, *contents[k + 1:]])
    at = 8
    for content in contents:
        yield from fields.binary_lies(data, [(at, 4), (at + 4, 4)])
        at += 8 + len(content)


# Packed and other files of the program

def gzip_lies(data):
    """Of the header and the end; and parts that follow each other."""
    yield from fields.binary_lies(data, [(0, 2), (2, 1), (3, 1), (8, 1), (len(data) - 8, 4), (len(data) - 4, 4)])
    yield from (data + data, data + b"x", data[:-1], data[:len(data) // 2], data * 3, data[:18])


def words64(data):
    """A file of whole numbers of eight bytes behind one line."""
    begin = data.index(b"\n") + 1
    yield from fields.binary_lies(data, [(at, 8) for at in range(begin, min(len(data) - 7, begin + 160), 8)])
    yield from fields.binary_lies(data, [(at, 4) for at in range(begin, min(len(data) - 3, begin + 200), 4)])
    yield from (data[:size] for size in (0, begin - 1, begin, begin + 7, len(data) - 1))
