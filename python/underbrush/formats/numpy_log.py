"""Logs as NumPy archives (`.npz`): a column an array, misses kept, written and read in pieces."""
from __future__ import annotations

import collections
import contextlib
import pathlib
import shutil
import tempfile
import zipfile
from collections.abc import Iterator, Mapping
from types import TracebackType
from typing import IO, Any

import numpy as np

from ..errors import FormatError
from ._files import Array, PathLike, guarded, with_thousands, written_whole
from .scans import Poses, Scan

_NEEDED = {"origin": 2, "direction": 2, "range_m": 1, "time_s": 1}
_CHUNK = 1 << 18  # Rows a scan at most.
_OWN = ("origin", "direction", "range_m", "intensity", "time_s", "ring", "scan", "packet", "flags", "echo", "echoes")


class NumpyLogWriter:
    """Writes a log of beams as an uncompressed `.npz` with an array a column, as `place` names them: all of a
    log.

    Use it in a `with`; the file appears at its end, whole. Columns are kept in files of their own meanwhile, so that a
    log needs no memory. All pieces have the same columns (`ValueError`).
    """

    def __init__(self, path: PathLike) -> None:
        self.path = pathlib.Path(path)
        self.lost: collections.Counter[str] = collections.Counter()
        self.written = 0
        self._files: dict[str, IO[bytes]] = {}
        self._kinds: dict[str, tuple[np.dtype[Any], tuple[int, ...]]] = {}
        self._exit = contextlib.ExitStack()

    def __enter__(self) -> NumpyLogWriter:
        self._temporary = self._exit.enter_context(written_whole(self.path))
        self._exit.enter_context(self._closing())
        return self

    @contextlib.contextmanager
    def _closing(self) -> Iterator[None]:
        try:
            yield
        finally:
            for file in self._files.values():
                file.close()

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None,
                 trace: TracebackType | None) -> None:
        try:
            if kind is None:
                self._pack()
        except BaseException as later:
            self._exit.__exit__(type(later), later, later.__traceback__)
            raise
        self._exit.__exit__(kind, error, trace)

    def write(self, columns: Mapping[str, Array]) -> None:
        """Appends beams."""
        kinds = {name: (np.asarray(c).dtype.newbyteorder("<"), np.asarray(c).shape[1:]) for name, c in columns.items()}
        if not self._kinds:
            self._kinds = kinds
            self._files = {name: tempfile.TemporaryFile(dir=self._temporary.parent) for name in kinds}
        if kinds != self._kinds:
            raise ValueError(f"other columns than before: {', '.join(sorted(kinds))}")
        for name, column in columns.items():
            self._files[name].write(np.ascontiguousarray(column, kinds[name][0]).data)
        self.written += len(columns["range_m"])

    def _pack(self) -> None:
        with zipfile.ZipFile(self._temporary, "w", zipfile.ZIP_STORED, allowZip64=True) as archive:
            for name, (dtype, tail) in self._kinds.items():
                file = self._files[name]
                file.seek(0)
                with archive.open(name + ".npy", "w", force_zip64=True) as out:
                    np.lib.format.write_array_header_2_0(out, {
                        "descr": np.lib.format.dtype_to_descr(dtype), "fortran_order": False,
                        "shape": (self.written, *tail)})
                    shutil.copyfileobj(file, out, 1 << 20)


class NumpyRecording:
    """A log in a `.npz` file, as `NumpyLogWriter` writes it: beams in the world frame."""

    sensor = ""
    crs = ""
    world = True

    def __init__(self, path: PathLike) -> None:
        self.path = pathlib.Path(path)
        self.poses: Poses | None = None
        self.skipped: collections.Counter[str] = collections.Counter()
        self.bytes_total, self.bytes_done = self.path.stat().st_size, 0
        self.organised = True
        with guarded(path, "zip"), zipfile.ZipFile(self.path) as archive:
            self._kinds = {info.filename[:-4]: self._kind(archive, info) for info in archive.infolist()
                           if info.filename.endswith(".npy")}
        for name, dimensions in _NEEDED.items():
            if name not in self._kinds:
                raise FormatError(path, "", f"no column '{name}': is no log")
            if len(self._kinds[name][1]) != dimensions or self._kinds[name][1][1:] not in ((), (3,)):
                raise FormatError(path, name, f"has the shape {self._kinds[name][1]}")
        self._rows = self._kinds["range_m"][1][0]
        for name, (_, shape) in self._kinds.items():
            if not shape or shape[0] != self._rows:
                raise FormatError(path, name, f"has the shape {shape} in a log of {self._rows} beams")

    @staticmethod
    def _header(file: IO[bytes]) -> tuple[tuple[int, ...], bool, np.dtype[Any]]:
        version = np.lib.format.read_magic(file)
        read = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
        return read(file)

    def _kind(self, archive: zipfile.ZipFile, info: zipfile.ZipInfo) -> tuple[np.dtype[Any], tuple[int, ...]]:
        if info.compress_type != zipfile.ZIP_STORED and info.file_size > 1000 * max(1, info.compress_size):
            raise ValueError("a column that is compressed more than a thousandfold")
        with archive.open(info) as file:
            shape, fortran, dtype = self._header(file)
        if dtype.kind not in "iuf" or (fortran and len(shape) > 1) or min(shape, default=0) < 0:
            raise ValueError(f"column {info.filename} is no row-major array of numbers")
        if int(np.prod([int(n) for n in shape], dtype=object)) * dtype.itemsize > info.file_size:
            raise ValueError(f"column {info.filename} states {shape[0]} rows: truncated")
        return dtype, shape

    def found(self) -> list[str]:
        return [f"NumPy log, {with_thousands(self._rows)} rows, {self.bytes_total / 1e6:.1f} MB",
                "columns " + ", ".join(self._kinds)]

    def scans(self) -> Iterator[Scan]:
        """Yields beams in pieces of equal `scan`, at most 2¹⁸ rows each."""
        self.bytes_done = 0
        with contextlib.ExitStack() as stack:
            with guarded(self.path, "zip"):
                archive = stack.enter_context(zipfile.ZipFile(self.path))
                files = {name: stack.enter_context(archive.open(name + ".npy")) for name in self._kinds}
                for file in files.values():
                    self._header(file)
            for begin in range(0, self._rows, _CHUNK):
                count = min(_CHUNK, self._rows - begin)
                with guarded(self.path, f"row {begin}"):
                    columns = {name: self._read(files[name], name, count) for name in files}
                self.bytes_done = self.bytes_total * (begin + count) // self._rows
                yield from self._split(columns)

    def _read(self, file: IO[bytes], name: str, count: int) -> Array:
        dtype, shape = self._kinds[name]
        tail = shape[1:]
        wanted = count * dtype.itemsize * int(np.prod(tail))
        data = file.read(wanted)
        if len(data) != wanted:
            raise ValueError("truncated")
        return np.frombuffer(data, dtype).reshape(count, *tail)

    @staticmethod
    def _split(columns: dict[str, Array]) -> Iterator[Scan]:
        n = len(columns["range_m"])
        numbers = columns.get("scan", np.zeros(n, np.uint32)).astype(np.int64)
        starts = np.flatnonzero(np.append(True, np.diff(numbers) != 0))
        for begin, end in zip(starts, [*starts[1:], n]):
            c = {name: column[begin:end] for name, column in columns.items()}
            yield Scan(
                int(numbers[begin]), float(c["time_s"][0]), direction=c["direction"].astype(np.float64),
                range_m=c["range_m"].astype(np.float32), origin=c["origin"].astype(np.float64),
                beam_time_s=c["time_s"].astype(np.float64),
                intensity=c["intensity"].astype(np.float32) if "intensity" in c else None,
                ring=c["ring"].astype(np.uint16) if "ring" in c else None,
                echo=c["echo"].astype(np.uint8) if "echo" in c else None,
                echoes=c["echoes"].astype(np.uint8) if "echoes" in c else None,
                extra={name: column for name, column in c.items() if name not in _OWN and column.ndim == 1})
