#!/usr/bin/env python3
"""Holds an imported drive and what another lidar would have measured on it against the grove in closed form. The
recording is read with `mcap` and `mcap_ros2`, which the package does not use to write it.

  check_drive.py LOG.ply RECORDING.mcap
"""
from __future__ import annotations

import sys
from typing import Any

import numpy as np
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory

import grove
import underbrush

RINGS, COLUMNS = 64, 1024


def check(ok: bool, what: str) -> None:
    if not ok:
        sys.exit(f"check_drive: {what}")
    print(f"  {what}")


def check_log(path: str) -> None:
    log = underbrush.read_log(path)
    hit = np.isfinite(log.range_m)
    time_s = np.asarray(log.time_s) - grove.START_S
    check(len(log) > 280_000 and 0.7 < hit.mean() < 0.8, f"{len(log)} beams, {hit.mean():.0%} of them return")
    check(log.info.scans[0].time_s == grove.START_S and 0.99 < np.ptp(time_s) < 1.01, f"{np.ptp(time_s):.4f} s")
    way = np.linalg.norm(np.asarray(log.origin) - grove.lidar_at(time_s)[0], axis=1).max()
    check(way < 0.005, f"beams begin {way * 1e3:.1f} mm from the lidar at their times")
    off = grove.distances(log.end_points()[hit])
    check(np.percentile(off, 95) < 0.03, f"95 % of the returns lie within {np.percentile(off, 95):.3f} m of a surface")


def messages(path: str) -> dict[str, list[Any]]:
    found: dict[str, list[Any]] = {}
    with open(path, "rb") as file:
        for _, channel, _, message in make_reader(file, decoder_factories=[DecoderFactory()]).iter_decoded_messages():
            found.setdefault(channel.topic, []).append(message)
    return found


def seconds(stamp: Any) -> float:
    return float(stamp.sec + 1e-9 * stamp.nanosec) - grove.START_S


def points_of(cloud: Any) -> np.ndarray:
    kinds = {2: "u1", 4: "<u2", 6: "<u4", 7: "<f4", 8: "<f8"}
    dtype = np.dtype({"names": [f.name for f in cloud.fields], "formats": [kinds[f.datatype] for f in cloud.fields],
                      "offsets": [f.offset for f in cloud.fields], "itemsize": cloud.point_step})
    return np.frombuffer(bytes(cloud.data), dtype).reshape(cloud.height, cloud.width)


def check_recording(path: str) -> None:
    found = messages(path)
    clouds, transforms = found["/points"], [t for m in found["/tf"] for t in m.transforms]
    stamps = np.array([seconds(c.header.stamp) for c in clouds])
    check(len(clouds) == 9 and np.allclose(np.diff(stamps), 0.1, atol=1e-3) and abs(stamps[0]) < 1e-3,
          f"{len(clouds)} clouds from {stamps[0]:.4f} to {stamps[-1]:.4f} s")
    check({(c.height, c.width) for c in clouds} == {(RINGS, COLUMNS)}, f"each of {RINGS} x {COLUMNS} points")
    check({c.header.frame_id for c in clouds} == {transforms[0].child_frame_id}, "in the frame of the transforms")
    errors, returns, truth = [], 0, 0
    for cloud, stamp in zip(clouds, stamps):
        points = points_of(cloud).ravel()
        xyz = np.stack([points[c] for c in "xyz"], axis=-1).astype(float)
        measured = np.linalg.norm(xyz, axis=1)
        hit = measured > 0
        worst = np.abs(points["range"][hit] / 1e3 - measured[hit]).max()
        if worst > 2e-3:
            check(False, f"the field range differs from x y z by {worst} m")
        position, yaw = grove.lidar_at(stamp + points["t"] * 1e-9)
        right = grove.ranges(position[hit], grove.turned(xyz[hit] / measured[hit, None], yaw[hit]))
        errors.append(np.minimum(np.abs(right - measured[hit]), 2))
        returns, truth = returns + np.count_nonzero(hit), truth + np.count_nonzero(np.isfinite(right))
    error = np.concatenate(errors)
    check(truth > 0.95 * returns > 300_000, f"{returns} returns, {truth / returns:.1%} of them where there is something")
    check(np.median(error) < 0.05 and error.mean() < 0.45,
          f"their ranges differ by {np.median(error):.3f} m in the median and {error.mean():.3f} m in the mean from the "
          "true ones, no one counting more than 2 m")
    way = max(np.linalg.norm(np.array([t.transform.translation.x, t.transform.translation.y, t.transform.translation.z])
                             - grove.lidar_at(np.array([seconds(t.header.stamp)]))[0][0]) for t in transforms)
    check(way < 0.02, f"{len(transforms)} transforms, at most {way * 1e3:.1f} mm from the true way")


check_log(sys.argv[1])
check_recording(sys.argv[2])
