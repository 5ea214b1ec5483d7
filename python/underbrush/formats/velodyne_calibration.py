"""Calibrations of single Velodyne sensors: files of VeloView (XML) and of the ROS driver (YAML), status bytes."""
from __future__ import annotations

import dataclasses
import pathlib
import struct
import xml.etree.ElementTree

import numpy as np
import numpy.typing as npt
import yaml

from underbrush.errors import FormatError

Floats = npt.NDArray[np.float64]

_FAR_M, _NEAR_X_M, _NEAR_Y_M = 25.04, 2.4, 1.93  #: Distances of the two-point calibration.

#: Field -> (key in the driver's YAML, key in VeloView's XML, its unit in XML).
_KEYS = {
    "elevation": ("vert_correction", "vertCorrection_", np.pi / 180),
    "azimuth": ("rot_correction", "rotCorrection_", np.pi / 180),
    "range_m": ("dist_correction", "distCorrection_", 0.01),
    "range_x_m": ("dist_correction_x", "distCorrectionX_", 0.01),
    "range_y_m": ("dist_correction_y", "distCorrectionY_", 0.01),
    "up_m": ("vert_offset_correction", "vertOffsetCorrection_", 0.01),
    "left_m": ("horiz_offset_correction", "horizOffsetCorrection_", 0.01),
}


@dataclasses.dataclass(frozen=True)
class Calibration:
    """Angles and corrections of the lasers, in the order of the packet; each column is (lasers,)."""

    elevation: Floats  #: rad
    azimuth: Floats  #: rad, counter-clockwise.
    range_m: Floats  #: Added to the range.
    range_x_m: Floats  #: The same for near targets to the side, …
    range_y_m: Floats  #: … and ahead; 0: as far ones.
    up_m: Floats  #: Height of the beam's origin.
    left_m: Floats  #: Distance of the beam's origin to the left of its direction, seen from above.
    resolution_m: float = 0.0  #: Step of the range; 0: the model's.
    source: str = ""  #: Where it comes from; empty for the catalogue.

    @classmethod
    def nominal(cls, elevation: Floats, azimuth: Floats, up_m: Floats) -> Calibration:
        """That of the catalogue: angles, rad, and heights of the beams' origins, m."""
        zero = np.zeros(len(elevation))
        return cls(elevation, azimuth, zero, zero, zero, up_m, zero)

    @classmethod
    def read(cls, path: str | pathlib.Path) -> Calibration:
        """Reads a file of VeloView (XML) or of the ROS driver (YAML). Raises OSError, FormatError."""
        text = pathlib.Path(path).read_text(encoding="utf-8", errors="replace")
        try:
            return _from_xml(text, str(path)) if text.lstrip().startswith("<") else _from_yaml(text, str(path))
        except (ValueError, KeyError, TypeError, AttributeError, yaml.YAMLError, xml.etree.ElementTree.ParseError) as e:
            raise FormatError(path, "", "is no calibration of a Velodyne (VeloView's XML or the ROS driver's YAML): "
                              + " ".join(str(e).split())) from e

    @classmethod
    def from_status(cls, kinds: npt.NDArray[np.uint8], values: npt.NDArray[np.uint8]) -> Calibration | None:
        """From the status bytes (kind, value) of successive packets of an HDL-64E S2 or S3; None if incomplete.

        Values of the kinds H M S D N Y G T V are states. The others form a text of 1820 bytes: 'UNIT#', two bytes,
        then 28 bytes for each of the 64 lasers.
        """
        text = values[~np.isin(kinds, list(b"HMSDNYGTV"))].tobytes()
        begin = text.find(b"UNIT#")
        while begin >= 0:
            rows = [text[begin + 7 + 28 * laser:begin + 28 + 28 * laser] for laser in range(64)]
            if len(rows[-1]) == 21 and all(row[0] == laser for laser, row in enumerate(rows)):
                table = np.array([struct.unpack("<B9hBB", row)[1:8] for row in rows]).T
                angles, lengths = np.radians(table[:2] * 0.01), table[2:] * 0.001
                return cls(angles[0], angles[1], lengths[0], lengths[1], lengths[2], lengths[3], lengths[4],
                           source="status bytes of the packets")
            begin = text.find(b"UNIT#", begin + 1)
        return None

    @property
    def has_ranges(self) -> bool:
        """Whether ranges are corrected."""
        return bool(self.range_m.any() or self.range_x_m.any() or self.range_y_m.any())

    def beams(self, azimuth: Floats) -> tuple[Floats, Floats | None]:
        """Directions of firings at (firings, lasers) azimuths (rad, counter-clockwise, of each laser's own time).

        Returns (n, 3) unit vectors and (n, 3) origins in m, or None where all beams start at the sensor's origin.
        """
        cos, sin = np.cos(azimuth + self.azimuth), np.sin(azimuth + self.azimuth)
        direction = np.empty((*azimuth.shape, 3))
        direction[..., 0] = cos * np.cos(self.elevation)
        direction[..., 1] = sin * np.cos(self.elevation)
        direction[..., 2] = np.sin(self.elevation)
        origin = None
        if self.up_m.any() or self.left_m.any():
            origin = np.empty_like(direction)
            origin[..., 0] = -sin * self.left_m
            origin[..., 1] = cos * self.left_m
            origin[..., 2] = self.up_m
            origin = origin.reshape(-1, 3)
        return direction.reshape(-1, 3), origin

    def corrected(self, direction: Floats, range_m: npt.NDArray[np.float32], laser: npt.NDArray[np.int64]) -> tuple[
            Floats, npt.NDArray[np.float32]]:
        """Directions and ranges of returns with the corrections of their (n,) lasers; misses stay as they are.

        Within 25 m the two-point calibration corrects each axis by its own amount, and the height by their mean.
        """
        hit = np.isfinite(range_m)
        ahead, far = direction[hit], self.range_m[laser[hit]]
        near = (range_m[hit].astype(np.float64) + far)[:, None] * np.abs(ahead)
        x_m, y_m = self.range_x_m[laser[hit]], self.range_y_m[laser[hit]]
        two = (x_m != 0) | (y_m != 0)
        # Velodyne's x points to the right and y ahead.
        side = np.where(two, x_m + (far - x_m) * np.minimum((near[:, 1] - _NEAR_X_M) / (_FAR_M - _NEAR_X_M), 1), far)
        front = np.where(two, y_m + (far - y_m) * np.minimum((near[:, 0] - _NEAR_Y_M) / (_FAR_M - _NEAR_Y_M), 1), far)
        vector = ahead * (range_m[hit][:, None] + np.stack([front, side, (front + side) / 2], axis=1))
        length = np.linalg.norm(vector, axis=1)
        sound = (length > 1e-3) & (range_m[hit] + far > 0)
        ranges = np.where(sound, length, 1e-3).astype(np.float32)
        direction, range_m = direction.copy(), range_m.copy()
        direction[hit] = np.where(sound[:, None], vector / np.maximum(length, 1e-3)[:, None], ahead)
        range_m[hit] = ranges
        return direction, range_m


def _from_yaml(text: str, source: str) -> Calibration:
    file = yaml.safe_load(text)
    lasers = sorted(file["lasers"], key=lambda laser: int(laser["laser_id"]))
    columns = {field: np.array([float(laser.get(key, 0)) for laser in lasers]) for field, (key, _, _) in _KEYS.items()}
    ids = [int(laser["laser_id"]) for laser in lasers]
    return _calibration(columns, ids, float(file.get("distance_resolution", 0)), source)


def _from_xml(text: str, source: str) -> Calibration:
    root = xml.etree.ElementTree.fromstring(text)
    lasers = sorted(root.iter("px"), key=lambda px: int(px.findtext("id_", "-1")))
    columns = {field: np.array([float(px.findtext(key, "0")) for px in lasers]) * unit
               for field, (_, key, unit) in _KEYS.items()}
    enabled = [int(item.text or 0) for item in root.iterfind(".//enabled_/item")]
    count = sum(enabled) if enabled else len(lasers)
    columns = {field: column[:count] for field, column in columns.items()}
    ids = [int(px.findtext("id_", "-1")) for px in lasers][:count]
    return _calibration(columns, ids, float(root.findtext(".//distLSB_", "0")) * 0.01, source)


def _calibration(columns: dict[str, Floats], ids: list[int], resolution_m: float, source: str) -> Calibration:
    if not ids or ids != list(range(len(ids))):
        raise ValueError("its lasers are not numbered from 0 without a gap")
    if not all(np.isfinite(column).all() for column in columns.values()) or not 0 <= resolution_m <= 0.1:
        raise ValueError("it has a value that is no sound number")
    return Calibration(**columns, resolution_m=resolution_m, source=source)
