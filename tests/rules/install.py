#!/usr/bin/env python3
"""What is installed is whole: a stranger's project finds the package, compiles every header and the C++ example of the
README, links, runs; and the installed program answers and finds its example scan."""
import argparse
import os
import pathlib
import re
import subprocess
import sys
import tempfile

import rules

parser = argparse.ArgumentParser()
parser.add_argument("--build", required=True, type=pathlib.Path)
parser.add_argument("--cmake", default="cmake")
parser.add_argument("--launcher", default="", help="as CMAKE_CXX_COMPILER_LAUNCHER")
options = parser.parse_args()


def run(*command, **more):
    done = subprocess.run([str(c) for c in command], stdout=subprocess.PIPE, text=True,
                          stderr=subprocess.STDOUT, check=False, **more)
    if done.returncode:
        sys.exit(f"{' '.join(map(str, command))}\n{done.stdout}\nexit status {done.returncode}")
    return done.stdout


def example(page):
    """The C++ of the page that is run: the block after <!-- run: c++ -->."""
    found = re.findall(r"^<!-- run: c\+\+ -->\n```cpp\n(.*?)^```$", page, re.DOTALL | re.MULTILINE)
    if len(found) != 1:
        sys.exit(f"README.md: {len(found)} blocks of C++ with the mark <!-- run: c++ -->, 1 is expected")
    return found[0]


with tempfile.TemporaryDirectory() as folder:
    readme = pathlib.Path(folder, "readme.cpp")
    readme.write_text(example(rules.read(rules.ROOT, "README.md")), encoding="utf-8")
    prefix, consumer = pathlib.Path(folder, "prefix"), pathlib.Path(folder, "consumer")
    run(options.cmake, "--install", options.build, "--prefix", prefix)
    environment = dict(os.environ, CCACHE_BASEDIR=folder, CCACHE_NOHASHDIR="1")
    run(options.cmake, "-S", rules.ROOT / "tests/consumer", "-B", consumer, "-G", "Ninja",
        f"-DCMAKE_PREFIX_PATH={prefix}", f"-DCMAKE_CXX_COMPILER_LAUNCHER={options.launcher}",
        f"-DREADME_EXAMPLE={readme}", env=environment)
    run(options.cmake, "--build", consumer, env=environment)
    print(run(consumer / "consumer"), end="")
    print(run(consumer / "chain", consumer / "libmean_tracker.so"), end="")
    print(run(prefix / "bin/underbrush", "--version"), end="")
    environment.pop("UNDERBRUSH_SHARE", None)
    print(run(prefix / "bin/underbrush", "demo", "--only", "real", cwd=folder, env=environment), end="")
    print(run(consumer / "readme", cwd=folder), end="")
