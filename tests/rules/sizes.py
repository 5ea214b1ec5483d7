#!/usr/bin/env python3
"""Checks the length of files: headers up to 200 lines, sources up to 400. Longer ones are listed, and the test
fails at 1.5 times these limits. The first page of results has at most 150 lines."""
import rules

RESULTS = "docs/results.md", 150
LIMITS = {".hpp": 200, ".inl": 400, ".cpp": 400, ".py": 400, ".ts": 400}


def check(root):
    out = []
    for path in rules.tracked(root, *LIMITS):
        limit = next(n for suffix, n in LIMITS.items() if path.endswith(suffix))
        lines = rules.read(root, path).count("\n")
        if lines > 1.5 * limit:
            out.append(f"{path}: {lines} lines, {limit} are enough: split it")
        elif lines > limit:
            print(f"{path}: {lines} lines, more than {limit}")
    page, limit = RESULTS
    if (root / page).exists() and rules.read(root, page).count("\n") > limit:
        out.append(f"{page}: more than {limit} lines: tables stand beside their protocols in docs/results/, split it")
    return out


BAD = [({"docs/results.md": "\n" * 151}, "split"), ({"src/a.hpp": "\n" * 301}, "split"), ({"src/a.cpp": "\n" * 601}, "split")]
GOOD = {"docs/results.md": "\n" * 150, "src/a.hpp": "\n" * 150, "src/a.cpp": "\n" * 300}

if __name__ == "__main__":
    rules.main(check, BAD, GOOD)
