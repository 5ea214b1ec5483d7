#!/usr/bin/env python3
"""Makes share/examples/marv_forest.pcd from the scan as it was published.

    scripts/make_example.py 1727353472_601360559.npz share/examples/marv_forest.pcd

The output holds the same points in the same order, as PCD binary_compressed with 128 rows of 1024 columns. The
fields `reflectivity` and `ambient` are left out, and the intensities, which are whole numbers, become 16 bits wide;
x, y, z and t keep their bits. The same input gives the same bytes. Needs nothing besides Python.
"""
import argparse
import ast
import pathlib
import struct
import zipfile

ROWS = 128
FIELDS = {"x": ("F", "<f"), "y": ("F", "<f"), "z": ("F", "<f"), "t": ("U", "<I"), "intensity": ("U", "<H")}
WINDOW, LONGEST, LITERALS = 8192, 264, 32  # bytes, as LZF can write them


def columns_of(path):
    """{name: values} of the structured array in a .npz file."""
    with zipfile.ZipFile(path) as archive:
        data = archive.read(archive.namelist()[0])
    if data[:8] != b"\x93NUMPY\x01\x00":
        raise SystemExit(f"{path}: expected a .npy array of version 1.0")
    begin = 10 + struct.unpack_from("<H", data, 8)[0]
    header = ast.literal_eval(data[10:begin].decode())
    codes = {"<f4": "f", "<u4": "I", "<u2": "H"}
    record = struct.Struct("<" + "".join(codes[kind] for _, kind in header["descr"]))
    rows = list(record.iter_unpack(data[begin:begin + record.size * header["shape"][0]]))
    return {name: values for (name, _), values in zip(header["descr"], zip(*rows))}


def body_of(columns):
    """All values of a field together, one field after the other."""
    parts = []
    for name, (_, code) in FIELDS.items():
        values = columns[name]
        if name == "intensity":
            if any(v != int(v) or not 0 <= v < 1 << 16 for v in values):
                raise SystemExit("an intensity is not a whole number of 16 bits")
            values = [int(v) for v in values]
        parts.append(struct.pack(f"<{len(values)}{code[-1]}", *values))
    return b"".join(parts)


def compressed(data):
    """`data` as LZF, the compression of PCD files: runs of literals and references to the last 8 KiB."""
    out, literals, last = bytearray(), bytearray(), {}

    def flush():
        for begin in range(0, len(literals), LITERALS):
            run = literals[begin:begin + LITERALS]
            out.append(len(run) - 1)
            out.extend(run)
        literals.clear()

    at = 0
    while at < len(data):
        key = data[at:at + 3]
        found = last.get(key, -1) if len(key) == 3 else -1
        last[key] = at
        if found < 0 or at - found > WINDOW:
            literals.append(data[at])
            at += 1
            continue
        length = 3
        while length < LONGEST and at + length < len(data) and data[found + length] == data[at + length]:
            length += 1
        flush()
        offset = at - found - 1
        out.append(min(length - 2, 7) << 5 | offset >> 8)
        if length >= 9:
            out.append(length - 9)
        out.append(offset & 255)
        for k in range(at + 1, at + length):
            last[data[k:k + 3]] = k
        at += length
    flush()
    return bytes(out)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("source", type=pathlib.Path)
    parser.add_argument("output", type=pathlib.Path)
    args = parser.parse_args()
    columns = columns_of(args.source)
    points = len(columns["x"])
    body = body_of(columns)
    packed = compressed(body)
    words = {"VERSION": "0.7", "FIELDS": " ".join(FIELDS),
             "SIZE": " ".join(str(struct.calcsize(code)) for _, code in FIELDS.values()),
             "TYPE": " ".join(kind for kind, _ in FIELDS.values()), "COUNT": " ".join("1" for _ in FIELDS),
             "WIDTH": points // ROWS, "HEIGHT": ROWS, "VIEWPOINT": "0 0 0 1 0 0 0", "POINTS": points,
             "DATA": "binary_compressed"}
    head = "# One scan of an Ouster OS0-128, ROUGH data set, CTU in Prague, BSD-3-Clause: see README.md\n"
    head += "".join(f"{key} {value}\n" for key, value in words.items())
    args.output.write_bytes(head.encode() + struct.pack("<II", len(packed), len(body)) + packed)
    print(f"{args.output}: {points} points, {args.output.stat().st_size} bytes")


main()
