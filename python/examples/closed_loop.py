#!/usr/bin/env python3
"""Drives through a model and turns away from what stands near ahead, by what a simulated lidar sees.

    python closed_loop.py model/
"""
from __future__ import annotations

import math
import sys

import numpy as np

import underbrush


def pose_at(x: float, y: float, z: float, heading_rad: float) -> underbrush.Pose:
    """A level pose (m, rad)."""
    return underbrush.Pose([x, y, z], [0, 0, math.sin(heading_rad / 2), math.cos(heading_rad / 2)])


def free_ahead(scan: underbrush.BeamLog, heading_rad: float, side: float) -> float:
    """Distance (m) to the nearest return ahead on one side (+1 left, -1 right), less than 3 m off the axis."""
    hit = np.isfinite(scan.range_m)
    to = scan.end_points()[hit] - scan.origin[hit]
    along = to[:, 0] * math.cos(heading_rad) + to[:, 1] * math.sin(heading_rad)
    across = side * (to[:, 1] * math.cos(heading_rad) - to[:, 0] * math.sin(heading_rad))
    ahead = along[(along > 0.5) & (across > 0) & (across < 3) & (to[:, 2] > -1)]
    return float(ahead.min()) if len(ahead) else math.inf


def main(path: str, steps: int = 20) -> None:
    """Drives a number of revolutions of 0.1 s at 3 m/s."""
    model = underbrush.read_model(path)
    lidar = underbrush.Lidar(model, "velodyne-vlp16", seed=1)
    x, y, z = (model.origin + model.ground.vertices.mean(axis=0)).tolist()
    z, heading = z + 2.0, 0.0
    for step in range(steps):
        there = (x + 0.3 * math.cos(heading), y + 0.3 * math.sin(heading))
        scan = lidar.scan(pose_at(x, y, z, heading), pose_at(*there, z, heading), time=0.1 * step)
        x, y = there
        left, right = free_ahead(scan, heading, +1), free_ahead(scan, heading, -1)
        heading += 0.1 * (left > right) - 0.1 * (right > left)
        print(f"{0.1 * step:4.1f} s  left {left:6.1f} m  right {right:6.1f} m")


if __name__ == "__main__":
    main(sys.argv[1])
