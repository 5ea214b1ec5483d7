"""`underbrush import` of recordings that the package's readers know: bags, LAS and LAZ, packets, E57."""
from __future__ import annotations

import argparse
import collections
import json
import pathlib
import sys
import time
from collections.abc import Callable, Iterable, Sequence
from typing import TYPE_CHECKING

from underbrush._core import BeamLog, LogInfo, LogWriter, check_outputs, set_threads, version
from underbrush.errors import FormatError

if TYPE_CHECKING:
    from underbrush.formats.scans import Recording


def parser() -> argparse.ArgumentParser:
    """Returns the parser of the options; those of the program for other formats have the same names."""
    p = argparse.ArgumentParser(prog="underbrush import", description="Convert a recording to a ray cloud.")
    p.add_argument("file", metavar="FILE", help="bag, MCAP, LAS, LAZ, pcap, pcapng or E57")
    p.add_argument("-o", "--output", metavar="LOG.ply", help="the log; without it, say what the recording holds")
    p.add_argument("--topic", default="", help="the topic (bags) or stream to read")
    p.add_argument("--poses", metavar="FILE|TOPIC", help="poses of the sensor; default: the recording's own")
    p.add_argument("--position", metavar="X,Y,Z", type=_place, help="place of a sensor that stands still, m")
    p.add_argument("--frame", default="", help="frame of the poses (bags)")
    p.add_argument("--clock", default="stamp", help="clock of the scans (bags)")
    p.add_argument("--metadata", metavar="FILE", help="the sensor's metadata (Ouster JSON, calibration YAML)")
    p.add_argument("--sensor", default="", help="sensor of the catalogue; default: what the recording says")
    p.add_argument("--max-range", metavar="M", type=_range, default=0.0,
                   help="range of a miss, m; default: the sensor's, or that of the longest return")
    p.add_argument("--json", metavar="FILE|-", help="write the counts as JSON")
    p.add_argument("--force", action="store_true", help="replace files that underbrush did not write")
    p.add_argument("--threads", type=int, default=0, metavar="N", help="threads, 0 = one a core")
    p.add_argument("--seed", type=int, default=1, help="seed of random choices, of which a recording needs none")
    return p


def _place(text: str) -> tuple[float, float, float]:
    x, y, z = (float(word) for word in text.split(","))
    return x, y, z


def _range(text: str) -> float:
    value = float(text)
    if not 0 < value <= 1e6:
        raise argparse.ArgumentTypeError(f"must be positive and at most 1000000 m, not {text}")
    return value


class Progress:
    """A line on standard error with share, rate and time left, at most ten times a second; only on a terminal."""

    def __init__(self, total: int) -> None:
        self._total, self._start, self._shown = total, time.monotonic(), 0.0

    def __call__(self, done: int, points: int) -> None:
        """Shows that `done` bytes are read, which held so many points."""
        now = time.monotonic()
        if not sys.stderr.isatty() or now - self._shown < 0.1:
            return
        self._shown = now
        share, took = done / max(self._total, 1), now - self._start
        left = f"  {took * (1 / share - 1):.0f} s left" if share > 0.02 else ""
        sys.stderr.write(f"\r\x1b[Kimport {100 * share:3.0f} %  {points / max(took, 1e-9) / 1e6:.2f} M points/s{left}")

    def close(self) -> None:
        """Clears the line."""
        if self._shown:
            sys.stderr.write("\r\x1b[K")


def opened(options: argparse.Namespace) -> Recording:
    """Opens the recording with the reader of its format."""
    from underbrush.formats import open_recording
    return open_recording(options.file, topic=options.topic or None, poses=options.poses, metadata=options.metadata,
                          sensor=options.sensor or None, frame=options.frame or None, clock=options.clock)


def beams_of(recording: Recording, options: argparse.Namespace) -> tuple[LogInfo, Iterable[BeamLog]]:
    """Places the scans of a recording in the world: facts of the log, and its beams in chunks, misses included."""
    from underbrush.formats.log import beams_of_recording
    return beams_of_recording(recording, poses=options.poses, position=options.position,
                              sensor=options.sensor or None)


def write(options: argparse.Namespace, recording: Recording, provenance: str) -> dict[str, object]:
    """Writes the log in chunks and returns its counts."""
    progress = Progress(recording.bytes_total)
    rows = hits = 0
    start = time.monotonic()
    info, chunks = beams_of(recording, options)
    if options.max_range:
        info.max_range_m = options.max_range
    measured = not options.max_range and not info.sensor  # Nobody has said how far the sensor reaches.
    with LogWriter(options.output, info, provenance, limits_from_data=measured) as writer:
        for chunk in chunks:
            writer.write(chunk)
            rows += len(chunk)
            hits += int((chunk.range_m < float("inf")).sum())
            progress(recording.bytes_done, rows)
        if rows == 0:
            raise FormatError(options.file, "", nothing_in(recording, options.clock))
    progress.close()
    seconds = time.monotonic() - start
    return {"rows": rows, "hits": hits, "misses": rows - hits, "skipped": dict(recording.skipped), "seconds": seconds,
            "points_per_s": rows / max(seconds, 1e-9), "notes": getattr(recording, "notes", list)()}


def nothing_in(recording: Recording, clock: str) -> str:
    """Why a recording gives no beams."""
    if not recording.skipped:
        return "no points in it"
    text = "no usable beams in it: " + ", ".join(f"{n} {why}" for why, n in recording.skipped.items())
    if clock == "stamp" and hasattr(recording, "clock") and "--clock" not in text:
        text += "; --clock bag takes the times at which they were recorded"
    return text


def report(options: argparse.Namespace, counts: dict[str, object], say: Callable[[str], None]) -> None:
    """Prints the counts, and writes them as JSON if asked to."""
    if options.json == "-":
        say(json.dumps(counts))
        return
    if options.json:
        pathlib.Path(options.json).write_text(json.dumps(counts) + "\n", encoding="utf-8")
    say(f"{counts['rows']} rows: {counts['hits']} hits, {counts['misses']} misses")
    skipped = counts["skipped"]
    if isinstance(skipped, (dict, collections.Counter)):
        for why, n in skipped.items():
            say(f"  skipped     {n} records: {why}")
    for note in counts["notes"] if isinstance(counts["notes"], list) else ():
        say(f"  note: {note}")
    say(f"  log         {options.output}")


def run(words: Sequence[str]) -> int:
    """Runs `underbrush import WORDS` and returns the exit code: 0, 2 wrong usage, 3 bad input, 4 failure."""
    options = parser().parse_args(words)
    try:
        outputs = {"--output": options.output, "--json": options.json if options.json != "-" else None}
        check_outputs([(name, path) for name, path in outputs.items() if path],
                      [path for path in (options.file, options.metadata) if path], options.force)
        set_threads(options.threads)
        recording = opened(options)
        if not options.output:
            print("\n".join(recording.found()))
            return 0
        provenance = json.dumps({"program": f"underbrush {version()}", "command": ["underbrush", "import", *words],
                                 "seed": 1, "inputs": {}})
        report(options, write(options, recording, provenance), print)
    except FormatError as e:
        return _fail(e, 3)
    except (ValueError, ImportError) as e:
        return _fail(e, 2)
    except OSError as e:
        return _fail(e, 4)
    return 0


def _fail(error: Exception, code: int) -> int:
    print(f"underbrush: {' '.join(str(error).split())}", file=sys.stderr)
    return code
