"""Decoder of Ouster's lidar packets with the sensor's metadata (JSON, in its old flat and its new nested form).

Angles, origins and transforms are those of the metadata. Source: the maker's manuals and public SDK.
"""
from __future__ import annotations

import collections
import dataclasses
import json
import pathlib
from collections.abc import Iterator
from typing import Any

import numpy as np
import numpy.typing as npt

from underbrush.errors import FormatError
from underbrush.formats import catalogue
from underbrush.formats.clock import Clock
from underbrush.formats.scans import Scan

Floats = npt.NDArray[np.float64]
Packets = npt.NDArray[Any]  #: Of `Metadata.packet`, or its columns.


@dataclasses.dataclass(frozen=True)
class Profile:
    """Layout of a pixel. The fields are (name, type, offset in bytes)."""

    pixel_bytes: int
    fields: tuple[tuple[str, str, int], ...]
    range_bits: int
    range_step_m: float = 0.001
    near_ir_scale: int = 1
    legacy: bool = False

    @property
    def returns(self) -> int:
        return sum(name.startswith("range") for name, _, _ in self.fields)


_DUAL = (("range", "<u4", 0), ("reflectivity", "u1", 3), ("range2", "<u4", 4), ("reflectivity2", "u1", 7),
         ("signal", "<u2", 8), ("signal2", "<u2", 10))
_SINGLE = (("range", "<u4", 0), ("reflectivity", "u1", 4), ("signal", "<u2", 6), ("near_ir", "<u2", 8))
_COLOUR = (("range", "<u4", 0), ("reflectivity", "u1", 3), ("signal", "<u2", 4), ("near_ir", "<u2", 6))
_LOW = (("range", "<u2", 0), ("reflectivity", "u1", 2), ("near_ir", "u1", 3))
_LOW_DUAL = (*_LOW, ("range2", "<u2", 4), ("reflectivity2", "u1", 6))
_DUAL_NIR = (*_DUAL, ("near_ir", "<u2", 12))

PROFILES = {
    "LEGACY": Profile(12, _SINGLE, 20, legacy=True),
    "RNG19_RFL8_SIG16_NIR16": Profile(12, _SINGLE, 19),
    "RNG19_RFL8_SIG16_NIR16_DUAL": Profile(16, _DUAL_NIR, 19),
    "RNG15_RFL8_NIR8": Profile(4, _LOW, 15, 0.008, 16),
    "RNG15_RFL8_NIR8_DUAL": Profile(8, _LOW_DUAL, 15, 0.008, 16),
    "FUSA_RNG15_RFL8_NIR8_DUAL": Profile(8, _LOW_DUAL, 15, 0.008, 16),
    "RNG15_RFL8_WIN8": Profile(4, _LOW[:2], 15, 0.008),
    "RNG15_RFL8_NIR8_ZONE16": Profile(8, _LOW, 15, 0.008, 16),
    "RNG19_RFL8_SIG16_NIR16_ZONE16": Profile(12, _SINGLE, 19),
    "RNG19_RFL8_SIG16_ZONE16_DUAL": Profile(16, _DUAL, 19),
    "RNG19_RFL8_SIG16_NIR16_RGB16": Profile(16, _COLOUR, 19),
    "RNG19_RFL8_SIG16_NIR16_RGB16_DUAL": Profile(20, _DUAL_NIR, 19),
    "FIVE_WORD_PIXEL": Profile(20, _DUAL_NIR, 19),
}

#: Sizes of packets of 16 columns, by which packets without metadata are told from others.
SIZES = {(0 if profile.legacy else 64) + 16 * ((20 if profile.legacy else 12) + rows * profile.pixel_bytes)
         for profile in PROFILES.values() for rows in (16, 32, 64, 128)}

#: Distance of the beams' origin from the axis, mm, where the metadata lack it; else that of the first generation.
_ORIGIN_MM = {"OS-0": 27.67, "OS-1": 15.806, "OS-2": 13.762}
_FIRST_GENERATION_MM = 12.163
_LIDAR_TO_SENSOR = [-1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1, 36.18, 0, 0, 0, 1]


@dataclasses.dataclass(frozen=True)
class Metadata:
    """What a decoder needs of a sensor's metadata. Raises FormatError where a file lacks it."""

    product: str  #: Product line, such as OS-1-128; empty for old files.
    serial: int  #: 0 where it is not told.
    profile_name: str
    columns: int  #: In a frame.
    columns_per_packet: int
    window: tuple[int, int]  #: First and last column that the sensor sends; the first may be the greater one.
    fusa: bool  #: Whether headers of packets are those of functional safety.
    port: int  #: Of lidar packets; 0 where it is not told.
    elevation: Floats  #: (rows,), rad.
    azimuth: Floats  #: (rows,), rad, clockwise from the encoder's angle.
    origin_m: tuple[float, float]  #: Of the beams: distance from the axis and height.
    sensor_from_lidar: Floats  #: (4, 4), m.

    @property
    def profile(self) -> Profile:
        return PROFILES[self.profile_name]

    @property
    def rows(self) -> int:
        return len(self.elevation)

    @property
    def packet(self) -> np.dtype[Any]:
        """Layout of a packet."""
        profile, rows = self.profile, self.rows
        names, types, offsets = zip(*profile.fields)
        pixel = np.dtype({"names": names, "formats": types, "offsets": offsets, "itemsize": profile.pixel_bytes})
        if profile.legacy:
            column = np.dtype([("time_ns", "<u8"), ("id", "<u2"), ("frame", "<u2"), ("encoder", "<u4"),
                               ("pixels", pixel, (rows,)), ("status", "<u4")])
            return np.dtype([("columns", column, (self.columns_per_packet,))])
        column = np.dtype([("time_ns", "<u8"), ("id", "<u2"), ("status", "<u2"), ("pixels", pixel, (rows,))])
        frame, places = ("<u4", [0, 4, 8]) if self.fusa else ("<u2", [0, 2, 4])
        header = np.dtype({"names": ["kind", "frame", "serial"], "formats": ["u1", frame, "<u8"], "offsets": places,
                           "itemsize": 32})  # The serial number fills the upper five bytes.
        return np.dtype([("header", header), ("columns", column, (self.columns_per_packet,)), ("footer", "V32")])

    @classmethod
    def read(cls, path: str | pathlib.Path) -> Metadata:
        """Reads a JSON file. Raises OSError, or FormatError where it is no metadata or lacks something."""
        try:
            file = json.loads(pathlib.Path(path).read_text(encoding="utf-8"))
            if not isinstance(file, dict):
                raise ValueError("it is no object")
            return _metadata(_Values(file))
        except (ValueError, TypeError, KeyError, RecursionError, OverflowError) as error:
            reason = " ".join(str(error).split())[:200]
            raise FormatError(path, "", f"is no metadata of an Ouster sensor: {reason}") from error


class _Values:
    """Values by their names, which stand at the top (old files) or in a section (new files)."""

    def __init__(self, file: dict[str, Any]) -> None:
        self._places = [file, *(value for value in file.values() if isinstance(value, dict))]

    def get(self, name: str, default: Any = None) -> Any:
        return next((place[name] for place in self._places if place.get(name) not in (None, "")), default)

    def numbers(self, name: str, default: list[float] | None = None) -> Floats:
        value = self.get(name, default)
        if value is None:
            raise ValueError(f"'{name}' is missing")
        array = np.asarray(value, dtype=np.float64)
        if not (np.abs(array) < 1e6).all():
            raise ValueError(f"'{name}' has a value that is no sound number")
        return array


def _metadata(values: _Values) -> Metadata:
    elevation, azimuth = values.numbers("beam_altitude_angles"), values.numbers("beam_azimuth_angles")
    if elevation.ndim != 1 or elevation.shape != azimuth.shape or not 1 <= len(elevation) <= 1024:
        raise ValueError("'beam_altitude_angles' and 'beam_azimuth_angles' are not two lists of the same length")
    mode = str(values.get("lidar_mode", "1024x10"))
    columns = int(values.get("columns_per_frame", mode.split("x")[0]))
    per_packet = int(values.get("columns_per_packet", 16))
    if not 1 <= per_packet <= 1024 or not per_packet <= columns <= 1 << 15:
        raise ValueError(f"{columns} columns in a frame and {per_packet} in a packet are out of range")
    if int(values.get("pixels_per_column", len(elevation))) != len(elevation):
        raise ValueError("'pixels_per_column' is not the number of angles")
    profile = str(values.get("udp_profile_lidar", "LEGACY"))
    if profile not in PROFILES:
        raise ValueError(f"the profile {profile} is not known; known are {', '.join(PROFILES)}")
    product = str(values.get("prod_line", ""))
    axis_mm = float(values.get("lidar_origin_to_beam_origin_mm", _ORIGIN_MM.get(product[:4], _FIRST_GENERATION_MM)))
    beam_mm = values.numbers("beam_to_lidar_transform", [1, 0, 0, axis_mm, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1])
    transform = values.numbers("lidar_to_sensor_transform", list(map(float, _LIDAR_TO_SENSOR))).reshape(4, 4)
    rotation = transform[:3, :3]
    if not np.allclose(rotation @ rotation.T, np.eye(3), atol=1e-3) or not (transform[3] == [0, 0, 0, 1]).all():
        raise ValueError("'lidar_to_sensor_transform' is no rigid transform")
    transform[:3, 3] *= 0.001
    beam_mm = beam_mm.reshape(4, 4)
    window = [int(column) for column in values.get("column_window", (0, columns - 1))]
    if len(window) != 2 or not all(0 <= column < columns for column in window):
        raise ValueError("'column_window' is not two columns of a frame")
    serial = str(values.get("prod_sn", "0"))
    fusa = str(values.get("header_type", "")) == "FUSA" or profile.startswith("FUSA")
    origin_m = (float(beam_mm[0, 3]) * 0.001, float(beam_mm[2, 3]) * 0.001)
    return Metadata(product, int(serial) if serial.isdecimal() else 0, profile, columns, per_packet,
                    (window[0], window[1]), fusa, int(values.get("udp_port_lidar", 0)), np.radians(elevation),
                    np.radians(azimuth), origin_m, transform)


class Decoder:
    """Turns packets into scans, one a frame. Rows are in order of columns, then of pixels, then of range.

    Columns that were not received or that the sensor marks as not valid have no rows; `skipped` counts them.
    """

    def __init__(self, metadata: Metadata, skipped: collections.Counter[str]) -> None:
        self.metadata = metadata
        self.skipped = skipped
        self.packet = metadata.packet
        self.packet_bytes = self.packet.itemsize
        known = "ouster-" + metadata.product.lower().replace("os-", "os") if metadata.product else "ouster-os1-64"
        self.sensor = known if known in catalogue.names() and known.endswith(f"-{metadata.rows}") else ""
        self.title = f"Ouster {metadata.product or f'with {metadata.rows} rows'}"
        self.modes = {"dual return" if metadata.profile.returns == 2 else "single return"}
        self.clock = Clock()
        self._table = _Table(metadata)
        self._frames: list[_Frame] = []
        self._scans = 0

    def decode(self, packets: Packets, captured_s: Floats) -> Iterator[Scan]:
        """Yields the scans that end in the (n,) `packets`, which were captured at (n,) `captured_s`."""
        if not self.metadata.profile.legacy:
            serial = packets["header"]["serial"] >> np.uint64(24) & np.uint64((1 << 40) - 1)
            other = (packets["header"]["kind"] != 1) | (
                (serial != self.metadata.serial) & (serial != 0) & (self.metadata.serial != 0))
            self.skipped["packets of another sensor or kind"] += int(other.sum())
            packets, captured_s = packets[~other], captured_s[~other]
        if not len(packets):
            return
        columns = packets["columns"]
        frame = columns["frame"] if self.metadata.profile.legacy else np.broadcast_to(
            packets["header"]["frame"][:, None], columns.shape)
        valid = (columns["status"] == 0xFFFFFFFF) if self.metadata.profile.legacy else (columns["status"] & 1) == 1
        sound = valid & (columns["id"] < self.metadata.columns)
        self.skipped["columns with a wrong number"] += int((valid & ~sound).sum())
        stamp_s = np.where(sound, columns["time_ns"], 0).max(axis=1) * 1e-9
        shift = self.clock.shift(stamp_s, captured_s)
        time_s = columns["time_ns"] * 1e-9 + shift[:, None]
        columns, frame, time_s = columns[sound], frame[sound].astype(np.int64), time_s[sound]
        edges = [0, *(np.flatnonzero(np.diff(frame)) + 1), len(frame)]
        for begin, end in zip(edges[:-1], edges[1:]):
            if end > begin:
                yield from self._add(int(frame[begin]), columns[begin:end], time_s[begin:end])

    def finish(self) -> Iterator[Scan]:
        """Yields the last scans."""
        while self._frames:
            yield self._scan(self._frames.pop(0), last=not self._frames)

    def found(self) -> list[str]:
        """Lines about clock and layout."""
        data = self.metadata
        return [f"packets: {data.profile_name}, {data.rows} rows x {data.columns} columns", self.clock.found()]

    def _add(self, number: int, columns: Packets, time_s: Floats) -> Iterator[Scan]:
        """Adds columns to their frame. The frame before stays open for packets that come late."""
        for frame in self._frames:
            if frame.number == number:
                frame.columns.append(columns)
                frame.time_s.append(time_s)
                frame.size += len(time_s)
                if frame.size > 4 * self.metadata.columns:  # The same frame again and again.
                    self._frames.remove(frame)
                    yield self._scan(frame, last=False)
                return
        if self._frames and -8 <= number - self._frames[-1].number < 0:
            self.skipped["columns that came more than a frame late"] += len(time_s)
            return
        if len(self._frames) == 2:
            yield self._scan(self._frames.pop(0), last=False)
        self._frames.append(_Frame(number, [columns], [time_s], len(time_s)))

    def _scan(self, frame: _Frame, last: bool) -> Scan:
        """The columns of a frame as a scan; `last` is the last frame of the recording."""
        columns, time_s = np.concatenate(frame.columns), np.concatenate(frame.time_s)
        ids, first = np.unique(columns["id"], return_index=True)
        self.skipped["columns received twice"] += len(columns) - len(ids)
        order = (ids.astype(np.int64) - self.metadata.window[0]) % self.metadata.columns
        sort = np.argsort(order)
        order, columns, time_s = order[sort], columns[first[sort]], time_s[first[sort]]
        width = (self.metadata.window[1] - self.metadata.window[0]) % self.metadata.columns + 1
        begin = int(order[0]) if self._scans == 0 else 0  # The recording may begin and end inside a frame.
        end = int(order[-1]) + 1 if last else width
        self.skipped["missing columns (lost packets or marked as not valid)"] += max(0, end - begin - len(order))
        self._scans += 1
        return self._table.scan(self._scans - 1, columns, time_s)


@dataclasses.dataclass
class _Frame:
    number: int
    columns: list[Packets]
    time_s: list[Floats]
    size: int


class _Table:
    """Directions and origins of all beams of a frame in the sensor's frame."""

    def __init__(self, metadata: Metadata) -> None:
        self._profile = metadata.profile
        encoder = -2 * np.pi / metadata.columns * np.arange(metadata.columns)[:, None]
        azimuth = encoder - metadata.azimuth
        axis_m, height_m = metadata.origin_m
        self._before_m = float(np.hypot(axis_m, height_m))  #: Ranges are from the axis; the beam begins here.
        flat, up = np.cos(metadata.elevation), np.sin(metadata.elevation)
        direction = np.stack([np.cos(azimuth) * flat, np.sin(azimuth) * flat, np.broadcast_to(up, azimuth.shape)], -1)
        origin = np.stack([axis_m * np.cos(encoder), axis_m * np.sin(encoder), np.full_like(encoder, height_m)], -1)
        rotation, shift = metadata.sensor_from_lidar[:3, :3], metadata.sensor_from_lidar[:3, 3]
        direction = direction @ rotation.T
        self.direction = direction / np.linalg.norm(direction, axis=-1, keepdims=True)  #: (columns, rows, 3)
        self.origin = np.broadcast_to(origin @ rotation.T + shift, direction.shape)  #: (columns, rows, 3), m.

    def scan(self, number: int, columns: Packets, time_s: Floats) -> Scan:
        """Decodes (n,) `columns` of a frame, whose times are (n,) `time_s`."""
        profile, pixels, rows = self._profile, columns["pixels"], self.direction.shape[1]
        mask = np.uint32((1 << profile.range_bits) - 1)
        counts = np.stack([(pixels[name] & mask).ravel() for name in ("range", "range2")[:profile.returns]])
        beams = np.arange(counts.shape[1])
        order = np.argsort(counts, axis=0, kind="stable") if profile.returns == 2 else None
        if order is None:
            row_beam, row_return = beams, np.zeros(len(beams), dtype=np.intp)
            echoes = (counts[0] > 0).astype(np.uint8)
            echo = echoes
        else:
            near, far = counts.min(axis=0), counts.max(axis=0)
            number_of = (far > 0).astype(np.uint8) + ((near > 0) & (near != far))
            row_beam = np.repeat(beams, np.maximum(number_of, 1))
            second = np.append(False, row_beam[1:] == row_beam[:-1])
            echoes = number_of[row_beam].astype(np.uint8)
            # A single return of unequal counts is the farther one; of equal ones the first.
            take = np.where(second | ((echoes == 1) & (near != far)[row_beam]), 1, 0)
            row_return = order[take, row_beam]
            echo = (np.minimum(echoes, 1) + second).astype(np.uint8)
        count = counts[row_return, row_beam]
        range_m = np.where(count > 0, np.maximum(count * profile.range_step_m - self._before_m, 0.001), np.inf)
        extra: dict[str, npt.NDArray[np.generic]] = {}
        names = {name for name, _, _ in profile.fields}
        for name in ("signal", "reflectivity", "near_ir"):
            if name in names:
                both = np.stack([pixels[name].ravel(), pixels[name + "2" if name + "2" in names else name].ravel()])
                extra[name] = both[row_return, row_beam]
        if "near_ir" in extra:
            extra["near_ir"] = extra["near_ir"].astype(np.uint16) * np.uint16(profile.near_ir_scale)
        column = np.repeat(columns["id"], rows)[row_beam]
        pixel = row_beam % rows
        extra["column"] = column
        intensity = np.where(count > 0, extra.get("signal", extra["reflectivity"]), 0).astype(np.float32)
        return Scan(
            number=number, time_s=float(time_s[0]), direction=self.direction[column, pixel],
            range_m=range_m.astype(np.float32), origin=self.origin[column, pixel],
            beam_time_s=np.repeat(time_s, rows)[row_beam],
            intensity=intensity, ring=pixel.astype(np.uint16), echo=echo, echoes=echoes, extra=extra)
