#!/usr/bin/env python3
"""Checks that all C++ is formatted as .clang-format says. --fix formats it."""
import shutil
import subprocess

import rules

CLANG_FORMAT = shutil.which("clang-format-14") or "clang-format"  # versions format differently


def arguments(parser):
    parser.add_argument("--fix", action="store_true")


def check(root, options):
    files = rules.tracked(root, ".hpp", ".cpp", ".inl")
    style = f"--style=file:{rules.ROOT / '.clang-format'}"
    paths = [str(root / f) for f in files]
    if options.fix and root == options.root:
        subprocess.run([CLANG_FORMAT, style, "-i"] + paths, check=True)
    failed = rules.run_in_parallel(
        [(f, [CLANG_FORMAT, style, "--dry-run", "-Werror", p]) for f, p in zip(files, paths)])
    return [f"{f}: not formatted (tests/rules/format.py --fix)\n" + "\n".join(out.splitlines()[:3])
            for f, out in failed]


BAD = [({"src/a.cpp": "int f( ) {return 1;}\n"}, "not formatted")]
GOOD = {"src/a.cpp": "int f() { return 1; }\n"}

if __name__ == "__main__":
    rules.main(check, BAD, GOOD, arguments)
