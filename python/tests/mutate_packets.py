"""Damaged captures: `python mutate_packets.py [FAMILY ...] [--mutants N] [--seed S]`, all families by default.

Each mutant is read in full, and nothing may come of it but sound scans, counts in `skipped` and FormatError. Memory
stays below twice the largest file plus 256 MiB above what the process had before. The same seed gives the same mutants.
"""
from __future__ import annotations

import argparse
import collections
import json
import pathlib
import random
import re
import resource
import shutil
import tempfile
import time
from collections.abc import Callable, Iterable, Iterator
from typing import Any

import numpy as np
import numpy.typing as npt

import hesai_mirror_unit
import hesai_unit
import test_hesai_states as hesai_states
import livox_unit
import packet_files as pf
from capture_fields import lies
from format_fields import lies_in
from packet_files import T0
from underbrush.errors import FormatError
from underbrush.formats.packets import PacketRecording
from underbrush.formats.scans import Scan

#: Capture, metadata and the metadata's suffix; "/" is a folder, whose files are separated by a NUL byte.
Sample = tuple[bytes, bytes | None, str]


def velodyne() -> list[Sample]:
    """Captures of all models in single and dual mode."""
    random.seed(1)
    samples: list[Sample] = []
    for layout, lasers, product, firings in (("vlp16", 16, 0x22, 24), ("hdl32", 32, 0x21, 12), ("hdl32", 32, 0x28, 12),
                                             ("vls128", 128, 0xA1, 3), ("hdl64", 64, 0, 6)):
        for mode in (0x37, 0x39):
            per_packet = firings // (2 if mode == 0x39 else 1)
            records = []
            for packet in range(12):
                beams = [[(random.choice((0, random.randrange(65536))), 9, random.randrange(3000), 8)
                          for _ in range(lasers)] for _ in range(per_packet)]
                azimuths = [170 + packet * 2 + 0.2 * k for k in range(per_packet)]
                raw = pf.velodyne_packet(beams, azimuths, 199_000_000 + 1300 * packet,
                                         mode if layout != "hdl64" else -1 if mode == 0x39 else 0, product, layout)
                records.append((T0 + 1300e-6 * packet, pf.udp(raw)[0]))
            metadata = None
            if layout == "hdl64":
                metadata = json.dumps({"num_lasers": 64, "distance_resolution": 0.002, "lasers": [
                    {"laser_id": k, "vert_correction": 0.01 * k, "rot_correction": 0.01, "dist_correction": 1.4,
                     "dist_correction_x": 1.41, "horiz_offset_correction": 0.02} for k in range(64)]}).encode()
            samples.append((pf.pcap(records), metadata, ".yaml"))
    return samples


def ouster() -> list[Sample]:
    """Captures of several profiles, three small frames each."""
    random.seed(2)
    samples: list[Sample] = []
    for profile in pf.PIXELS:
        records = []
        for number in range(12):
            frame, begin = divmod(number * 16, 64)
            columns = [(10**12 + (number * 16 + k) * 10**6, begin + k,
                        [(random.choice((0, 8 * random.randrange(4000))), 8 * random.randrange(4000), (5, 6), (7, 8), 9)
                         for _ in range(16)], k != 5) for k in range(16)]
            records.append((T0 + 0.016 * number, pf.udp(pf.ouster_packet(profile, 5 + frame, columns), port=7502)[0]))
        samples.append((pf.pcap(records), pf.ouster_metadata(16, 64, profile, nested=len(samples) % 2 == 0).encode(),
                        ".json"))
    return samples


def hesai() -> list[Sample]:
    """Captures of all models with single and dual returns, four small packets each."""
    samples: list[Sample] = []
    for name, unit in hesai_unit.UNITS.items():
        for mode, returns in ((0x37, 1), (0x39, 2)):
            truth = hesai_unit.observe(unit, 8 * unit.blocks, returns)
            packets = hesai_unit.packets_of(unit, truth, mode, returns, flags=9 if name == "xt16" else 1)
            angles = "".join(f"{k + 1},{value},0.1\n" for k, value in enumerate(unit.elevation)).encode()
            samples.append((pf.pcap([(time_s, pf.udp(data)[0]) for time_s, data in packets]),
                            angles if unit.needs_file else None, ".csv"))
    for kind in hesai_states.KINDS.values():
        packets = hesai_states.packets_of(kind, hesai_states.observe(kind, 16), 0x15)
        with tempfile.TemporaryDirectory() as folder:
            files = sorted(hesai_states.folder(pathlib.Path(folder), kind).iterdir())
            samples.append((pf.pcap([(time_s, pf.udp(data)[0]) for time_s, data in packets]),
                            b"\0".join(file.read_bytes() for file in files), "/"))
    mirror_deg, time_s = (column[:24] for column in hesai_mirror_unit.sweeps(1))
    counts = np.full((24, 1, 128), 500)
    packets = hesai_mirror_unit.packets(mirror_deg, time_s, counts, 1)
    with tempfile.TemporaryDirectory() as folder:
        file = hesai_mirror_unit.correction(pathlib.Path(folder) / "c.dat").read_bytes()
    return [*samples, (pf.pcap([(time_s, pf.udp(data)[0]) for time_s, data in packets]), file, ".dat")]


def livox() -> list[Sample]:
    """Captures of all kinds of data."""
    return [(pf.pcap([(time_s, pf.udp(data, port=56301)[0]) for time_s, data in livox_unit.packets_of(kind, 8)]), None,
             "") for kind in livox_unit.KINDS]


def container() -> list[Sample]:
    """The same packets in other containers and in fragments."""
    capture, metadata, suffix = ouster()[0]
    packets = [capture[k:k + 16 * 212] for k in range(24 + 16 + 42, len(capture), 16 * 212 + 58)]
    four, six = ([(T0 + 0.016 * number, part) for number, packet in enumerate(packets)
                  for part in pf.udp(packet, port=7502, identity=number, mtu=700, version=version)]
                 for version in (4, 6))
    return [(data, metadata, suffix) for data in (
        pf.pcapng(four), pf.pcapng(six, ">", 6, link="cooked vlan"), pf.pcap(four, ">", True, "double vlan"))]


def damaged(data: bytes, chance: random.Random) -> bytes:
    """One to five damages: bits, bytes, runs, cuts, stretches left out, twice or exchanged, absurd numbers."""
    out = bytearray(data)
    for _ in range(chance.choice((1, 1, 1, 2, 5))):
        place = chance.randrange(len(out)) if chance.random() < 0.5 else min(chance.randrange(400), len(out) - 1)
        length = chance.choice((1, 2, 4, 16, 300))
        kind = chance.randrange(9)
        if kind == 0:
            out[place] ^= 1 << chance.randrange(8)
        elif kind == 1:
            out[place] = chance.randrange(256)
        elif kind == 2:
            out[place:place + length] = chance.randbytes(length)
        elif kind == 3:
            out[place:place + 4] = chance.choice((b"\0" * 4, b"\xff" * 4, b"\xff\xff\xff\x7f", b"\0\0\0\x80"))
        elif kind == 4:
            del out[place:place + length]
        elif kind == 5:
            out[place:place] = out[place:place + length]
        elif kind == 6:
            other = chance.randrange(len(out))
            out[place:place + length], out[other:other + length] = out[other:other + length], out[place:place + length]
        elif kind == 7:
            out[place:place] = bytes(length)
        elif chance.random() < 0.3:
            del out[max(1, place):]
        if not out:
            return b"\0"
    return bytes(out)


def damaged_text(data: bytes, chance: random.Random) -> bytes:
    """Bytes damaged, or one number or word exchanged for an absurd one."""
    if chance.random() < 0.4:
        return damaged(data, chance)
    words = list(re.finditer(rb"[-+.\w]+", data))
    word = chance.choice(words)
    new = chance.choice((b"-1", b"0", b"1e300", b"1e999", b"NaN", b"99999999999999999999", b"null", b'"x"', b"[]",
                         b"{}", b"65536", b"LEGACY", b"0.5", b""))
    return data[:word.start()] + new + data[word.end():]


def check(scan: Scan) -> None:
    """A scan is sound: columns of one length, unit vectors, positive ranges, misses without intensity."""
    assert scan.direction is not None and scan.range_m is not None and scan.beam_time_s is not None
    assert scan.echo is not None and scan.echoes is not None and scan.ring is not None and scan.intensity is not None
    columns: list[npt.NDArray[Any]] = [
        scan.direction, scan.range_m, scan.beam_time_s, scan.echo, scan.echoes, scan.ring, scan.intensity,
        *scan.extra.values(), *([] if scan.origin is None else [scan.origin])]
    assert {len(column) for column in columns} == {len(scan)} and len(scan) > 0
    assert np.allclose(np.linalg.norm(scan.direction, axis=1), 1, atol=1e-6)
    assert (scan.range_m > 0).all() and (np.isinf(scan.range_m) == (scan.echo == 0)).all()
    assert np.isfinite(scan.beam_time_s).all() and np.isfinite(scan.intensity).all()
    assert (scan.intensity[scan.echo == 0] == 0).all() and (scan.echo <= scan.echoes).all()
    assert scan.origin is None or np.isfinite(scan.origin).all()


FAMILIES: dict[str, Callable[[], list[Sample]]] = {
    "velodyne": velodyne, "ouster": ouster, "hesai": hesai, "livox": livox, "container": container}


def read_one(capture: bytes, metadata: bytes | None, suffix: str, folder: pathlib.Path) -> str:
    """Reads a damaged capture in full, and returns what became of it."""
    path, beside = folder / "m.pcap", folder / f"m{suffix}"
    path.write_bytes(capture)
    if suffix == "/":
        shutil.rmtree(beside, ignore_errors=True)
        beside.mkdir()
        for place, content in enumerate((metadata or b"").split(b"\0")):
            (beside / f"{place}.csv").write_bytes(content)
    elif metadata is not None:
        beside.write_bytes(metadata)
    start = time.process_time()
    try:
        recording = PacketRecording(path, beside if metadata is not None else None)
        for scan in recording.scans():
            check(scan)
        assert all("\n" not in line for line in recording.found())
        assert all(count > 0 for count in recording.skipped.values())
        end = "scans, with counts of what was left out" if recording.skipped else "scans"
    except FormatError as error:
        assert "\n" not in str(error) and re.search(r"\bm\.|/m\b", str(error)), error
        end = "refused"
    took = time.process_time() - start
    assert took < 20, f"it took {took} s"
    return end


def read_all(family: str, damages: Iterable[tuple[bytes, bytes | None, str]], folder: pathlib.Path) -> collections.Counter[str]:
    """Reads damaged captures and returns how many came to which end."""
    ends: collections.Counter[str] = collections.Counter()
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
    largest = 0
    for number, (capture, metadata, suffix) in enumerate(damages):
        largest = max(largest, len(capture))
        try:
            ends[read_one(capture, metadata, suffix, folder)] += 1
        except BaseException:
            (folder / f"bad_{number}.pcap").write_bytes(capture)
            print(f"{family}: number {number} fails; kept in {folder}")
            raise
    grown = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024 - before
    assert grown < 2 * largest + (256 << 20), f"memory grew by {grown >> 20} MiB"
    return ends


def run(family: str, mutants: int, seed: int, folder: pathlib.Path) -> collections.Counter[str]:
    """Reads `mutants` damaged captures and returns how many came to which end."""
    samples, chance = FAMILIES[family](), random.Random(seed)

    def damages() -> Iterator[Sample]:
        for number in range(mutants):
            capture, metadata, suffix = samples[number % len(samples)]
            if metadata is not None and chance.random() < 0.2:
                yield capture, damaged_text(metadata, chance), suffix
            else:
                yield damaged(capture, chance), metadata, suffix

    return read_all(family, damages(), folder)


def run_lies(family: str, most: int, folder: pathlib.Path) -> collections.Counter[str]:
    """Reads captures whose fields lie, and binary calibrations that do, about `most` of each sample."""
    def some(values: list[bytes]) -> list[bytes]:
        return values[::max(1, len(values) // most)]

    def damages() -> Iterator[Sample]:
        for capture, metadata, suffix in FAMILIES[family]():
            yield from ((lie, metadata, suffix) for lie in some(lies(capture)))
            if suffix == ".dat" and metadata is not None:
                fields = [(at, width, False) for at in range(60) for width in (1, 4)]
                yield from ((capture, lie, suffix) for lie in some(list(lies_in(metadata, fields))))

    return read_all(family, damages(), folder)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("families", nargs="*", metavar="FAMILY", help=f"{', '.join(FAMILIES)} (default: all)")
    parser.add_argument("--mutants", type=int, default=10_000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--lies", action="store_true", help="lies in all fields instead, about so many of each capture")
    options = parser.parse_args()
    for family in options.families or FAMILIES:
        folder = pathlib.Path(tempfile.mkdtemp(prefix=f"mutants-{family}-"))
        ends = run_lies(family, options.mutants, folder) if options.lies else run(family, options.mutants, options.seed, folder)
        peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss >> 10
        counts = ", ".join(f"{count} {end}" for end, count in sorted(ends.items()))
        print(f"{family}: {counts}; peak of memory {peak} MiB", flush=True)
        shutil.rmtree(folder)


if __name__ == "__main__":
    main()
