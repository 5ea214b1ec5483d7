"""`underbrush import` of recordings for which the package has readers: bags, LAS and LAZ, packets, E57."""
from __future__ import annotations

import argparse
import collections
import json
import pathlib
import sys
import time
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from underbrush._core import BeamChecks, LogWriter, RangeUnit, Sensor, check_outputs, set_threads, version
from underbrush.errors import FormatError, failed
from underbrush.formats.import_options import parsed

if TYPE_CHECKING:
    from underbrush.formats.scans import Recording


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
    if options.sensor:
        Sensor(options.sensor)  # Names the most similar one where there is none.
    return open_recording(options.file, topic=options.topic or None, poses=options.poses, metadata=options.metadata,
                          sensor=options.sensor or None, frame=options.frame or None, clock=options.clock,
                          unit=options.unit, point_times=options.point_times)


def write(options: argparse.Namespace, recording: Recording, provenance: str) -> dict[str, object]:
    """Writes the log in chunks and returns its counts."""
    from underbrush.formats.infer_misses import INFERRED
    from underbrush.formats.log import beams_of_recording, inference_of
    progress = Progress(recording.bytes_total)
    rows = hits = inferred = 0
    start = time.monotonic()
    if options.unknown_below_deg is not None and not options.infer_misses:
        raise ValueError("import: --unknown-below-deg needs --infer-misses")
    infer = inference_of(recording, options.infer_misses, options.unknown_below_deg) if options.infer_misses else None
    info, chunks = beams_of_recording(recording, position=options.position,
                                      sensor=options.sensor or None, infer=infer, frames=options.frames,
                                      keep=options.keep)
    if options.max_range:
        info.max_range_m = options.max_range
    if options.label_set:
        info.classes = options.label_set
    checks, unit = BeamChecks(), RangeUnit()
    measured = not options.max_range and not info.sensor  # The maximum range of the sensor is not known.
    with LogWriter(options.output, info, provenance, not options.float, measured) as writer:
        for chunk in chunks:
            writer.write(chunk)
            if info.scans:  # A survey has none, and an aircraft's ranges are long.
                checks.add(chunk)
            else:
                unit.add(chunk)
            rows += len(chunk)
            hits += int((chunk.range_m < float("inf")).sum())
            inferred += int((chunk.flags & INFERRED).sum()) if infer else 0
            progress(recording.bytes_done, rows)
        if rows == 0:
            raise FormatError(options.file, "", nothing_in(recording, options.clock))
    progress.close()
    seconds = time.monotonic() - start
    notes = list(getattr(recording, "notes", list)())
    if rows == hits:
        notes.append("the log has no misses: hit probabilities cannot be learnt from it" + (
            f" (see --infer-misses {recording.sensor or 'SENSOR'})" if hasattr(recording, "scan_times") else ""))
    return {"rows": rows, "hits": hits, "misses": rows - hits, "misses_inferred": inferred,
            "unknown": infer.unknown if infer else 0, "skipped": dict(recording.skipped), "seconds": seconds,
            "points_per_s": rows / max(seconds, 1e-9), "notes": notes, "warnings": checks.warnings() + ([unit.warning()] if unit.warning() else [])}


def nothing_in(recording: Recording, clock: str) -> str:
    """Why a recording gives no beams."""
    if not recording.skipped:
        return "no points in it"
    text = "no usable beams in it: " + ", ".join(f"{n} {why}" for why, n in recording.skipped.items())
    if clock == "stamp" and hasattr(recording, "clock") and "--clock" not in text:
        text += "; --clock bag takes the times at which they were recorded"
    return text


def write_json(path: str, values: dict[str, object]) -> None:
    """Writes values to a file, which appears whole, or to a device."""
    from underbrush.formats._files import written_whole
    text = json.dumps({**values, "program": f"underbrush {version()}"}) + "\n"
    if pathlib.Path(path).exists() and not pathlib.Path(path).is_file():
        pathlib.Path(path).write_text(text, encoding="utf-8")
        return
    with written_whole(path) as target:
        target.write_text(text, encoding="utf-8")


def report(options: argparse.Namespace, counts: dict[str, object], say: Callable[[str], None]) -> None:
    """Prints the counts, and writes them as JSON if asked to."""
    warnings = counts["warnings"] if isinstance(counts["warnings"], list) else []
    for warning in warnings:
        print(f"underbrush: warning: {warning}", file=sys.stderr)
    if options.json == "-":
        say(json.dumps(counts))
        return
    if options.json:
        write_json(options.json, counts)
    inferred = f" ({counts['misses_inferred']} of them inferred)" if counts["misses_inferred"] else ""
    say(f"{counts['rows']} rows: {counts['hits']} hits, {counts['misses']} misses{inferred}")
    if counts["unknown"]:
        say(f"  unknown     {counts['unknown']} beams without a known end: left out")
    skipped = counts["skipped"]
    if isinstance(skipped, (dict, collections.Counter)):
        for why, n in ((why, n) for why, n in skipped.items() if n):
            say(f"  skipped     {n} records: {why}")
    for note in counts["notes"] if isinstance(counts["notes"], list) else ():
        say(f"  note: {note}")
    say(f"  log         {options.output}")


def describe(options: argparse.Namespace, recording: Recording) -> None:
    """Prints the contents of a recording, without reading its points."""
    lines = recording.found()
    facts = {"kind": "recording", "sensor": recording.sensor, "has_misses": recording.organised, "crs": recording.crs,
             "world": recording.world, "bytes": recording.bytes_total, "topics": getattr(recording, "topics", []),
             "found": lines}
    if options.json != "-":
        print("\n".join(lines))
    if options.json == "-":
        print(json.dumps(facts))
    elif options.json:
        write_json(options.json, facts)


def run(words: Sequence[str], describe_only: bool = False) -> int:
    """Runs `underbrush import WORDS`, or `info WORDS`, and returns the exit code.

    It is 0, 2 for wrong usage, 3 for bad input, 4 for a failure.
    """
    try:
        options = parsed(words)
        if describe_only and options.output:
            raise ValueError("info writes no log: underbrush import does")
        outputs = {"--output": options.output, "--json": options.json if options.json != "-" else None}
        check_outputs([(name, path) for name, path in outputs.items() if path],
                      [path for path in (options.file, options.metadata, options.config) if path], options.force)
        set_threads(options.threads)
        recording = opened(options)
        if not options.output:
            describe(options, recording)
            return 0
        provenance = json.dumps({"program": f"underbrush {version()}", "command": command_of_result(words),
                                 "seed": options.seed, "inputs": {}})
        report(options, write(options, recording, provenance), print)
    except (ValueError, ImportError, OSError) as e:
        return failed(e)
    return 0


def command_of_result(words: Sequence[str]) -> list[str]:
    """The command without options that do not change its result, so that equal results are equal files."""
    out, left_out = ["underbrush", "import"], False
    for word in words:
        name, equals, _ = word.partition("=")
        if left_out:
            left_out = False
        elif name in ("-o", "--output", "--json", "--threads"):
            left_out = not equals
        elif name != "--force":
            out.append(word)
    return out
