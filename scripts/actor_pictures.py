#!/usr/bin/env python3
"""Draws the range images of the beams that meet an actor in one scan, one log below the other: the real log, and
simulated ones of the same beams. Colours are ranges, from blue (near) to yellow (far); misses are grey."""
import argparse
import struct
import zlib

import numpy

import ply_columns

PIXELS = 6  # for a beam


def colours(share):
    """Colours of shares from 0 to 1, between blue, green and yellow."""
    stops = numpy.array([[68, 1, 120], [33, 145, 140], [253, 231, 37]], float)
    at = numpy.clip(share, 0, 1)[:, None] * 2
    low = numpy.minimum(at.astype(int), 1)[:, 0]
    return stops[low] + (at - low[:, None]) * (stops[low + 1] - stops[low])


def write_png(path, picture):
    """Writes a picture, (rows, columns, 3) bytes."""
    rows, width, _ = picture.shape
    raw = b"".join(b"\0" + picture[k].tobytes() for k in range(rows))

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    head = struct.pack(">IIBBBBB", width, rows, 8, 2, 0, 0, 0)
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(raw)) + chunk(b"IEND", b""))


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("logs", nargs="+", help="the real log first; all have the same beams")
    parser.add_argument("--scan", type=int, help="number of the scan; the one with most of the beams by default")
    parser.add_argument("-o", "--output", required=True, help="the picture (PNG)")
    arguments = parser.parse_args()
    tables = [ply_columns.read(path) for path in arguments.logs]
    real, real_m = tables[0]
    scans, counts = numpy.unique(real["scan"], return_counts=True)
    scan = scans[counts.argmax()] if arguments.scan is None else arguments.scan
    chosen = real["scan"] == scan
    rings = real["ring"][chosen].astype(int)
    packets = numpy.unique(real["packet"][chosen])
    column = numpy.searchsorted(packets, real["packet"][chosen])
    row = rings - rings.min()
    near, far = numpy.nanpercentile(real_m[chosen], [2, 98])
    panels = []
    for table, ranges in tables:
        assert len(table) == len(real), "the logs have other beams"
        picture = numpy.full((row.max() + 1, len(packets), 3), 255.0)
        seen = ranges[chosen]
        shade = numpy.where(numpy.isfinite(seen)[:, None], colours((numpy.nan_to_num(seen) - near) / (far - near)), 128.0)
        picture[row, column] = shade
        panels += [picture, numpy.full((2, len(packets), 3), 255.0)]
    whole = numpy.concatenate(panels[:-1]).astype(numpy.uint8)
    write_png(arguments.output, numpy.ascontiguousarray(whole.repeat(PIXELS, 0).repeat(PIXELS, 1)))


if __name__ == "__main__":
    main()
