#!/usr/bin/env python3
"""Compares a map of canopy heights with that of the points alone.

  check_canopy.py MAP.tif POINTS.laz CELL_M
"""
from __future__ import annotations

import pathlib
import struct
import sys

import laspy
import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]


def geotiff(path: pathlib.Path) -> tuple[Floats, float, float]:
    """The values of a map that `rasters` wrote, and its north-western corner."""
    content = path.read_bytes()
    at = struct.unpack_from("<I", content, 4)[0]
    tags = {}
    for k in range(struct.unpack_from("<H", content, at)[0]):
        tag, _, _, value = struct.unpack_from("<HHII", content, at + 2 + 12 * k)
        tags[tag] = value
    corner = struct.unpack_from("<6d", content, tags[33922])[3:5]
    values = np.frombuffer(content, "<f4", tags[256] * tags[257], tags[273]).reshape(tags[257], tags[256])
    return values.astype(np.float64), corner[0], corner[1]


def canopy_of_points(path: pathlib.Path, west: float, north: float, cell_m: float, shape: tuple[int, ...]) -> Floats:
    """The highest point of each cell above the lowest point of class ground or water there, or around there."""
    las = laspy.read(path)
    column = np.floor((np.asarray(las.x) - west) / cell_m).astype(int)
    row = np.floor((north - np.asarray(las.y)) / cell_m).astype(int)
    inside = (column >= 0) & (row >= 0) & (column < shape[1]) & (row < shape[0])
    at, z = (row[inside], column[inside]), np.asarray(las.z)[inside]
    low = np.isin(np.asarray(las.classification)[inside], (2, 9))
    top, ground = np.full(shape, -np.inf), np.full(shape, np.inf)
    np.maximum.at(top, at, z)
    np.minimum.at(ground, (at[0][low], at[1][low]), z[low])
    while np.isinf(ground).any():  # Empty cells get the mean of those around them.
        padded = np.pad(ground, 1, constant_values=np.inf)
        around = np.stack([padded[i:i + shape[0], j:j + shape[1]] for i in range(3) for j in range(3)])
        known = np.isfinite(around)
        mean = np.where(known, around, 0).sum(axis=0) / np.maximum(known.sum(axis=0), 1)
        ground = np.where(np.isinf(ground) & known.any(axis=0), mean, ground)
    return np.asarray(np.where(np.isfinite(top), top - ground, np.nan))


def main() -> None:
    path, points, cell = sys.argv[1:]
    height, west, north = geotiff(pathlib.Path(path))
    own = canopy_of_points(pathlib.Path(points), west, north, float(cell), height.shape)
    both = np.isfinite(height) & np.isfinite(own)
    difference, r = float((height - own)[both].mean()), float(np.corrcoef(height[both], own[both])[0, 1])
    print(f"{np.count_nonzero(both)} cells, {own[both].mean():.2f} m high, {difference:+.2f} m, r {r:.3f}")
    if np.count_nonzero(both) < 5000 or abs(difference) > 0.3 or r < 0.8:
        sys.exit("check_canopy: the map is not that of the points")


if __name__ == "__main__":
    main()
