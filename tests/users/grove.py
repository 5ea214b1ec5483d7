"""A grove in closed form: flat ground, trunks and a wall, a vehicle that drives a curve, and where rays end."""
from __future__ import annotations

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]

START_S, DURATION_S = 1.7e9, 1.0
SPEED, YAW_RATE = 5.0, 0.15                              # m/s, rad/s
LIDAR_FROM_BASE = np.array([0.4, 0.0, 1.7])              # m, the lidar's axes are those of the vehicle
WALL_Y, TRUNK_RADIUS = 14.0, 0.5
TRUNKS = np.array([(x, y) for x in range(-20, 31, 10) for y in (-10, -5, 6)], np.float64) + 0.3
REACH = 80.0


def base_at(time_s: Floats) -> tuple[Floats, Floats]:
    """Positions (m, 3) and yaw angles of the vehicle at times after the start."""
    yaw = YAW_RATE * time_s
    radius = SPEED / YAW_RATE
    return np.stack([radius * np.sin(yaw), radius * (1 - np.cos(yaw)), np.zeros_like(yaw)], axis=-1), yaw


def quaternions(yaw: Floats) -> Floats:
    """Quaternions x y z w of turns about z."""
    zero = np.zeros_like(yaw)
    return np.stack([zero, zero, np.sin(yaw / 2), np.cos(yaw / 2)], axis=-1)


def turned(points: Floats, yaw: Floats) -> Floats:
    """Points (n, 3) turned about z."""
    c, s = np.cos(yaw), np.sin(yaw)
    return np.stack([c * points[:, 0] - s * points[:, 1], s * points[:, 0] + c * points[:, 1], points[:, 2]], axis=-1)


def lidar_at(time_s: Floats) -> tuple[Floats, Floats]:
    """Positions and yaw angles of the lidar at times after the start."""
    position, yaw = base_at(time_s)
    return position + turned(np.broadcast_to(LIDAR_FROM_BASE, position.shape), yaw), yaw


def ranges(origin: Floats, direction: Floats) -> Floats:
    """The range of each ray (n, 3), infinite where it meets nothing within reach."""
    with np.errstate(divide="ignore", invalid="ignore"):
        ground = -origin[:, 2] / direction[:, 2]
        wall = (WALL_Y - origin[:, 1]) / direction[:, 1]
        best = np.minimum(np.where(ground > 0, ground, np.inf), np.where(wall > 0, wall, np.inf))
        across = np.sum(direction[:, :2]**2, axis=1)
        for trunk in TRUNKS:
            to = trunk - origin[:, :2]
            along = np.sum(to * direction[:, :2], axis=1) / across
            missed = np.sum(to**2, axis=1) - along**2 * across
            near = along - np.sqrt((TRUNK_RADIUS**2 - missed) / across)
            best = np.minimum(best, np.where(np.isfinite(near) & (near > 0), near, np.inf))
    return np.where(best < REACH, best, np.inf)


def distances(points: Floats) -> Floats:
    """The distance of each point (n, 3) to the nearest surface."""
    best = np.minimum(np.abs(points[:, 2]), np.abs(WALL_Y - points[:, 1]))
    for trunk in TRUNKS:
        best = np.minimum(best, np.abs(np.linalg.norm(points[:, :2] - trunk, axis=1) - TRUNK_RADIUS))
    return best
