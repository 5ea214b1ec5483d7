"""Metadata of Ouster's sensors (JSON, in its old flat and its new nested form) and the layouts of their packets.

Source: the maker's manuals and public SDK.
"""
from __future__ import annotations

import dataclasses
import json
import pathlib
from typing import Any

import numpy as np
import numpy.typing as npt

from underbrush.errors import FormatError

Floats = npt.NDArray[np.float64]


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

#: Sizes of packets of 16 columns, by which packets without metadata are recognised.
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
    serial: int  #: 0 if the metadata lack it.
    profile_name: str
    columns: int  #: In a frame.
    columns_per_packet: int
    window: tuple[int, int]  #: First and last column that the sensor sends; the first may be the greater one.
    fusa: bool  #: Whether headers of packets are those of functional safety.
    port: int  #: Of lidar packets; 0 if the metadata lack it.
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
        return cls.of_text(pathlib.Path(path).read_bytes(), path)

    @classmethod
    def of_text(cls, text: str | bytes, path: str | pathlib.Path) -> Metadata:
        """Reads the text of such a file; `path` is the file that has it. Raises FormatError."""
        try:
            file = json.loads(text)
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
    if elevation.ndim != 1 or elevation.shape != azimuth.shape or not 1 <= len(elevation) <= 256:
        raise ValueError("'beam_altitude_angles' and 'beam_azimuth_angles' are not two lists of the same length")
    mode = str(values.get("lidar_mode", "1024x10"))
    columns = int(values.get("columns_per_frame", mode.split("x")[0]))
    per_packet = int(values.get("columns_per_packet", 16))
    if not 1 <= per_packet <= 256 or not per_packet <= columns <= 4096:
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
