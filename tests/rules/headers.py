#!/usr/bin/env python3
"""Checks that each header, private ones (.inl) too, compiles alone. Clang reads them, and what it makes of the third
parties is kept for all headers that include the same. The kernels' private headers, in GCC's dialect, are compiled
once for each instruction set. Only headers are compiled that changed, and those that include what changed and either
reach fewer headers than before or have a word that a changed header lost: since the branch left main, or in main's
last commit, and what is not committed. --all takes every header."""
import collections
import concurrent.futures
import functools
import os
import platform
import re
import subprocess
import tempfile

import rules
import tidy

# Folders in which includes are looked for, in order, and in which the headers lie.
FOLDERS = ("src", ".", "apps", "apps/underbrush", "tests")
OWN = re.compile(r"(src|report|studies|apps|cli|tests)/(?!fuzz/|rules/|consumer/)")
# Third parties whose headers take long to read. A header that includes one of them gets all that this one includes,
# so that having read it before hides no missing include.
SLOW = re.compile(r"(Eigen/Core|Eigen/Geometry|nlohmann/json\.hpp|CLI/CLI\.hpp)$")
INCLUDE = r'^\s*#\s*include\s*(?:<([^>]+)>|"([^"]+)")'
KERNEL = re.compile(r"src/.*/trace/.*\.inl$")
FLAGS = ("-std=c++20", "-DEIGEN_MAX_STATIC_ALIGN_BYTES=16", '-DUNDERBRUSH_TEST_DATA=""', "-isystem",
         "/usr/include/eigen3")
INSTRUCTION_SETS = ((), ("-mavx2", "-mfma", "-mbmi", "-mpopcnt"),
                    ("-mavx2", "-mfma", "-mbmi", "-mpopcnt", "-mavx512f", "-mavx512vl", "-mavx512dq"))


class Includes:
    """What each header includes, itself or through others of ours: files of ours, with it, and other headers. `text`
    gives the text of a file of ours, or None."""

    def __init__(self, text):
        self.text, self.known = text, {}

    def of(self, header):
        if header not in self.known:
            self.known[header] = frozenset()
            found = {header}
            for _, m in rules.lines_with(INCLUDE, rules.split_cpp(self.text(header))[0]):
                if m[1]:
                    found.add(m[1])
                    continue
                for folder in FOLDERS:
                    path = os.path.normpath(f"{folder}/{m[2]}")
                    if self.text(path) is not None:
                        found |= self.of(path)
                        break
            self.known[header] = frozenset(found)
        return self.known[header]


def wanted(root, every):
    """{slow third parties: headers} of the headers to compile."""
    changed, base = tidy.changed_files(root), tidy.base_commit(root)

    @functools.cache
    def text_now(path):
        return rules.read(root, path) if (root / path).is_file() else None

    @functools.cache
    def text_before(path):
        return "\n".join(tidy.git(root, "show", f"{base}:{path}")) if path in changed else text_now(path)

    def words(text):
        return set(re.findall(r"\w+", rules.split_cpp(text or "")[0]))

    lost = set().union(*(words(text_before(f)) - words(text_now(f)) for f in changed if f.endswith((".hpp", ".inl"))))
    groups, now, before = collections.defaultdict(list), Includes(text_now), Includes(text_before)
    for header in rules.tracked(root, ".hpp", ".inl"):
        if OWN.match(header):
            files = now.of(header)
            breaks = files & changed and words(text_now(header)) & lost
            if every or header in changed or breaks or before.of(header) - files:
                groups[frozenset(filter(SLOW.match, files))].append(header)
    return groups


def compile_alone(words, header):
    """The first error of a header on its own, or None."""
    done = subprocess.run([*words, "-fsyntax-only", "-x", "c++", "-"], input=f'#include "{header}"\n',
                          capture_output=True, text=True)
    errors = [line for line in done.stderr.splitlines() if "error:" in line]
    return None if done.returncode == 0 else (errors or [done.stderr.strip()])[0]


def arguments(parser):
    parser.add_argument("--all", action="store_true")


def check(root, options):
    groups = wanted(root, options.all or root != options.root)
    print(f"{sum(map(len, groups.values()))} headers")
    words, jobs = [*FLAGS, *(f"-I{root / folder}" for folder in FOLDERS)], []
    with tempfile.TemporaryDirectory() as folder, concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for number, (parties, headers) in enumerate(sorted(groups.items(), key=lambda g: sorted(g[0]))):
            read = os.path.join(folder, f"{number}.pch")
            text = "".join(f"#include <{party}>\n" for party in sorted(parties))
            subprocess.run(["clang++", *words, "-x", "c++-header", "-", "-o", read], input=text, text=True, check=True)
            for header in headers:
                ways = [["clang++", *words, "-include-pch", read]]
                if KERNEL.match(header) and platform.machine() == "x86_64":
                    ways = [["g++", "-Wno-psabi", *words, *flags] for flags in INSTRUCTION_SETS]
                jobs += [(header, pool.submit(compile_alone, way, root / header)) for way in ways]
        return [f"{header}: does not compile alone: {job.result()}" for header, job in jobs if job.result()]


ALONE = "#pragma once\ninline std::vector<int> nothing() { return {}; }\n"
EIGEN = "#pragma once\n#include <Eigen/Core>\n"
BAD = [
    ({"src/a.hpp": ALONE}, "std"),
    ({"src/trace/a.inl": ALONE}, "std"),
    ({"src/a.hpp": EIGEN, "src/b.hpp": "#pragma once\ninline Eigen::Vector3d nothing();\n"}, "Eigen"),
    ({"src/a.hpp": EIGEN + '#include "c.hpp"\n', "src/c.hpp": ALONE}, "src/c.hpp"),
]
GOOD = {"src/a.hpp": EIGEN + '#include "b.hpp"\n', "src/b.hpp": EIGEN + "inline Eigen::Vector3d nothing();\n"}

if __name__ == "__main__":
    rules.main(check, BAD, GOOD, arguments)
