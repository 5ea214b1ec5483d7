#!/usr/bin/env python3
"""Writes underbrush/_parameters.py, the types of the options of verbs, from the tables of the library.

Run it with the package on the path after the table has changed; `--check` only compares."""
import argparse
import pathlib
import sys
import textwrap

from underbrush import _core

FILE = pathlib.Path(__file__).resolve().parents[1] / "underbrush" / "_parameters.py"
NAMED_ARGUMENTS = ("class-density", "float")  # of the functions of Python, in another form
BASES = {"optimize": "FitParameters"}  # The parameters that stay fixed.
HEAD = '''"""The options of verbs; python/tests/make_parameters.py writes this file."""
from __future__ import annotations

import os
from collections.abc import Sequence
from typing import TypedDict
'''
CLASS = '''

class {name}({base}, total=False):
    """Options of `{verb}`, as docs/reference/{page} lists them."""

'''


def fields(table: list[tuple[str, str, str, str, str]]) -> str:
    """Returns the fields of a class, one a row of the table."""
    lines = []
    for name, kind, default, unit, words in table:
        tail = "; ".join(part for part in (unit, f"default {default}" if default else "") if part)
        comment = f"#: {words} ({tail})." if tail else f"#: {words}."
        line = f"    {name.replace('-', '_')}: {kind}  {comment}"
        if len(line) > 120:
            wrapped = textwrap.wrap(comment, 116, initial_indent="    ", subsequent_indent="    #: ")
            line = "\n".join(wrapped) + f"\n    {name.replace('-', '_')}: {kind}"
        lines.append(line)
    return "\n".join(lines) + "\n"


def text() -> str:
    """Returns the text of the file."""
    tables = {"FitParameters": ("fit", "parameters.md", _core.fit_parameters() + _core.fit_log_options())}
    for verb in ("simulate", "score", "optimize", "import", "split", "segment", "movers", "actors", "extract", "compose",
                 "perceive"):
        rows = getattr(_core, verb + "_options")()
        tables[verb.capitalize() + "Parameters"] = (
            verb, "command-line.md", [row for row in rows if row[0] not in NAMED_ARGUMENTS])
    return HEAD + "".join(CLASS.format(name=name, verb=verb, page=page, base=BASES.get(verb, "TypedDict")) + fields(table)
                          for name, (verb, page, table) in tables.items())


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--check", action="store_true")
    if not parser.parse_args().check:
        FILE.write_text(text(), encoding="utf-8")
    elif FILE.read_text(encoding="utf-8") != text():
        sys.exit(f"{FILE} is not what the table of parameters says: run {sys.argv[0]}")
