"""LAS, LAZ and COPC files."""
from __future__ import annotations

import collections
import contextlib
import logging
import pathlib
from collections.abc import Iterator
from typing import Any

import numpy as np
import numpy.typing as npt

from ..errors import FormatError
from ._files import Array, PathLike, guarded, need, with_thousands
from .laz_check import LasFacts, check_las
from .las_units import UNITS, Units, units_of_keys, units_of_wkt
from .layouts import ranks, take_rows
from .scans import Scan, Survey

NS_PER_M = 2 / 0.299792458  # Of a pulse's way there and back.
_CHUNK_BYTES = 32 << 20  # Points of a scan, as the file stores them.
_WITHHELD = 4
_LACKING = "returns that the file lacks, of pulses with several"
_UNKNOWN_PULSE = "returns whose pulse is not known, because pulses share their gps_time: each is a beam of its own"
_NO_ORDER = "returns whose pulse is not known, because there is no gps_time: each is a beam of its own"
_DETERMINED = 0.9  # Share of whole pulses among the returns of pulses that share a time, if their order is right.
_DEGREES = ("its coordinates are longitude and latitude in degrees: project them to m first, such as with PDAL's "
            "filters.reprojection")
_FINEST_M = 1e-5  # Scales of coordinates in m are coarser.
_NOISE = (7, 18)  # Low points and high noise.
_OWN = ("X", "Y", "Z", "intensity", "bit_fields", "raw_classification", "classification", "classification_flags",
        "scan_angle_rank", "scan_angle", "user_data", "point_source_id", "gps_time")


class LasRecording(Survey):
    """A LAS, LAZ or COPC file. A scan is a piece of `chunk` points (as many as 32 MiB hold), in the file's order.

    `xyz` are the file's coordinates. Returns of a pulse (equal times, rising return numbers) are joined to a beam and
    numbered anew if some are not in the file; these are counted. Pulses without a return are not in such files.
    HELIOS++'s amplitude, where it is there, is the intensity, and its echo width (ns) becomes `pulse_width` (m).
    """

    def __init__(self, path: PathLike, *, chunk: int | None = None, unit: str = "") -> None:
        self.path = pathlib.Path(path)
        self.skipped: collections.Counter[str] = collections.Counter()
        self.bytes_total, self.bytes_done = self.path.stat().st_size, 0
        self._laspy = need("laspy")
        logging.getLogger("laspy").addHandler(logging.NullHandler())
        with self.path.open("rb") as file:
            self._facts = check_las(path, file, self.bytes_total)
            file.seek(0)
            with guarded(path, "header"):
                header = self._laspy.LasHeader.read_from(file)
                self._chunk = chunk or max(1, _CHUNK_BYTES // header.point_format.size)
                self.crs = _crs(header, self._facts)
                self._units = Units(UNITS[unit], UNITS[unit]) if unit else _units(header, self.crs)
                self.unit_m = (self._units.flat_m, self._units.flat_m, self._units.up_m)
                # The labels that the package writes are no classes of LAS.
                self._has_noise = not str(header.generating_software).startswith("Underbrush")
                self.has_time = "gps_time" in header.point_format.dimension_names
                self._describe(header)

    def _describe(self, header: Any) -> None:
        low, high = np.asarray(header.mins), np.asarray(header.maxs)
        digits = 7 if self._units.degrees else 2
        copc = any(v.user_id == "copc" for v in header.vlrs)
        kind = "COPC" if copc else "LAZ" if self._facts.compressed else "LAS"
        returns = [int(n) for n in header.number_of_points_by_return]
        self._found = [
            f"{kind} {header.version}, point format {header.point_format.id}, "
            f"{with_thousands(self._facts.points)} points, {self.bytes_total / 1e6:.1f} MB",
            "bounds " + " ".join(f"{a}..{b}" for a, b in zip(low.round(digits).tolist(), high.round(digits).tolist())) + " "
            + self._units.names(),
            "returns " + ", ".join(f"{n} {with_thousands(c)}" for n, c in enumerate(returns, 1) if c)]
        extra = list(header.point_format.extra_dimension_names)
        if extra:
            self._found.append("extra columns " + ", ".join(extra))
        clock = "standard GPS time (1 January 1980 + 10^9 s)" if header.global_encoding.gps_time_type else "week time"
        self._found.append(f"times: {clock}" if self.has_time else "no times (gps_time)")
        self._found.append(f"CRS {self.crs}" if self.crs else "no CRS")

    def _time_span(self) -> str:
        """Times of the first and the last point; empty where they cannot be read."""
        if not self.has_time or not self._facts.points:
            return ""
        with contextlib.suppress(FormatError), self._reader() as reader, guarded(self.path, "points"):
            first = float(reader.read_points(1).array["gps_time"][0])
            reader.seek(self._facts.points - 1)
            last = float(reader.read_points(1).array["gps_time"][0])
            return f"first point at {first:.6f} s, last at {last:.6f} s"
        return ""

    def found(self) -> list[str]:
        lines = [*self._found, "no misses in this format"]
        if span := self._time_span():
            lines.insert(-2, span)
        if self._units.degrees:
            lines.append(f"{self.path}: {_DEGREES}")
        elif self.poses is None:
            lines.append(f"{self.path}: the sensor's place is not in it: "
                         + ("import estimates that of an aircraft, or takes --poses FILE (GPS time x y z) or, for a "
                            "tripod, " if self.has_time else "add ") + "--position X,Y,Z")
        return lines

    @contextlib.contextmanager
    def _reader(self) -> Iterator[Any]:
        laspy = self._laspy
        backend = laspy.LazBackend.LazrsParallel if self._facts.parallel else laspy.LazBackend.Lazrs
        with self.path.open("rb") as file:
            with guarded(self.path, "header"):
                reader = laspy.LasReader(file, closefd=False, laz_backend=backend, read_evlrs=False)
            yield reader

    def notes(self) -> list[str]:
        """Notes on the beams for the user."""
        return [*super().notes(), *([self._units.note()] if self._units.note() else [])]

    def scans(self) -> Iterator[Scan]:
        if self._units.degrees:
            raise FormatError(self.path, "header", _DEGREES)
        self.bytes_done = read = number = 0
        rest: Any = None
        with self._reader() as reader:
            while read < self._facts.points:
                wanted = min(self._chunk, self._facts.points - read)
                with guarded(self.path, f"point {read}"):
                    points = reader.read_points(wanted)
                    if len(points) < wanted:
                        raise FormatError(self.path, f"point {read + len(points)}", "truncated")
                read += wanted
                self.bytes_done = self.bytes_total * read // self._facts.points
                if rest is not None and len(rest):
                    points.array = np.concatenate([rest, points.array])
                last = read >= self._facts.points
                end = len(points.array) if last else self._end_of_beams(points.array)
                rest = points.array[end:].copy()
                points.array = points.array[:end]
                with guarded(self.path, f"point {read}"):
                    scan = self._scan(points, number)
                if len(scan):
                    yield scan
                    number += 1

    def _end_of_beams(self, raw: Any) -> int:
        """The row where the last beam begins, whose returns may go on in the next piece."""
        if self.has_time:
            other = np.flatnonzero(raw["gps_time"] != raw["gps_time"][-1])
            return int(other[-1]) + 1 if len(other) else len(raw)
        return int(np.flatnonzero(_beams(raw, False))[-1]) or len(raw)

    def _scan(self, points: Any, number: int) -> Scan:
        raw = points.array
        order, shared = _order(raw) if self.has_time else (None, np.ones(len(raw), bool))
        if order is not None:
            raw = points.array = raw[order]
        xyz = np.empty((len(raw), 3))
        with np.errstate(over="ignore", invalid="ignore"):
            for axis, name in enumerate("XYZ"):
                xyz[:, axis] = raw[name] * points.scales[axis] + points.offsets[axis]
                if self.unit_m[axis] != 1:
                    xyz[:, axis] *= self.unit_m[axis]
        scan = Scan(number, 0.0, xyz=xyz, intensity=raw["intensity"].astype(np.float32))
        if self.has_time:
            scan.beam_time_s = np.ascontiguousarray(raw["gps_time"])
        modern = "classification_flags" in raw.dtype.names
        if modern:
            flags, kind = raw["classification_flags"], raw["classification"]
            scan.ring = ((flags >> 4) & 3).astype(np.uint16)
            scan.extra["scan_angle"] = raw["scan_angle"] * np.float32(0.006)
        else:
            flags, kind = (raw["raw_classification"] >> 5) | (raw["bit_fields"] & 0xC0), raw["raw_classification"] & 31
            scan.extra["scan_angle"] = raw["scan_angle_rank"].astype(np.float32)
        scan.extra.update({"class": kind.copy(), "las_flags": flags & 0xCF, "user_data": raw["user_data"].copy(),
                           "point_source_id": raw["point_source_id"].copy()})
        for name in points.point_format.dimension_names:
            if name in raw.dtype.names and name not in _OWN:
                _add_extra(scan.extra, name, np.asarray(points[name]))
        if "ring" in scan.extra:
            scan.ring = np.asarray(scan.extra.pop("ring")).astype(np.uint16)
        if "heliosAmplitude" in scan.extra:
            scan.intensity = np.asarray(scan.extra.pop("heliosAmplitude")).astype(np.float32)
        begins = _beams(raw, self.has_time)
        if shared is not None and not _are_determined(raw, begins, shared):
            unknown = shared & (_returns(raw)[1] > 1)
            self.skipped[_UNKNOWN_PULSE if self.has_time else _NO_ORDER] += int(np.count_nonzero(unknown))
            begins |= shared
        else:
            shared = None
        self._number(scan, raw, begins, shared)
        return self._without_bad(scan)

    def _number(self, scan: Scan, raw: Any, begins: npt.NDArray[np.bool_],
                unknown: npt.NDArray[np.bool_] | None) -> None:
        """Numbers the returns of each beam and counts those that the file lacks, but for returns of unknown pulses."""
        scan.echo, scan.echoes = ranks(begins)
        first = begins if unknown is None else begins & ~unknown
        lacking = int(np.maximum(_returns(raw)[1][first].astype(np.int16) - scan.echoes[first], 0).sum())
        if lacking:
            self.skipped[_LACKING] += lacking
        if scan.beam_time_s is not None and len(scan.beam_time_s):
            scan.time_s = float(scan.beam_time_s[0])

    @np.errstate(over="ignore", invalid="ignore")
    def _without_bad(self, scan: Scan) -> Scan:
        assert scan.xyz is not None
        withheld = (np.asarray(scan.extra["las_flags"], np.uint8) & _WITHHELD) != 0
        # A sum is finite only if all its terms are, and is made faster than a mask.
        total = float(scan.xyz.sum()) + (0.0 if scan.beam_time_s is None else float(scan.beam_time_s.sum()))
        noise = np.isin(scan.extra["class"], _NOISE) & ~withheld if self._has_noise else np.zeros(len(scan), bool)
        if np.isfinite(total) and not withheld.any() and not noise.any():
            return scan
        lost = np.zeros(len(scan), bool)
        finite = np.isfinite(scan.xyz).all(axis=1)
        if scan.beam_time_s is not None:
            finite &= np.isfinite(scan.beam_time_s)
        for bad, reason in ((~finite, "points whose coordinates or times are not finite"),
                            (finite & withheld, "points flagged as withheld"),
                            (finite & noise, "points of the classes of noise, 7 and 18")):
            if bad.any():
                self.skipped[reason] += int(np.count_nonzero(bad))
                lost |= bad
        if not lost.any():
            return scan
        begins = scan.echo == 1
        group = np.cumsum(begins)[~lost]
        take_rows(scan, np.flatnonzero(~lost))
        if len(group):
            scan.echo, scan.echoes = ranks(np.append(True, np.diff(group) > 0))
        return scan


def _returns(raw: Any) -> tuple[npt.NDArray[np.uint8], npt.NDArray[np.uint8]]:
    """Return number and number of returns as the file gives them."""
    bits = raw["bit_fields"]
    if "classification_flags" in raw.dtype.names:
        return bits & 15, bits >> 4
    return bits & 7, (bits >> 3) & 7


def _order(raw: Any) -> tuple[npt.NDArray[np.int64] | None, npt.NDArray[np.bool_] | None]:
    """Order of time, then of the returns of a pulse; None where the rows stand in it. Then, in that order, the rows whose
    time is that of several pulses; None where there are none.

    Rows of equal time are one pulse's if no return number (of a scanner's channel) occurs twice among them; if one
    does, the pulses can be distinguished only by the file's order, which is kept.
    """
    time, number = raw["gps_time"], _returns(raw)[0].astype(np.int16)
    if "classification_flags" in raw.dtype.names:
        number += (raw["classification_flags"] & 0x30).astype(np.int16)
    same = time[1:] == time[:-1]
    if np.all(time[1:] >= time[:-1]) and not np.any(same & (np.diff(number) < 0)):
        twice = np.append(False, same & (np.diff(number) == 0))
        if not twice.any():
            return None, None
        group = np.cumsum(np.append(True, ~same))
        return None, np.isin(group, group[twice])
    order = np.lexsort((number, time))
    same = np.append(False, np.diff(time[order]) == 0)
    group = np.cumsum(~same)
    twice = np.append(False, np.diff(number[order]) == 0) & same
    unclear = np.isin(group, group[twice]) if twice.any() else None
    if unclear is not None:
        key = np.empty_like(number)
        key[order] = np.where(unclear, 0, number[order])
        order = np.lexsort((key, time))
    return order, unclear


def _are_determined(raw: Any, begins: npt.NDArray[np.bool_], shared: npt.NDArray[np.bool_]) -> bool:
    """Whether the order of the rows determines the pulses that share a time: nearly all of those with several returns
    are whole, and not more of them are if the last return comes first."""
    number, count = _returns(raw)
    several = shared & (count > 1)
    if not several.any():
        return True
    falling = np.append(True, (number[1:] >= number[:-1]) | (count[1:] != count[:-1]))
    if "gps_time" in raw.dtype.names:
        falling[1:] |= raw["gps_time"][1:] != raw["gps_time"][:-1]

    def whole(starts: npt.NDArray[np.bool_], first: npt.NDArray[np.uint8]) -> int:
        beam = np.cumsum(starts) - 1
        return int(np.count_nonzero(several & (np.bincount(beam)[beam] == count) & (number == first)[starts][beam]))

    return whole(begins, np.ones_like(number)) >= max(whole(falling, count), _DETERMINED * np.count_nonzero(several))


def _beams(raw: Any, timed: bool) -> npt.NDArray[np.bool_]:
    """Whether each row begins a beam: another time or number of returns, or a return number that does not rise."""
    number, count = _returns(raw)
    begins = np.ones(len(raw), bool)
    begins[1:] = (number[1:] <= number[:-1]) | (count[1:] != count[:-1])
    if timed:
        begins[1:] |= raw["gps_time"][1:] != raw["gps_time"][:-1]
    return begins


def _add_extra(extra: dict[str, Array], name: str, column: Array) -> None:
    """Adds a column; one of several elements becomes several. HELIOS++'s width of the echo, ns, becomes m."""
    if column.ndim == 2:
        for k in range(column.shape[1]):
            extra[f"{name}_{k}"] = np.ascontiguousarray(column[:, k])
    elif name == "echo_width":
        extra["pulse_width"] = (column / NS_PER_M).astype(np.float32)
    else:
        extra[name] = np.ascontiguousarray(column)


def _units(header: Any, crs: str) -> Units:
    """The units of the coordinates: those of the CRS, else m. Only degrees need scales that are so much finer in x and y
    than in z, or lie so close together for their heights."""
    found = units_of_wkt(crs) if "[" in crs else None
    keys = next((v.geo_keys for v in header.vlrs if type(v).__name__ == "GeoKeyDirectoryVlr"), None)
    if found is None and keys is not None:
        texts: dict[str, Any] = {type(v).__name__: v for v in header.vlrs}
        numbers = list(getattr(texts.get("GeoDoubleParamsVlr"), "doubles", []))
        doubles = {k.id: float(numbers[k.value_offset]) for k in keys
                   if k.tiff_tag_location == 34736 and k.value_offset < len(numbers)}
        found = units_of_keys({k.id: k.value_offset for k in keys if k.tiff_tag_location == 0}, doubles,
                              "|".join(getattr(texts.get("GeoAsciiParamsVlr"), "strings", [])))
    if found is None and not crs:
        scales, ends = np.asarray(header.scales), np.abs([header.mins, header.maxs]).max(axis=0)
        fine = max(scales[:2]) <= _FINEST_M and scales[2] >= 100 * max(scales[:2])
        size = np.asarray(header.maxs) - np.asarray(header.mins)
        close = max(scales[:2]) <= _FINEST_M and 0 < max(size[:2]) < min(0.5, size[2] / 20)
        if (fine or close) and ends[0] <= 360 and ends[1] <= 90:
            return Units(degrees=True)
    return found or Units()


def _crs(header: Any, facts: LasFacts) -> str:
    """WKT, or EPSG:N (two joined by + with a vertical system) from GeoTIFF keys; empty where there is neither."""
    if facts.crs_record:
        return facts.crs_record.decode("utf-8", "replace")
    texts: dict[str, Any] = {type(v).__name__: v for v in header.vlrs}
    wkt = texts.get("WktCoordinateSystemVlr")
    if wkt is not None and wkt.string.strip("\0 "):
        return str(wkt.string.strip("\0 "))
    keys = texts.get("GeoKeyDirectoryVlr")
    if keys is None:
        return ""
    values = {k.id: k.value_offset for k in keys.geo_keys if k.tiff_tag_location == 0}
    codes = [values[k] for k in (3072, 2048) if 1024 <= values.get(k, 0) < 32767][:1]
    codes += [values[4096]] if 1024 <= values.get(4096, 0) < 32767 else []
    if codes:
        return "EPSG:" + "+".join(str(code) for code in codes)
    ascii_keys = texts.get("GeoAsciiParamsVlr")
    return "|".join(ascii_keys.strings).strip("|\0 ") if ascii_keys is not None else ""
