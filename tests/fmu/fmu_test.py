#!/usr/bin/env python3
"""Tests the FMUs through ctypes, without a co-simulation master: what they export, lifetimes, copies, states, and what
they do with inputs and calls that make no sense.

  fmu_test.py --fmu build/underbrush.fmu --fmi3 build/underbrush3.fmu [--data DATA] [--long]
"""
from __future__ import annotations

import argparse
import os
import pathlib
import sys
import unittest

from cases import ARGUMENTS


def load_tests(loader: unittest.TestLoader, _tests: object, _pattern: object) -> unittest.TestSuite:
    """The cases of all modules."""
    return loader.loadTestsFromNames(["replay_cases", "lifetime_cases", "chain_cases", "abuse_cases", "fmi3_cases",
                                      "archive_cases"])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--fmu", required=True)
    parser.add_argument("--fmi3", required=True)
    parser.add_argument("--data", default=os.environ.get("UNDERBRUSH_DATA") or
                        str(pathlib.Path(__file__).resolve().parents[3] / "shared/data"))
    parser.add_argument("--long", action="store_true", help="100 000 steps for the test of memory")
    rest = parser.parse_known_args(namespace=ARGUMENTS)[1]
    unittest.main(argv=[sys.argv[0], *rest])


if __name__ == "__main__":
    main()
