#!/usr/bin/env python3
"""Writes a ROS 2 bag of a drive through a grove, as a robot records one: point clouds of a VLP-16, from which the driver
has dropped the misses, odometry, and transforms.

  make_drive.py FOLDER
"""
from __future__ import annotations

import pathlib
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "python/tests"))

import grove  # noqa: E402
from bag_messages import ODOMETRY, bag  # noqa: E402

SCANS, FIRINGS, RINGS, NOISE = 10, 1808, 16, 0.01
POINT = np.dtype({"names": ["x", "y", "z", "intensity", "ring", "time"], "formats": ["<f4"] * 4 + ["<u2", "<f4"],
                  "offsets": [0, 4, 8, 12, 16, 18], "itemsize": 22})


def scan(number: int, rng: np.random.Generator) -> np.ndarray:
    """The points of a revolution in the lidar's frame, each at the pose of its own time."""
    firing = np.repeat(np.arange(FIRINGS), RINGS)
    ring = np.tile(np.arange(RINGS), FIRINGS)
    after = (firing + ring / (1.5 * RINGS)) * 0.1 / FIRINGS
    azimuth, elevation = -2 * np.pi * after / 0.1, np.radians(-15.0 + 2 * ring)
    direction = np.stack([np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth),
                          np.sin(elevation)], axis=-1)
    position, yaw = grove.lidar_at(0.1 * number + after)
    distance = grove.ranges(position, grove.turned(direction, yaw)) + rng.normal(0, NOISE, len(after))
    hit = np.isfinite(distance)
    points = np.zeros(np.count_nonzero(hit), POINT)
    points["x"], points["y"], points["z"] = (distance[:, None] * direction)[hit].T
    points["intensity"], points["ring"], points["time"] = 40, ring[hit], after[hit]
    return points


def main() -> None:
    rng, written = np.random.default_rng(1), 0
    with bag(pathlib.Path(sys.argv[1])) as out:
        out.transform("/tf_static", grove.START_S, "base_link", "velodyne", grove.LIDAR_FROM_BASE, [0, 0, 0, 1])
        for time_s in np.arange(-0.05, grove.DURATION_S + 0.1, 0.02):
            (position,), yaw = grove.base_at(np.array([time_s]))
            (rotation,) = grove.quaternions(yaw)
            out.transform("/tf", grove.START_S + time_s, "odom", "base_link", position, rotation)
            out.pose("/odometry", ODOMETRY, grove.START_S + time_s, "odom", "base_link", position, rotation)
        for number in range(SCANS):
            points = scan(number, rng)
            written += len(points)
            out.cloud("/velodyne_points", grove.START_S + 0.1 * number, points, frame="velodyne",
                      bag_s=grove.START_S + 0.1 * number + 0.1)
    print(f"{SCANS} scans, {written} points")


if __name__ == "__main__":
    main()
