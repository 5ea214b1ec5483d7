#!/usr/bin/env python3
"""Gives every reader of the library damaged bytes by libFuzzer, under AddressSanitizer and
UndefinedBehaviorSanitizer.

  readers.py --program build/bin/underbrush                              2 seconds a reader
  readers.py --program build/bin/underbrush --executions 100000000       so many in all, in rounds, with those of runs
                                                                         that were stopped
  readers.py --program build/bin/underbrush --only pcd --replay FILE     one input again
  readers.py --program build/bin/underbrush --replays build/tests        without libFuzzer and sanitizers: the inputs
                                                                         once found, and 300 damaged copies of seeds

A reader fails by a crash, undefined behaviour, an exception of another kind than `FormatError` and `DataError`, a
leak, 10 seconds for an input, or 256 MiB of memory at once. The input is kept in the folder `found` of the build."""
import argparse
import concurrent.futures
import glob
import gzip
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import threading

import seeds

SOURCE = pathlib.Path(__file__).resolve().parents[2]
GROUPS = ("io", "models", "osi", "serve")
LIMITS = ("-timeout=10", "-rss_limit_mb=1536", "-malloc_limit_mb=256", "-print_final_stats=1", "-verbosity=1")
SANITIZERS = {"ASAN_OPTIONS": "quarantine_size_mb=16", "UBSAN_OPTIONS": "print_stacktrace=1"}
LARGEST = 100000  # bytes of a seed; larger ones only lead to others
ROUND_S = 60
COPIES = 300  # damaged copies of an input that is replayed
FAULT = re.compile(r"^.*(runtime error|ERROR: |terminate called)", re.MULTILINE)


def build(options):
    """Builds the programs in a build of their own."""
    launcher = shutil.which("ccache")
    done = subprocess.run(
        ["cmake", "-S", SOURCE, "-B", options.build, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=None", "-DUNDERBRUSH_FUZZ=ON",
         f"-DCMAKE_CXX_COMPILER={options.compiler}", "-DUNDERBRUSH_TESTS=OFF", "-DUNDERBRUSH_BENCH=OFF",
         "-DUNDERBRUSH_STUDIES=OFF"] + ([f"-DCMAKE_CXX_COMPILER_LAUNCHER={launcher}"] if launcher else []),
        capture_output=True, text=True, check=False)
    if done.returncode == 0:
        done = subprocess.run(["cmake", "--build", options.build, "--target"] + [f"fuzz_{g}" for g in options.groups],
                              capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"readers: cannot build the programs:\n{done.stdout}{done.stderr}")


class Reader:
    """A reader, its corpus, and a folder of seeds in which it runs."""
    def __init__(self, options, group, line):
        self.program = options.bin / f"fuzz_{group}"
        self.name, *files = line.split()
        self.full_name = f"{group}/{self.name}"
        self.folder = pathlib.Path(options.folder, group, self.name)
        shutil.copytree(pathlib.Path(options.folder, "seeds"), self.folder, copy_function=os.link)
        self.corpus = (pathlib.Path(options.folder) if options.replays else options.build) / "corpus" / group / self.name
        self.corpus.mkdir(parents=True, exist_ok=True)
        sizes = [4096]
        for pattern in files:
            for file in glob.glob(str(self.folder / pattern)):
                shutil.copy(file, self.corpus / os.path.relpath(file, self.folder).replace("/", "-"))
                sizes.append(os.path.getsize(file))
        kept = pathlib.Path(__file__).parent / "found" / group / self.name
        self.inputs = [self.corpus] + [kept] * kept.is_dir()
        self.longest = max(sizes)
        self.executions, self.seconds, self.fault = 0, 0, ""

    def run(self, seconds, seed):
        """Fuzzes for so many seconds."""
        found = self.corpus.parents[2] / "found"
        found.mkdir(exist_ok=True)
        done = self.start(f"-max_total_time={seconds}", f"-seed={seed}", f"-max_len={self.longest}",
                          f"-artifact_prefix={found}/{self.full_name.replace('/', '-')}-", *self.inputs)
        log = done.stderr.decode(errors="replace")
        count = re.search(r"number_of_executed_units: *(\d+)", log)
        self.executions += int(count[1]) if count else 0
        self.seconds += seconds
        if done.returncode != 0:
            first = FAULT.search(log)
            self.fault = log[first.start() if first else 0:][:4000]
        return self

    def replay(self):
        """Gives the reader its seeds, what was found once, and damaged copies of them."""
        files = [f for folder in self.inputs for f in sorted(folder.iterdir())]
        done = self.start(str(COPIES), *files, limits=())
        self.executions = len(files) * (COPIES + 1)
        if done.returncode != 0:
            self.fault = f"exit status {done.returncode}\n{done.stderr.decode(errors='replace')}"[:4000]
        return self

    def start(self, *arguments, limits=LIMITS):
        return subprocess.run([self.program, *limits, *arguments], cwd=self.folder, stdin=subprocess.DEVNULL,
                              capture_output=True, check=False,
                              env={**os.environ, **SANITIZERS, "READER": self.name, "TMPDIR": str(self.folder)})


def readers_of(options):
    """Makes the seeds, and returns all readers."""
    folder = pathlib.Path(options.folder, "seeds")
    folder.mkdir()
    seeds.make(folder, options.program)
    for file in folder.rglob("*"):
        if file.is_file() and file.stat().st_size > LARGEST:
            file.unlink()
    shutil.copytree(SOURCE / "tests/io/geotiff", folder / "geotiff", ignore=shutil.ignore_patterns("*.py"))
    (folder / "points.csv.gz").write_bytes(gzip.compress((folder / "points.csv").read_bytes(), mtime=0))
    out = []
    for group in options.groups:
        table = subprocess.run([options.bin / f"fuzz_{group}"], cwd=folder, capture_output=True, text=True,
                               check=True)
        out += [(group, line) for line in table.stdout.splitlines()]
    chosen = [Reader(options, group, line) for group, line in out]
    return [r for r in chosen if not options.only or options.only in (r.name, r.full_name)]


def replay(options, readers):
    """Replays all readers."""
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        list(pool.map(Reader.replay, readers))
    return report(readers)


def fuzz(options, readers):
    """Fuzzes all readers in rounds, until there are as many executions as were asked for. They are counted in the
    build's folder, so that a stopped run goes on."""
    counts = options.build / "executions.json"
    if options.executions and counts.exists():
        before = json.loads(counts.read_text())
        for r in readers:
            r.executions, r.seconds = before.get(r.full_name, (0, 0))
    seed = options.seed + sum(r.seconds for r in readers)
    lock = threading.Lock()

    def run(reader):
        reader.run(options.seconds, seed)
        if options.executions:
            with lock:
                part = counts.with_suffix(".part")
                part.write_text(json.dumps({r.full_name: (r.executions, r.seconds) for r in readers}))
                part.replace(counts)

    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        while True:
            sound = [r for r in readers if not r.fault]
            list(pool.map(run, sound))
            seed += 1
            if not sound or sum(r.executions for r in readers) >= options.executions:
                break
    return report(readers)


def report(readers):
    for r in readers:
        time = f" in {r.seconds} s" if r.seconds else ""
        print(f"{r.full_name}: {r.executions} executions{time}{', a fault' if r.fault else ''}")
    print(f"all: {sum(r.executions for r in readers)} executions of {len(readers)} readers")
    for r in readers:
        if r.fault:
            print(f"\n{r.full_name}: a fault\n{r.fault}")
    return any(r.fault for r in readers)


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--program", type=pathlib.Path, required=True, help="the program, which makes the seeds")
    p.add_argument("--build", type=pathlib.Path, default=SOURCE / "build/fuzz", help="folder of the build with clang")
    p.add_argument("--replays", type=pathlib.Path, help="folder of the programs of an ordinary build")
    p.add_argument("--groups", nargs="+", choices=GROUPS, default=GROUPS, help="programs of readers")
    p.add_argument("--only", help="the reader of this name alone")
    p.add_argument("--executions", type=int, default=0, help="go on until there are so many in all")
    p.add_argument("--seconds", type=int, help="seconds a reader in a round")
    p.add_argument("--seed", type=int, default=1)
    p.add_argument("--jobs", type=int, default=os.cpu_count())
    p.add_argument("--replay", type=pathlib.Path, help="give this file to the reader, once")
    options = p.parse_args()
    options.seconds = options.seconds or (ROUND_S if options.executions else 2)
    options.build, options.program = options.build.resolve(), options.program.resolve()
    options.compiler = shutil.which("clang++")
    options.bin = options.replays.resolve() if options.replays else options.build / "bin"
    if not options.replays:
        if not options.compiler:
            p.error("fuzzing needs clang++, which is not installed")
        build(options)
    with tempfile.TemporaryDirectory(dir="/dev/shm" if os.access("/dev/shm", os.W_OK) else None) as options.folder:
        readers = readers_of(options)
        if not readers:
            p.error(f"no reader is called {options.only}")
        if options.replay:
            done = readers[0].start(options.replay.resolve())
            print(done.stderr.decode(errors="replace"))
            return done.returncode
        return int(replay(options, readers) if options.replays else fuzz(options, readers))


if __name__ == "__main__":
    sys.exit(main())
