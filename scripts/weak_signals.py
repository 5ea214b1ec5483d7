#!/usr/bin/env python3
"""What became of the beams whose signal an instrument finds too weak: the log TEST, the answers THIN of thin rays to
its beams and those of the instrument, one row a beam. Prints JSON: `beams` that thin rays answer and the instrument
does not, the share `misses` of them that are misses of the log, and `expected`, that of all beams that thin rays
answer at the same ranges (in bands of 10 m)."""
import argparse
import json

import numpy

from ply_columns import read

BAND_M = 10


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    for name in ("test", "thin", "instrument"):
        parser.add_argument(name)
    options = parser.parse_args()
    test, thin, instrument = (read(path)[1] for path in (options.test, options.thin, options.instrument))
    answered, missed = ~numpy.isnan(thin), numpy.isnan(test)
    weak = answered & numpy.isnan(instrument)
    band = (numpy.where(answered, thin, 0) / BAND_M).astype(int)
    count = numpy.bincount(band[answered])
    of_band = numpy.bincount(band[answered], missed[answered]) / numpy.maximum(count, 1)
    print(json.dumps({"beams": int(weak.sum()), "misses": float(missed[weak].mean()) if weak.any() else None,
                      "expected": float(of_band[band[weak]].mean()) if weak.any() else None}))


if __name__ == "__main__":
    main()
