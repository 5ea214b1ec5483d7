"""Misses that a recording's point clouds lack, inferred from the scan pattern of a sensor, as `import` infers them."""
from __future__ import annotations

import collections
import importlib
import pathlib
import tempfile
from typing import Any

import numpy as np
import numpy.typing as npt

from ..errors import FormatError
from ._files import Array, PathLike
from .layouts import take_rows
from .scans import Scan, far_from_sensor

INFERRED = 1  #: The bit of `flags` of an inferred miss.
_EPOCH_S = 100_000_000  # Time of each scan's beginning in the library, s: its file is named so.
_UNFIT = "scans without inferred misses, which the named sensor cannot have made"
_KEPT = ("xyz", "direction", "range_m", "origin", "beam_time_s", "intensity", "ring", "echo", "echoes")


class MissInference:
    """Adds to the scans of a recording the misses that a spinning sensor must have had between their returns.

    The rule is the library's (`insert_misses`), which reads each scan from a file of its own in a private folder. A
    revolution takes the mean of those times between scans, which begin at `times_s`, that are within 15 % of the
    sensor's own; without such it takes that. An organised scan with misses of its own is left as it is. Raises
    `FormatError` where the first scan cannot be of the sensor, `ValueError` where it does not spin.
    """

    def __init__(self, path: PathLike, sensor: str, times_s: npt.NDArray[np.float64],
                 unknown_below_deg: float | None = None) -> None:
        library: Any = importlib.import_module("underbrush")
        known = library.Sensor(sensor)
        if known.kind != "spinning":
            raise ValueError(f"import: '{sensor}': --infer-misses needs a spinning sensor")
        self.sensor = sensor
        self.inferred = self.unknown = 0  #: Misses added, and beams left out because nothing is known of them.
        self._import, self._path, self._scans = library.import_log, pathlib.Path(path), 0
        self._options: dict[str, Any] = {"infer_misses": sensor}
        if unknown_below_deg is not None:
            self._options["unknown_below_deg"] = unknown_below_deg
        self._folder = tempfile.TemporaryDirectory(prefix="underbrush-")
        steps, own_s = np.diff(times_s), 1 / known.rate_hz
        steps = steps[np.abs(steps - own_s) <= 0.15 * own_s]
        if len(steps):
            poses = pathlib.Path(self._folder.name, "poses.txt")
            poses.write_text("".join(f"{_EPOCH_S + k * steps.mean():.9f} 0 0 0 0 0 0 1\n" for k in (-1, 0, 1)))
            self._options["poses"] = poses

    def added(self, scan: Scan, skipped: collections.Counter[str]) -> Scan:
        """The scan with its misses. What is left out is counted in `skipped`."""
        if scan.xyz is None or not len(scan) or np.isnan(scan.xyz).any() or far_from_sensor(scan.xyz):
            return scan
        first = np.flatnonzero(scan.echo <= 1) if scan.echo is not None else np.arange(len(scan))
        try:
            log, report = self._import(self._file(scan, first), **self._options)
        except FormatError as error:
            if self._scans:
                skipped[_UNFIT] += 1
                return scan
            place, _, reason = str(error).partition("--infer-misses: ")
            raise FormatError(self._path, "--infer-misses", reason or place) from error
        self._scans += 1
        self.inferred += report["misses_inferred"]
        self.unknown += report["unknown"]
        source, miss = log.extra["source"], (log.flags & INFERRED) > 0
        near = np.setdiff1d(np.arange(len(first)), source[~miss], assume_unique=True)
        if len(near):
            skipped["points nearer than the sensor's minimum range"] += len(near)
        # The library determines the rings of scans without ring numbers, or with others than the sensor's channels have.
        ring = np.zeros(len(first), np.uint16)
        ring[source[~miss]] = log.ring[~miss]
        scan.ring = ring[np.searchsorted(first, np.arange(len(scan)), side="right") - 1]
        # A miss follows the return before it, with all of its echoes.
        before = np.maximum.accumulate(np.where(miss, -1, source))[miss]
        place = np.append(first, len(scan))[before + 1] - 0.5
        kept = np.flatnonzero(~np.isin(np.searchsorted(first, np.arange(len(scan)), side="right") - 1, near))
        start_s = float(np.nanmin(scan.beam_time_s)) if scan.beam_time_s is not None else 0.0
        take_rows(scan, kept)
        self._append(scan, np.asarray(log.direction[miss], np.float64), log.ring[miss],
                     log.time_s[miss] - _EPOCH_S + start_s)
        take_rows(scan, np.argsort(np.append(kept, place), kind="stable"))
        return scan

    def _file(self, scan: Scan, rows: Array) -> pathlib.Path:
        """Writes those rows of a scan, with their numbers, for the library."""
        assert scan.xyz is not None
        columns: dict[str, Array] = {name: scan.xyz[rows, axis] for axis, name in enumerate("xyz")}
        if scan.beam_time_s is not None:
            columns["time_s"] = scan.beam_time_s[rows] - np.nanmin(scan.beam_time_s)
        if scan.ring is not None:
            columns["ring"] = scan.ring[rows]
        columns["source"] = np.arange(len(rows), dtype=np.int32)
        table = np.empty(len(rows), [(name, column.dtype) for name, column in columns.items()])
        for name, column in columns.items():
            table[name] = column
        path = pathlib.Path(self._folder.name, f"{_EPOCH_S}_0.npy")
        np.save(path, table)
        return path

    def _append(self, scan: Scan, direction: Array, ring: Array, time_s: Array) -> None:
        """Appends misses; the scan's points become directions and ranges."""
        assert scan.xyz is not None
        hits, n = len(scan), len(direction)
        range_m = np.linalg.norm(scan.xyz, axis=1)
        added = {"direction": direction, "range_m": np.full(n, np.inf), "ring": ring, "beam_time_s": time_s}
        scan.direction, scan.range_m, scan.xyz = scan.xyz / range_m[:, None], range_m.astype(np.float32), None
        for name in _KEPT:
            column = getattr(scan, name)
            if column is not None:
                more = added.get(name, np.zeros((n, *column.shape[1:]), column.dtype))
                setattr(scan, name, np.concatenate([column, more.astype(column.dtype)]))
        scan.extra = {name: np.concatenate([column, np.zeros(n, column.dtype)]) for name, column in scan.extra.items()}
        scan.extra["flags"] = np.repeat(np.array([0, INFERRED], np.uint8), [hits, n])
