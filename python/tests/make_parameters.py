#!/usr/bin/env python3
"""Writes underbrush/_parameters.py, the types of the parameters of `fit`, from the table of the library.

Run it with the package on the path after the table has changed; `--check` only compares."""
import argparse
import pathlib
import sys
import textwrap

from underbrush import _core

FILE = pathlib.Path(__file__).resolve().parents[1] / "underbrush" / "_parameters.py"
HEAD = '''"""The parameters of a fit; python/tests/make_parameters.py writes this file."""
from __future__ import annotations

from typing import TypedDict


class FitParameters(TypedDict, total=False):
    """Parameters of `fit`, as docs/reference/parameters.md lists them."""

'''


def text() -> str:
    """Returns the text of the file."""
    lines = []
    for name, kind, default, unit, words in _core.fit_parameters():
        tail = f"{unit}; default {default}" if unit else f"default {default}"
        comment = f"#: {words} ({tail})."
        line = f"    {name.replace('-', '_')}: {kind}  {comment}"
        if len(line) > 120:
            wrapped = textwrap.wrap(comment, 116, initial_indent="    ", subsequent_indent="    #: ")
            line = "\n".join(wrapped) + f"\n    {name.replace('-', '_')}: {kind}"
        lines.append(line)
    return HEAD + "\n".join(lines) + "\n"


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--check", action="store_true")
    if not parser.parse_args().check:
        FILE.write_text(text(), encoding="utf-8")
    elif FILE.read_text(encoding="utf-8") != text():
        sys.exit(f"{FILE} is not what the table of parameters says: run {sys.argv[0]}")
