"""Logs for the tests of formats: files of the real data where they are there, and generated logs.

Import this before the package: where the package is not installed, its sources in this checkout are taken.
"""
from __future__ import annotations

import importlib.util
import os
import pathlib
import sys
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

if importlib.util.find_spec("underbrush") is None:
    sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from underbrush.formats.scans import Poses  # noqa: E402

Columns = dict[str, npt.NDArray[Any]]

_BESIDE = pathlib.Path(__file__).resolve().parents[2].parent / "shared" / "data"


def data(*parts: str) -> pathlib.Path:
    """A file of the real data; skips the test where it is absent."""
    path = pathlib.Path(os.environ.get("UNDERBRUSH_DATA", str(_BESIDE))).joinpath(*parts)
    if not path.exists():
        pytest.skip(f"no real data: {path} is absent (set UNDERBRUSH_DATA)")
    return path


def straight_path(start_s: float = 0.0, end_s: float = 1.0, poses: int = 11) -> Poses:
    """Poses along a gentle curve, 2 m/s, turning 20 degrees and tilted a little."""
    time = np.linspace(start_s, end_s, poses)
    share = np.linspace(0, 1, poses)
    half = np.deg2rad(10) * share
    rotation = np.column_stack([np.full(poses, 0.02), np.full(poses, -0.01), np.sin(half), np.cos(half)])
    rotation /= np.linalg.norm(rotation, axis=1, keepdims=True)
    return Poses(time, np.column_stack([2 * (time - start_s) + 5e5, np.sin(share) + 4e6, 100 + share]), rotation)


def generated_log(scans: int = 3, rings: int = 16, columns: int = 180, start_s: float = 0.0, misses: bool = True,
                  echoes: int = 1, seed: int = 1) -> tuple[Columns, Poses]:
    """A spinning sensor that moves: world-frame beams in order of time, and its poses."""
    from underbrush.formats.trajectory import pose_at, rotate

    rng = np.random.default_rng(seed)
    poses = straight_path(start_s - 0.05, start_s + 0.1 * scans + 0.05)
    firing = np.arange(scans * columns)
    time = start_s + np.repeat(firing * (0.1 / columns), rings)
    ring = np.tile(np.arange(rings), len(firing)).astype(np.uint16)
    azimuth = np.repeat(-2 * np.pi * (firing % columns + 0.5) / columns, rings)
    elevation = np.deg2rad(np.linspace(-15, 15, rings))[ring]
    direction = np.column_stack([np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth),
                                 np.sin(elevation)])
    position, rotation, _ = pose_at(poses, time)
    range_m = rng.uniform(2, 60, len(time)).astype(np.float32)
    if misses:
        range_m[rng.random(len(time)) < 0.3] = np.inf
    log: Columns = {
        "origin": position, "direction": rotate(rotation, direction).astype(np.float32), "range_m": range_m,
        "intensity": np.where(np.isfinite(range_m), rng.integers(1, 200, len(time)), 0).astype(np.float32),
        "time_s": time, "ring": ring, "scan": np.repeat(firing // columns, rings).astype(np.uint32),
        "packet": np.zeros(len(time), np.uint32), "flags": np.zeros(len(time), np.uint8)}
    if echoes > 1:
        log = _with_echoes(log, echoes, rng)
    return log, poses


def _with_echoes(log: Columns, most: int, rng: np.random.Generator) -> Columns:
    hit = np.isfinite(log["range_m"])
    count = np.where(hit, rng.integers(1, most + 1, len(hit)), 1)
    rows = np.repeat(np.arange(len(hit)), count)
    number = np.arange(len(rows)) - np.repeat(np.cumsum(count) - count, count) + 1
    out = {name: column[rows] for name, column in log.items()}
    out["range_m"] = (out["range_m"] + np.float32(1.5) * (number - 1)).astype(np.float32)
    out["intensity"] = np.where(hit[rows], np.maximum(1, out["intensity"] - 10 * (number - 1)), 0).astype(np.float32)
    out["echo"] = np.where(hit[rows], number, 0).astype(np.uint8)
    out["echoes"] = np.where(hit[rows], count[rows], 0).astype(np.uint8)
    out["pulse_width"] = np.where(hit[rows], 0.7, 0).astype(np.float32)
    return out


def pieces(log: Columns, rows: int = 1000) -> list[Columns]:
    """The log in pieces that do not care for scans."""
    n = len(log["range_m"])
    return [{name: column[begin:begin + rows] for name, column in log.items()} for begin in range(0, n, rows)]


def joined(parts: list[Columns]) -> Columns:
    return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}


def end_points(log: Columns) -> npt.NDArray[np.float64]:
    """World coordinates of the hits."""
    hit = np.isfinite(log["range_m"])
    d = log["direction"][hit].astype(np.float64)
    d /= np.linalg.norm(d, axis=1, keepdims=True)
    points: npt.NDArray[np.float64] = log["origin"][hit] + log["range_m"][hit].astype(np.float64)[:, None] * d
    return points
