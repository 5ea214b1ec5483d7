#!/usr/bin/env python3
"""A small log that needs no data: flat ground with trees, seen by a VLP-16 that passes them.

    small_log.py LOG.ply
"""
from __future__ import annotations

import sys

import numpy as np

import underbrush


def ranges_in_world(origin: np.ndarray, direction: np.ndarray, seed: int) -> np.ndarray:
    """Ranges (n,) at which beams meet the plane z = 0 or round trees, with noise; infinity for none up to 100 m."""
    generator = np.random.default_rng(seed)
    d = direction.astype(float)
    with np.errstate(divide="ignore", invalid="ignore"):
        ground = -origin[:, 2] / d[:, 2]
    best = np.where(ground > 0, ground, np.inf)
    for x, y, z, radius in ((8.0, 4.0, 2.5, 1.5), (15.0, -6.0, 3.0, 2.0), (22.0, 3.0, 2.0, 1.2)):
        to = np.array([x, y, z]) - origin
        along = np.einsum("ij,ij->i", to, d)
        inside = radius**2 - (np.einsum("ij,ij->i", to, to) - along**2)
        meets = (inside > 0) & (along > 0) & (generator.random(len(d)) < 0.6)
        depth = np.sqrt(np.maximum(inside, 0)) * generator.uniform(-1, 1, len(d))
        best = np.where(meets, np.minimum(best, along + depth), best)
    best = best + generator.normal(0, 0.02, len(d))
    return np.where(best < 100, best, np.inf)


def drive() -> underbrush.Trajectory:
    """A straight drive of 1 s."""
    times = np.linspace(0, 1, 5)
    position = np.stack([6 * times, 0 * times, 0 * times + 1.8], axis=1)
    return underbrush.Trajectory(times, position, np.tile([0.0, 0, 0, 1], (5, 1)))


def small_log() -> underbrush.BeamLog:
    """A log of the first 0.2 s of the drive."""
    beams = underbrush.beams(underbrush.Sensor("velodyne-vlp16"), drive(), 0, 0.2)
    beams.range_m[:] = ranges_in_world(beams.origin, beams.direction, 7)
    return beams


if __name__ == "__main__":
    underbrush.write_log(sys.argv[1], small_log())
