#!/usr/bin/env python3
"""What became of the beams whose signal an instrument finds too weak: the log TEST, the answers THIN of thin rays to
its beams and those of the instrument, one row a beam. Prints JSON: `beams` that thin rays answer and the instrument
does not, the share `misses` of them that are misses of the log, and `expected`, that of all beams that thin rays
answer at the same ranges (in bands of 10 m)."""
import argparse
import json

import numpy

TYPES = {"double": "<f8", "float": "<f4", "uchar": "u1", "char": "i1", "ushort": "<u2", "short": "<i2", "uint": "<u4",
         "int": "<i4"}
BAND_M = 10


def ranges(path):
    """The range of each beam of a log, m; NaN without a return."""
    with open(path, "rb") as file:
        head, _, body = file.read().partition(b"end_header\n")
    lines = [line.split() for line in head.decode().splitlines()]
    rows = next(int(words[2]) for words in lines if words[:2] == ["element", "vertex"])
    columns = numpy.dtype([(words[2], TYPES[words[1]]) for words in lines if words[:1] == ["property"]])
    table = numpy.frombuffer(body, columns, rows)
    length = numpy.sqrt(sum(table[axis].astype(float) ** 2 for axis in ("nx", "ny", "nz")))
    return numpy.where(table["alpha"] > 0, length, numpy.nan)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    for name in ("test", "thin", "instrument"):
        parser.add_argument(name)
    options = parser.parse_args()
    test, thin, instrument = (ranges(path) for path in (options.test, options.thin, options.instrument))
    answered, missed = ~numpy.isnan(thin), numpy.isnan(test)
    weak = answered & numpy.isnan(instrument)
    band = (numpy.where(answered, thin, 0) / BAND_M).astype(int)
    count = numpy.bincount(band[answered])
    of_band = numpy.bincount(band[answered], missed[answered]) / numpy.maximum(count, 1)
    print(json.dumps({"beams": int(weak.sum()), "misses": float(missed[weak].mean()) if weak.any() else None,
                      "expected": float(of_band[band[weak]].mean()) if weak.any() else None}))


if __name__ == "__main__":
    main()
