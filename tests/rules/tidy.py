#!/usr/bin/env python3
"""Runs clang-tidy on the sources that changed: since the branch left main, or in main's last commit, and
what is not committed. A changed header counts for the source beside it. --all takes every source."""
import pathlib
import re
import shutil
import subprocess

import rules

CLANG_TIDY = shutil.which("clang-tidy-14") or "clang-tidy"
CONFIG = f"--config-file={rules.ROOT / '.clang-tidy'}"


def arguments(parser):
    parser.add_argument("--build", required=True, type=pathlib.Path)
    parser.add_argument("--all", action="store_true")


def git(root, *words):
    done = subprocess.run(["git", "-c", "safe.directory=*", "-C", str(root), *words],
                          capture_output=True, text=True, check=False)
    return done.stdout.split("\n") if done.returncode == 0 else []


def base_commit(root):
    head = git(root, "rev-parse", "HEAD")[:1]
    for main in ("main", "origin/main"):
        base = git(root, "merge-base", "HEAD", main)[:1]
        if base and base != head:
            return base[0]
    return (git(root, "rev-parse", "--verify", "-q", "HEAD~1") or ["HEAD"])[0]


def changed_files(root):
    names = git(root, "diff", "--name-only", base_commit(root)) + git(
        root, "ls-files", "--others", "--exclude-standard")
    return {name for name in names if name}


def changed(root):
    return {re.sub(r"\.(hpp|inl)$", ".cpp", name) for name in changed_files(root)}


def single_sources(root, build):
    """A folder whose compile database has a command for each source: the build itself compiles several at once,
    after a precompiled header. So it also shows where a source lacks an include."""
    folder = build / "single_sources"
    subprocess.run(["cmake", "-S", str(root), "-B", str(folder), "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
                    "-DUNDERBRUSH_UNITY=OFF", "-DUNDERBRUSH_PCH=OFF"],
                   check=True, stdout=subprocess.DEVNULL)
    return folder


def check(root, options):
    if root == options.root:
        database = single_sources(root, options.build)
        known = {e["file"] for e in rules.compile_database(database)}
        wanted = rules.tracked(root, ".cpp")
        if not options.all:
            wanted = sorted(set(wanted) & changed(root))
        files = [f for f in wanted if str(root / f) in known]
        print(f"clang-tidy on {len(files)} sources")
        tail = ["-p", str(database)]
    else:
        files, tail = rules.tracked(root, ".cpp"), ["--", "-std=c++20"]
    failed = rules.run_in_parallel(
        [(f, [CLANG_TIDY, CONFIG, "--quiet", str(root / f)] + tail) for f in files])
    out = []
    for name, text in failed:
        found = [line for line in text.splitlines() if re.search(r" (error|warning): ", line)]
        out += found or [f"{name}: clang-tidy failed:\n{text}"]
    return sorted(set(out))


BAD = [({"a.cpp": "int HasBadName() { return 1; }\n"}, "readability-identifier-naming"),
       ({"a.cpp": "struct S { int value() { return v; }\nprivate: int v = 0; };\n"}, "identifier-naming"),
       ({"a.cpp": "int f(int n) {\n  if (n > 1);\n    n = 2;\n  return n;\n}\n"},
        "bugprone-suspicious-semicolon"),
       ({"a.cpp": "struct V { V(const V&); ~V(); int n; };\nint f(V v) { return v.n; }\n"},
        "performance-unnecessary-value-param")]
GOOD = {"a.cpp": "constexpr int kOne = 1;\nint has_good_name() { return kOne; }\n"}

if __name__ == "__main__":
    rules.main(check, BAD, GOOD, arguments)
