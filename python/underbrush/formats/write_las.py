"""Writes LAS and LAZ files with the fields of HELIOS++."""
from __future__ import annotations

import collections
import contextlib
import pathlib
from collections.abc import Mapping, Sequence
from types import TracebackType
from typing import Any

import numpy as np
import numpy.typing as npt

from ._files import Array, PathLike, need, written_whole
from .las import NS_PER_M

#: Columns of a log with a field of their own in LAS; others become extra dimensions of their names.
_OWN = ("origin", "direction", "range_m", "intensity", "time_s", "packet", "flags", "echo", "echoes", "pulse_width",
        "class", "instance", "element", "point_source_id", "user_data", "las_flags", "scan_angle",
        "fullwaveIndex", "hitObjectId", "heliosAmplitude")
_EXTRA_TYPES = "biuf"


class LasWriter:
    """Writes a log of beams as LAS 1.4 (point format 6), compressed where the name ends in `.laz`.

    Use it in a `with`; the file appears at its end, whole. HELIOS++'s extra dimensions are there: `echo_width` (ns),
    `fullwaveIndex` (number of the beam in the log, misses counted), `hitObjectId` (the columns `hitObjectId`,
    `instance` or `element`, whichever comes first) and `heliosAmplitude` (the intensity); `ring`, `scan` and the log's
    further columns follow. `intensity` is ×65535 where the first chunk's are all ≤ 1. `lost` counts what LAS cannot
    hold, misses above all; `written` counts points.
    """

    def __init__(self, path: PathLike, *, crs: str = "", resolution_m: float = 1e-4,
                 element_classes: Sequence[str] = ()) -> None:
        self.path, self._crs, self._resolution = pathlib.Path(path), crs, resolution_m
        self._codes = np.array([las_code(name) for name in element_classes], np.uint8)
        self.lost: collections.Counter[str] = collections.Counter()
        self.written = 0
        self._laspy = need("laspy")
        self._writer: Any = None
        self._beams = 0
        self._exit = contextlib.ExitStack()

    def __enter__(self) -> LasWriter:
        self._temporary = self._exit.enter_context(written_whole(self.path))
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None,
                 trace: TracebackType | None) -> None:
        try:
            if kind is None and self._writer is None:
                self._open({})
        finally:
            if self._writer is not None:
                self._writer.close()
            self._exit.__exit__(kind, error, trace)

    def write(self, columns: Mapping[str, Array]) -> None:
        """Appends beams, in columns as `place` names them."""
        range_m = np.asarray(columns["range_m"], np.float64)
        n = len(range_m)
        echo = np.asarray(columns["echo"]) if "echo" in columns else np.where(np.isfinite(range_m), 1, 0)
        beam = np.cumsum(echo <= 1) - 1 + self._beams
        self._beams += int(np.count_nonzero(echo <= 1))
        hit = np.isfinite(range_m)
        if n - np.count_nonzero(hit):
            self.lost["misses"] += int(n - np.count_nonzero(hit))
        kept = {name: np.asarray(column)[hit] for name, column in columns.items()}
        if not hit.any():
            return
        if self._writer is None:
            self._open(kept)
        xyz = kept["origin"] + kept["range_m"].astype(np.float64)[:, None] * _unit(kept["direction"])
        near = np.all(np.abs(xyz - self._header.offsets) < 2**31 * self._resolution, axis=1)
        if not near.all():
            self.lost["points too far from the first for LAS"] += int(np.count_nonzero(~near))
            kept, xyz, beam_hit = {k: v[near] for k, v in kept.items()}, xyz[near], beam[hit][near]
        else:
            beam_hit = beam[hit]
        self._write_points(kept, xyz, beam_hit, echo[hit][near])

    def _write_points(self, kept: Mapping[str, Array], xyz: npt.NDArray[np.float64], beam: Array, echo: Array) -> None:
        n = len(xyz)
        points = self._laspy.ScaleAwarePointRecord.zeros(n, header=self._header)
        for axis, name in enumerate("XYZ"):
            points[name] = np.rint((xyz[:, axis] - self._header.offsets[axis]) / self._resolution)
        points["intensity"] = self._held(kept["intensity"] * self._gain, np.uint16, "intensity")
        points["gps_time"] = kept["time_s"]
        points["return_number"] = self._held(echo, np.uint8, "return number", 15)
        points["number_of_returns"] = self._held(kept.get("echoes", echo), np.uint8, "number of returns", 15)
        for name, column, dtype in (("classification", "class", np.uint8), ("user_data", "user_data", np.uint8),
                                    ("point_source_id", "point_source_id", np.uint16)):
            if column in kept:
                points[name] = self._held(kept[column], dtype, column)
        if "class" not in kept and "element_class" in kept and len(self._codes):
            number = kept["element_class"].astype(np.int64)
            points["classification"] = np.where(number < len(self._codes),
                                                self._codes[np.minimum(number, len(self._codes) - 1)], 1)
        if "scan_angle" in kept:
            points["scan_angle"] = self._held(kept["scan_angle"] / 0.006, np.int16, "scan angle")
        if "las_flags" in kept:
            points.array["classification_flags"] = kept["las_flags"].astype(np.uint8) & 0xCF
        objects = next((kept[name] for name in ("hitObjectId", "instance", "element") if name in kept), np.zeros(n))
        points["hitObjectId"] = self._held(objects, np.int32, "object")
        points["fullwaveIndex"] = self._held(kept.get("fullwaveIndex", beam), np.int32, "fullwaveIndex")
        points["heliosAmplitude"] = np.asarray(kept["intensity"], np.float64)
        points["echo_width"] = np.asarray(kept.get("pulse_width", np.zeros(n)), np.float64) * NS_PER_M
        for name in self._extra:
            points[name] = kept[name]
        self._writer.write_points(points)
        self.written += n

    def _held(self, values: Array, dtype: Any, name: str, largest: int | None = None) -> Array:
        top = np.iinfo(dtype).max if largest is None else largest
        whole = np.rint(np.asarray(values, np.float64))
        clamped = int(np.count_nonzero((whole > top) | (whole < np.iinfo(dtype).min)))
        if clamped:
            self.lost[f"values of {name} beyond {top} (clamped)"] += clamped
        return np.clip(whole, np.iinfo(dtype).min, top).astype(dtype)

    def _open(self, first: Mapping[str, Array]) -> None:
        laspy = self._laspy
        header = laspy.LasHeader(point_format=6, version="1.4")
        header.generating_software = "Underbrush"
        header.system_identifier = "Underbrush"
        header.scales = np.full(3, self._resolution)
        if first:
            header.offsets = np.floor(first["origin"][0])
        extra = {"echo_width": "f8", "fullwaveIndex": "i4", "hitObjectId": "i4", "heliosAmplitude": "f8"}
        self._extra = [name for name, column in first.items() if name not in _OWN and column.ndim == 1
                       and column.dtype.kind in _EXTRA_TYPES and column.dtype != bool]
        extra.update((name, first[name].dtype.str[1:]) for name in self._extra)
        header.add_extra_dims([laspy.ExtraBytesParams(name=name[:32], type=np.dtype(kind))
                               for name, kind in extra.items()])
        if self._crs:
            self._add_crs(header)
        intensity = first.get("intensity", np.zeros(0))
        self._gain = 65535.0 if len(intensity) and intensity.max() <= 1 else 1.0
        self._header = header
        self._writer = laspy.open(self._temporary, mode="w", header=header,
                                  do_compress=self.path.suffix.lower() == ".laz")

    def _add_crs(self, header: Any) -> None:
        """Writes the CRS as the log has it: WKT as a record of its own, EPSG:N as GeoTIFF keys."""
        known = need("laspy.vlrs.known")
        if self._crs.startswith("EPSG:"):
            codes = [int(code) for code in self._crs[5:].split("+") if code.isdigit() and int(code) < 1 << 16]
            if codes:
                geographic = 4000 <= codes[0] < 5000
                keys = [(1024, 2 if geographic else 1), (2048 if geographic else 3072, codes[0])]
                keys += [(4096, code) for code in codes[1:2]]
                words = [1, 1, 0, len(keys), *(word for key, code in keys for word in (key, 0, 1, code))]
                vlr = known.GeoKeyDirectoryVlr()
                vlr.parse_record_data(np.array(words, "<u2").tobytes())
                header.vlrs.append(vlr)
        else:
            header.vlrs.append(known.WktCoordinateSystemVlr(self._crs))
            header.global_encoding.wkt = True


def las_code(name: str) -> int:
    """The class of LAS 1.4 for one of Underbrush's: N for las_N, 2 for ground, 3 to 5 for grass and plants by their
    height, and 1 (unclassified) for others."""
    if name.startswith("las_") and name[4:].isdigit():
        return min(int(name[4:]), 255)
    if name == "ground":
        return 2
    if name == "grass" or name.startswith(("low_shrub", "small_shrub")):
        return 3
    if name.startswith(("medium_shrub", "large_shrub")):
        return 4
    return 5 if name.endswith("_tree") or name == "leaf" else 1


def _unit(direction: Array) -> npt.NDArray[np.float64]:
    d = np.asarray(direction, np.float64)
    return np.asarray(d / np.linalg.norm(d, axis=1, keepdims=True))
