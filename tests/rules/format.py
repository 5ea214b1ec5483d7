#!/usr/bin/env python3
"""Checks that all C++ is formatted as .clang-format says. --fix formats it."""
import shutil
import subprocess

import rules

CLANG_FORMAT = shutil.which("clang-format-14") or "clang-format"  # versions format differently
BATCHES = 8  # To start a process takes longer than to read a file.


def arguments(parser):
    parser.add_argument("--fix", action="store_true")


def check(root, options):
    files = rules.tracked(root, ".hpp", ".cpp", ".inl")
    style = f"--style=file:{rules.ROOT / '.clang-format'}"
    paths = [str(root / f) for f in files]
    if options.fix and root == options.root:
        subprocess.run([CLANG_FORMAT, style, "-i"] + paths, check=True)
    batches = [paths[k::BATCHES] for k in range(BATCHES)]
    failed = rules.run_in_parallel(
        [(k, [CLANG_FORMAT, style, "--dry-run", "-Werror", *batch]) for k, batch in enumerate(batches) if batch])
    first = {}  # The first complaint about each file.
    for _, out in failed:
        for line in out.splitlines():
            path = line.partition(":")[0]
            if path in paths:
                first.setdefault(path, line)
    if failed and not first:
        return [out for _, out in failed]
    return [f"{f}: not formatted (tests/rules/format.py --fix)\n{first[p]}" for f, p in zip(files, paths) if p in first]


BAD = [({"src/a.cpp": "int f( ) {return 1;}\n"}, "not formatted")]
GOOD = {"src/a.cpp": "int f() { return 1; }\n"}

if __name__ == "__main__":
    rules.main(check, BAD, GOOD, arguments)
