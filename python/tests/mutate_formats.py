#!/usr/bin/env python3
"""Reads damaged files of every kind: each is read, or refused with `FormatError`, within bounded memory and time.

    mutate_formats.py [--count 10000] [--seed 1] [--kind laz mcap ...]
    mutate_formats.py --lies         each number of each file's own structure, replaced by false ones

Every mutant is read in a child process whose address space may grow by twice the file's size and 256 MiB. A crash, a
hang (20 s), another exception or columns of different lengths are failures; each is printed with its kind, number and
seed and left in the folder `--keep`. The exit status is 1 if there are any.
"""
from __future__ import annotations

import argparse
import collections
import importlib
import logging
import os
import pathlib
import resource
import select
import subprocess
import sys
import tempfile
import time
import warnings
from collections.abc import Callable

import numpy as np
from format_data import generated_log
from format_fields import lies, put

from underbrush.formats import FormatError, OptionMissing, open_recording, place

_ALLOWANCE = 256 << 20
_HANG_S = 20.0
_NUMBERS = (0, 1, 2, 255, 0x7FFF, 0xFFFF, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF, 2**40, 2**63 - 1, 2**63, 2**64 - 1)


def seed_las(folder: pathlib.Path, name: str) -> pathlib.Path:
    from underbrush.formats.write_las import LasWriter
    log, _ = generated_log(scans=1, columns=60, echoes=3)
    with LasWriter(folder / name, crs="EPSG:32633") as writer:
        writer.write(log)
    return folder / name


def seed_old_laz(folder: pathlib.Path) -> pathlib.Path:
    """Point format 3 in chunks of 500 points, so that there are several."""
    laspy, lazrs = importlib.import_module("laspy"), importlib.import_module("lazrs")
    rng = np.random.default_rng(1)
    las = laspy.LasData(laspy.LasHeader(point_format=3, version="1.2"))
    n = 2000
    las.x, las.y, las.z = rng.normal(size=(3, n))
    las.gps_time = np.arange(n) * 0.1
    las.return_number = las.number_of_returns = np.ones(n, np.uint8)
    vlr = lazrs.LazVlr.new_for_compression(3, 0, False)
    record = bytearray(vlr.record_data())
    record[12:16] = (500).to_bytes(4, "little")
    las.header.vlrs.append(laspy.vlrs.VLR("laszip encoded", 22204, "", bytes(record)))
    las.header.set_compressed(True)
    with (folder / "old.laz").open("wb") as out:
        las.header.write_to(out)
        compressor = lazrs.LasZipCompressor(out, lazrs.LazVlr(bytes(record)))
        compressor.compress_many(np.frombuffer(las.points.array.tobytes(), np.uint8))
        compressor.done()
    return folder / "old.laz"


def seed_bag(folder: pathlib.Path, name: str, compress: bool = False) -> pathlib.Path:
    from underbrush.formats.write_bag import BagWriter
    log, poses = generated_log(scans=4, rings=8, columns=40, start_s=100)
    with BagWriter(folder / name, poses, compress=compress) as writer:
        writer.write(log)
    return folder / name


def seed_e57(folder: pathlib.Path) -> pathlib.Path:
    from test_e57 import written
    written(folder / "log.e57")
    return folder / "log.e57"


def seed_text(folder: pathlib.Path) -> pathlib.Path:
    rng = np.random.default_rng(1)
    rows = rng.normal(size=(500, 11))
    rows[:, 5:10] = [1, 1, 0, 3, 2]
    (folder / "log.xyz").write_text("\n".join(" ".join(f"{v:.4f}" for v in row) for row in rows))
    return folder / "log.xyz"


def seed_numpy(folder: pathlib.Path) -> pathlib.Path:
    from underbrush.formats.numpy_log import NumpyLogWriter
    with NumpyLogWriter(folder / "log.npz") as writer:
        writer.write(generated_log(scans=1, rings=4, columns=40)[0])
    return folder / "log.npz"


KINDS: dict[str, Callable[[pathlib.Path], pathlib.Path]] = {
    "las": lambda f: seed_las(f, "log.las"), "laz": lambda f: seed_las(f, "log.laz"), "old-laz": seed_old_laz,
    "mcap": lambda f: seed_bag(f, "log.mcap"), "mcap-zstd": lambda f: seed_bag(f, "log.mcap", True),
    "sqlite3": lambda f: seed_bag(f, "log.db3"), "ros1": lambda f: seed_bag(f, "log.bag"),
    "ros1-lz4": lambda f: seed_bag(f, "log.bag", True),
    "e57": seed_e57, "xyz": seed_text, "npz": seed_numpy}


def _crc32c_table() -> list[int]:
    table = []
    for n in range(256):
        for _ in range(8):
            n = n >> 1 ^ (0x82F63B78 if n & 1 else 0)
        table.append(n)
    return table


_CRC = _crc32c_table()


def with_checksums(content: bytes, before: bytes) -> bytes:
    """The pages of an E57 file that changed, with checksums that fit, so that the damage reaches the decoder."""
    out = bytearray(content)
    for begin in range(0, len(out) - 1023, 1024):
        if out[begin:begin + 1020] != before[begin:begin + 1020]:
            crc = 0xFFFFFFFF
            for byte in out[begin:begin + 1020]:
                crc = _CRC[(crc ^ byte) & 0xFF] ^ crc >> 8
            out[begin + 1020:begin + 1024] = (crc ^ 0xFFFFFFFF).to_bytes(4, "big")
    return bytes(out)


LIES = 0  # the seed of `damaged` that stands for lies


def damaged(seed: bytes, kind: str, number: int, main_seed: int) -> bytes:
    """A mutant, or for the seed `LIES` the file with the lie of that number."""
    if main_seed != LIES:
        return mutant(seed, kind, number, main_seed)
    field, value = lies(kind, seed)[number]
    lie = put(seed, field, value)
    return with_checksums(lie, seed) if kind == "e57" else lie


def mutant(seed: bytes, kind: str, number: int, main_seed: int) -> bytes:
    """The damaged file of that number: the same for the same seeds."""
    rng = np.random.default_rng([main_seed, number, *kind.encode()])
    out = bytearray(seed)
    for _ in range(int(rng.choice([1, 1, 2, 3, 8]))):
        if len(out) < 2:
            break
        # Headers and the indexes at the end decide more than the middle.
        span = int(rng.choice([64, 400, 2000, len(out)]))
        at = int(rng.integers(0, min(span, len(out))))
        if rng.random() < 0.25:
            at = len(out) - 1 - at
        length = int(rng.choice([1, 2, 4, 8, 40, 500]))
        what = rng.integers(0, 8)
        if what == 0:
            out[at] ^= 1 << int(rng.integers(0, 8))
        elif what == 1:
            out[at] = int(rng.integers(0, 256))
        elif what in (2, 3):
            width = int(rng.choice([1, 2, 4, 8]))
            value = _NUMBERS[int(rng.integers(0, len(_NUMBERS)))] + int(rng.integers(-1, 2))
            out[at:at + width] = (value % (1 << 8 * width)).to_bytes(width, "little")[:len(out) - at]
        elif what == 4 and rng.random() < 0.3:
            del out[at + 1:]
        elif what == 5:
            del out[at:at + length]
        elif what == 6:
            out[at:at] = out[at:at + length]
        else:
            out[at:at + length] = rng.bytes(min(length, len(out) - at))
    if kind == "e57" and rng.random() < 0.8:
        return with_checksums(bytes(out), seed)
    return bytes(out)


def read_all(path: pathlib.Path) -> str:
    """Reads a file to the end; returns what became of it. Other exceptions than those of the contract pass."""
    try:
        recording = open_recording(path)
        recording.found()
        for scan in recording.scans():
            n = len(scan)
            for column in (scan.xyz, scan.direction, scan.range_m, scan.origin, scan.beam_time_s, scan.intensity,
                           scan.ring, scan.echo, scan.echoes, *scan.extra.values()):
                assert column is None or len(column) == n, "columns of different lengths"
            with np.errstate(all="ignore"):
                place(scan, None, world=recording.world, position=(0.0, 0.0, 0.0))
        return "counted" if recording.skipped else "read"
    except FormatError as error:
        assert "\n" not in str(error), "a message of several lines"
        return "refused"
    except OptionMissing:
        return "asked"


def _grown_to(allowed: int) -> None:
    pages = int(pathlib.Path("/proc/self/statm").read_text().split()[0])
    limit = pages * resource.getpagesize() + allowed
    resource.setrlimit(resource.RLIMIT_AS, (limit, limit))


def child(kind: str, good: pathlib.Path, numbers: range, main_seed: int) -> None:
    """Reads mutants of a file and prints a line "NUMBER what" for each, the number before it is read."""
    null = os.open(os.devnull, os.O_WRONLY)
    os.dup2(null, 2)  # Rust's panics and libE57's reports go there.
    logging.disable()
    warnings.simplefilter("ignore")
    seed = good.read_bytes()
    read_all(good)  # Libraries and threads are there before the limit is set.
    _grown_to(2 * len(seed) + _ALLOWANCE)
    path = good.with_name("mutant" + good.suffix)
    for number in numbers:
        print(number, end=" ", flush=True)
        path.write_bytes(damaged(seed, kind, number, main_seed))
        try:
            what = read_all(path)
        except BaseException as error:  # noqa: BLE001
            what = f"! {type(error).__name__}: {str(error)[:150]}"
        print(what.replace("\n", " "), flush=True)
    os._exit(0)


def run(kind: str, count: int, main_seed: int,
        keep: pathlib.Path | None = None) -> tuple[collections.Counter[str], list[str]]:
    """Reads `count` mutants of a kind, or about so many of its lies; returns what became of them, and the failures."""
    results: collections.Counter[str] = collections.Counter()
    failures: list[str] = []
    with tempfile.TemporaryDirectory() as name:
        good = KINDS[kind](pathlib.Path(name))
        seed = good.read_bytes()
        step = 1
        if main_seed == LIES:
            there = len(lies(kind, seed))
            step, count = max(1, there // count), there
        number = 0
        while number < count:
            number = _batch(kind, good, range(number, count, step), main_seed, results, failures)
        for line in failures if keep is not None else []:
            assert keep is not None
            keep.mkdir(exist_ok=True)
            wrong = int(line.split()[1])
            (keep / f"{kind}-{wrong}{good.suffix}").write_bytes(damaged(seed, kind, wrong, main_seed))
    return results, failures


def _batch(kind: str, good: pathlib.Path, numbers: range, main_seed: int, results: collections.Counter[str],
           failures: list[str]) -> int:
    """Runs a process until it ends, crashes or hangs; returns the next number."""
    command = [sys.executable, __file__, "--child", kind, str(good), str(numbers.start), str(numbers.stop),
               str(numbers.step), str(main_seed)]
    text, hung = b"", False
    with subprocess.Popen(command, stdout=subprocess.PIPE) as process:
        assert process.stdout is not None
        while select.select([process.stdout], [], [], _HANG_S)[0]:
            data = os.read(process.stdout.fileno(), 1 << 16)
            if not data:
                break
            text += data
        else:
            hung = True
            process.kill()
    status = process.returncode
    *lines, rest = text.decode(errors="replace").split("\n")
    for line in lines:
        number, _, what = line.partition(" ")
        results["failed" if what.startswith("!") else what] += 1
        if what.startswith("!"):
            failures.append(f"{kind} {number} {what[2:]}")
    if hung or status != 0:
        if not rest:
            failures.append(f"{kind} {numbers.start} the undamaged file: status {status}")
            return numbers.stop
        number = rest.split()[0]
        results["failed"] += 1
        failures.append(f"{kind} {number} " + ("hangs" if hung else f"ends the process: status {status}"))
        return int(number) + numbers.step
    return numbers.stop


def main() -> int:
    if sys.argv[1:2] == ["--child"]:
        kind, good, begin, end, step, seed = sys.argv[2:]
        child(kind, pathlib.Path(good), range(int(begin), int(end), int(step)), int(seed))
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--count", type=int, default=10_000, help="mutants of each kind")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--lies", action="store_true", help="lies instead of mutants")
    parser.add_argument("--kind", nargs="+", choices=list(KINDS), default=list(KINDS))
    parser.add_argument("--keep", type=pathlib.Path, help="folder for mutants that fail")
    options = parser.parse_args()
    failed = 0
    for kind in options.kind:
        start = time.monotonic()
        results, failures = run(kind, options.count, LIES if options.lies else options.seed, options.keep)
        counts = ", ".join(f"{count} {what}" for what, count in sorted(results.items()))
        print(f"{kind}: {counts}; {time.monotonic() - start:.0f} s", flush=True)
        for line in failures[:20]:
            print("  FAILED " + line)
        failed += len(failures)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
