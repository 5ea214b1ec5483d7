"""Point clouds that HELIOS++ writes as text (`.xyz`)."""
from __future__ import annotations

import collections
import io
import pathlib
from collections.abc import Iterator
from typing import Any

import numpy as np
import numpy.typing as npt

from ..errors import FormatError
from ._files import Array, PathLike, with_thousands
from .las import NS_PER_M
from .layouts import ranks
from .scans import Scan, Survey

_COLUMNS = 11  # x y z intensity echo_width return_number returns fullwave_index hit_object class gps_time
_BLOCK = 4 << 20  # Bytes of text a scan.
_LONGEST_LINE = 4096


def _numbers(line: str) -> list[float] | None:
    try:
        values = [float(word) for word in line.split()]
    except ValueError:
        return None
    return values if len(values) == _COLUMNS else None


def is_helios_xyz(path: PathLike) -> bool:
    """Whether the first lines are rows of HELIOS++'s 11 columns."""
    with pathlib.Path(path).open("rb") as file:
        head = file.read(_LONGEST_LINE)
    lines = [line for line in head.decode("latin-1").split("\n") if line.strip() and not line.startswith(("#", "//"))]
    return bool(lines) and len(lines[0]) < _LONGEST_LINE and any(_numbers(line) for line in lines[:3])


class HeliosRecording(Survey):
    """A text file of HELIOS++: x y z (m, world), intensity, echo width (ns), return number, number of returns, index of
    the pulse, object, class, GPS time (s).

    A scan is a piece of the file, of whole pulses. Lines that are no such rows are left out and counted.
    """

    crs = ""

    def __init__(self, path: PathLike) -> None:
        self.path = pathlib.Path(path)
        self.skipped: collections.Counter[str] = collections.Counter()
        self.bytes_total, self.bytes_done = self.path.stat().st_size, 0
        with self.path.open("rb") as file:
            head = file.read(1 << 16)
        mean = len(head) / max(1, head.count(b"\n"))
        self._lines = round(self.bytes_total / mean) if mean else 0

    def found(self) -> list[str]:
        lines = [f"HELIOS++ text, about {with_thousands(self._lines)} points, {self.bytes_total / 1e6:.1f} MB",
                 "no misses in this format"]
        if self.poses is None:
            lines.append(f"{self.path}: the sensor's place is not in it: import estimates that of an aircraft, or takes "
                         "--poses FILE (HELIOS++'s trajectory, or GPS time x y z) or, for a tripod, --position X,Y,Z")
        return lines

    def scans(self) -> Iterator[Scan]:
        self.bytes_done = number = 0
        rest = np.empty((0, _COLUMNS))
        with self.path.open("rb") as file:
            for block, last in _blocks(file):
                table = np.concatenate([rest, self._rows(block)])
                self.bytes_done += len(block)
                begins = _begins(table)
                end = len(table) if last else int(np.flatnonzero(begins)[-1]) if len(table) else 0
                table, rest, begins = table[:end], table[end:], begins[:end]
                if len(table):
                    yield self._scan(table, begins, number)
                    number += 1
        if not number:
            raise FormatError(self.path, "", "no row of HELIOS++'s 11 columns")

    def _rows(self, block: bytes) -> npt.NDArray[np.float64]:
        """The rows (n, 11) of a block of whole lines."""
        text = block.decode("latin-1")
        if not text.strip():
            return np.empty((0, _COLUMNS))
        try:
            table = np.loadtxt(io.StringIO(text), ndmin=2)
            if table.shape[1] != _COLUMNS:
                raise ValueError("columns")
        except ValueError:
            lines = [line.partition("#")[0].strip() for line in text.split("\n")]
            found = [_numbers(line) for line in lines if line]
            self.skipped["lines that are no rows of HELIOS++"] += sum(row is None for row in found)
            table = np.array([row for row in found if row is not None]).reshape(-1, _COLUMNS)
        good = np.isfinite(table).all(axis=1)
        if not good.all():
            self.skipped["points whose coordinates or times are not finite"] += int(np.count_nonzero(~good))
        return np.asarray(table[good])

    @staticmethod
    def _scan(table: npt.NDArray[np.float64], begins: npt.NDArray[np.bool_], number: int) -> Scan:
        scan = Scan(number, float(table[0, 10]), xyz=table[:, :3].copy(), beam_time_s=table[:, 10].copy(),
                    intensity=table[:, 3].astype(np.float32))
        scan.echo, scan.echoes = ranks(begins)
        scan.extra = {
            "pulse_width": (table[:, 4] / NS_PER_M).astype(np.float32),
            "fullwaveIndex": _whole(table[:, 7], np.int32), "hitObjectId": _whole(table[:, 8], np.int32),
            "class": _whole(table[:, 9], np.uint8)}
        return scan


def _blocks(file: io.BufferedReader) -> Iterator[tuple[bytes, bool]]:
    """Blocks of whole lines, and whether it is the last. A line that is longer than a block is cut."""
    block = file.read(_BLOCK)
    while following := file.read(_BLOCK):
        end = block.rfind(b"\n") + 1 or len(block)
        yield block[:end], False
        block = block[end:] + following
    yield block, True


def _whole(values: npt.NDArray[np.float64], dtype: Any) -> Array:
    limits = np.iinfo(dtype)
    return np.asarray(np.clip(values, limits.min, limits.max).astype(dtype))


def _begins(table: npt.NDArray[np.float64]) -> npt.NDArray[np.bool_]:
    """Whether each row begins a pulse: another index or time, or a return number that does not rise."""
    begins = np.ones(len(table), bool)
    begins[1:] = (np.diff(table[:, 5]) <= 0) | (np.diff(table[:, 7]) != 0) | (np.diff(table[:, 10]) != 0)
    return begins
