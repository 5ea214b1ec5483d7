"""Range images of a scan, and maps of the errors of its simulation."""
from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap, Normalize
from matplotlib.image import AxesImage
from matplotlib.patches import Patch

from underbrush._core import BeamLog
from underbrush.plot._figure import AMOUNT, FALSE_HIT, FALSE_MISS, MISS, SIGNED, Array, axes_or_new

_RINGS = (4, 512)  # numbers of rings that make rows; other logs have rows of equal elevation
_ELEVATION_ROWS = 64
_WIDEST_GAP = 4  # pixels; a log may lack columns, and rings are shifted against each other


@dataclass(frozen=True)
class Panorama:
    """Where the beams of a scan stand in a picture: a row a ring, the highest on top; azimuth falls from left to right,
    as seen from the sensor."""

    row: npt.NDArray[np.int64]  #: (rows, columns): the log's row that each pixel shows, -1 for none.
    elevation_rad: Array  #: (rows,), rad: mean elevation of each row in the sensor's frame.
    left_rad: float  #: Azimuth of the left edge, rad, counter-clockwise from forward.
    right_rad: float  #: Azimuth of the right edge, rad.

    def image(self, values: npt.ArrayLike) -> Array:
        """Returns the picture (rows, columns) of a value for each of the log's rows; NaN where no beam points."""
        given = np.asarray(values, dtype=float)
        return np.where(self.row >= 0, given[self.row], np.nan)


def _sensor_frame(log: BeamLog, rows: npt.NDArray[np.int64], scan: int) -> Array:
    """Directions (n, 3) in the frame that the sensor had at the scan's time; in the world's without a pose."""
    directions = log.direction[rows].astype(float)
    for info in log.info.scans:
        if info.scan == scan:
            return np.asarray(directions @ info.world_from_sensor.matrix()[:3, :3])
    return directions


def panorama(log: BeamLog, scan: int | None = None, columns: int | None = None) -> Panorama:
    """Places the beams of a scan (by default the log's first) in a picture.

    Where several rows of the log share a pixel, the first is shown; gaps of up to 4 pixels between the beams of a row
    are filled with the nearer beam. Logs with fewer than 4 or more than 512 rings have 64 rows of equal elevation.
    Raises `ValueError` where the log has no beam of the scan.
    """
    if scan is None:
        scan = int(log.scan[0]) if len(log) else 0
    rows = np.flatnonzero(log.scan == scan)
    if not len(rows):
        raise ValueError(f"panorama: the log has no beam of scan {scan}")
    direction = _sensor_frame(log, rows, scan)
    azimuth = np.arctan2(direction[:, 1], direction[:, 0])
    elevation = np.arcsin(np.clip(direction[:, 2], -1, 1))
    rings, of_ring = np.unique(log.ring[rows], return_inverse=True)
    if _RINGS[0] <= len(rings) <= _RINGS[1]:
        mean = np.bincount(of_ring, elevation) / np.bincount(of_ring)
        place = np.empty(len(rings), dtype=np.int64)
        place[np.argsort(-mean, kind="stable")] = np.arange(len(rings))
        y, height = place[of_ring], -np.sort(-mean)
    else:
        top, bottom = elevation.max(), elevation.min()
        step = max((top - bottom) / _ELEVATION_ROWS, 1e-9)
        y = np.clip(((top - elevation) / step).astype(np.int64), 0, _ELEVATION_ROWS - 1)
        height = top - step * (np.arange(_ELEVATION_ROWS) + 0.5)
    n = columns or int(np.clip(np.bincount(y).max(), 64, 2048))
    left, right = float(azimuth.max()), float(azimuth.min())
    x = np.clip(((left - azimuth) / max(left - right, 1e-9) * n).astype(np.int64), 0, n - 1)
    pixel = np.full((len(height), n), -1, dtype=np.int64)
    pixel[y[::-1], x[::-1]] = rows[::-1]  # of several rows the last that is written stays: the first of the log
    return Panorama(_without_gaps(pixel), height, left, right)


def _without_gaps(pixel: npt.NDArray[np.int64]) -> npt.NDArray[np.int64]:
    """Fills gaps of a few pixels between two beams of a row with the nearer one."""
    column = np.arange(pixel.shape[1])
    before = np.maximum.accumulate(np.where(pixel >= 0, column, -_WIDEST_GAP - 2), axis=1)
    after = np.minimum.accumulate(np.where(pixel >= 0, column, 1 << 40)[:, ::-1], axis=1)[:, ::-1]
    nearer = np.where(column - before <= after - column, before, after)
    fills = after - before <= _WIDEST_GAP + 1
    return np.where(fills, np.take_along_axis(pixel, np.where(fills, nearer, 0), axis=1), -1)


def _show(ax: Axes, where: Panorama, image: Array, **keywords: Any) -> AxesImage:
    """Draws a picture with azimuth and elevation in degrees along its edges."""
    rows = len(where.elevation_rad)
    extent = (np.degrees(where.left_rad), np.degrees(where.right_rad), rows - 0.5, -0.5)
    shown = ax.imshow(image, extent=extent, aspect="auto", interpolation="nearest", **keywords)
    ticks = np.unique(np.linspace(0, rows - 1, min(rows, 5)).round().astype(int))
    ax.set_yticks(ticks, [f"{np.degrees(where.elevation_rad[t]):.0f}" for t in ticks])
    ax.set_xlabel("azimuth, °")
    ax.set_ylabel("elevation, °")
    return shown


def _column(log: BeamLog, value: str | npt.ArrayLike) -> tuple[Array, str]:
    """A value for each row, infinite or NaN where there is none, and its name with the unit."""
    if not isinstance(value, str):
        return np.asarray(value, dtype=float), ""
    units = {"range_m": "range, m", "time_s": "time, s"}
    if value in log.extra:
        return log.extra[value].astype(float), value
    if value not in ("range_m", "intensity", "time_s", "ring", "packet", "flags"):
        raise ValueError(f"range_image: the log has no column '{value}'")
    return np.asarray(getattr(log, value), dtype=float), units.get(value, value)


def range_image(log: BeamLog, value: str | npt.ArrayLike = "range_m", *, scan: int | None = None,
                ax: Axes | None = None, cmap: str = AMOUNT, limits: tuple[float, float] | None = None,
                colorbar: bool = True, columns: int | None = None) -> Axes:
    """Draws a scan of a log as seen from its sensor, by default the range of the first one.

    `value` is a column ("range_m", "intensity", the name of a further one) or an array (n,) with a value for each row
    of the log. Misses are grey; places into which no beam points are white. `limits` are the values at the ends of the
    map, by default 0 and the 99th percentile for ranges, and the extremes for others. Raises `ValueError` for an
    unknown column or scan.
    """
    where = panorama(log, scan, columns)
    values, label = _column(log, value)
    image = where.image(np.where(np.isfinite(log.range_m), values, np.inf))
    finite = image[np.isfinite(image)]
    if limits is None:
        ends = np.percentile(finite, [0, 99 if value is not None and label == "range, m" else 100]) if len(finite) \
            else np.array([0.0, 1.0])
        limits = (0.0 if label == "range, m" else float(ends[0]), float(ends[1]))
    ax = axes_or_new(ax)
    misses = np.ma.masked_where(~np.isposinf(image), np.ones_like(image))
    _show(ax, where, misses, cmap=ListedColormap([MISS]), vmin=0, vmax=1)
    shown = _show(ax, where, np.ma.masked_invalid(image), cmap=cmap, norm=Normalize(*limits))
    if colorbar:
        ax.figure.colorbar(shown, ax=ax, label=label, extend="max" if (finite > limits[1]).any() else "neither")
    return ax


def _packet_means(real: BeamLog, simulated: BeamLog, both: npt.NDArray[np.bool_]) -> Array:
    """For each row the mean distance, m, of real and simulated points over its packet; NaN where none returned."""
    key = real.scan.astype(np.int64) << 32 | real.packet
    _, of_packet = np.unique(key, return_inverse=True)
    distance = np.zeros(len(real))
    points = (real.end_points()[both], simulated.end_points()[both])
    distance[both] = np.linalg.norm(points[0] - points[1], axis=1)
    total = np.bincount(of_packet, distance)
    with np.errstate(invalid="ignore"):
        return np.asarray((total / np.bincount(of_packet, both))[of_packet])


def error_map(real: BeamLog, simulated: BeamLog, what: str = "range", *, scan: int | None = None,
              limit_m: float | None = None, ax: Axes | None = None, legend: bool = True,
              columns: int | None = None) -> Axes:
    """Draws where the simulation of a log's beams is wrong, for one scan (by default the first).

    With `what` "range" each beam that returned in both logs has the colour of its simulated minus its measured range,
    up to ±`limit_m` (default 1 m); with "packet" that of its packet's mean distance between real and simulated points,
    whose mean over packets is the packet error. False hits, false misses and true misses have colours of their own, of
    which the legend gives the shares. Raises `ValueError` where the logs differ in length.
    """
    if len(real) != len(simulated):
        raise ValueError(f"error_map: {len(real)} real beams but {len(simulated)} simulated ones")
    if what not in ("range", "packet"):
        raise ValueError(f"error_map: what is range or packet, not '{what}'")
    hit, simulated_hit = np.isfinite(real.range_m), np.isfinite(simulated.range_m)
    both = hit & simulated_hit
    if what == "range":
        error = np.subtract(simulated.range_m, real.range_m, out=np.full(len(real), np.nan), where=both)
    else:
        error = np.where(both, _packet_means(real, simulated, both), np.nan)
    kind = np.select([both, simulated_hit, hit], [0, 1, 2], 3)  # true hit, false hit, false miss, true miss
    where = panorama(real, scan, columns)
    kinds, errors = where.image(kind), np.ma.masked_invalid(where.image(error))
    limit = limit_m or (1.0 if what == "range" or not errors.count() else float(np.percentile(errors.compressed(), 99)))
    ax = axes_or_new(ax)
    colours = [FALSE_HIT, FALSE_MISS, MISS]
    _show(ax, where, np.ma.masked_where(~(kinds > 0), kinds), cmap=ListedColormap(colours), vmin=0.5, vmax=3.5)
    shown = _show(ax, where, errors, cmap=SIGNED if what == "range" else AMOUNT,
                  norm=Normalize(-limit if what == "range" else 0.0, limit))
    label = "simulated − measured range, m" if what == "range" else "mean error of the packet, m"
    ax.figure.colorbar(shown, ax=ax, label=label, extend="both" if what == "range" else "max")
    if legend:
        _legend_of_kinds(ax, kind[real.scan == real.scan[where.row.max()]], colours)
    return ax


def _legend_of_kinds(ax: Axes, kinds: npt.NDArray[np.int64], colours: Sequence[str]) -> None:
    """Names the colours of false hits, false misses and true misses above the picture, with their shares of beams."""
    names = ("false hit", "false miss", "true miss")
    ax.legend(handles=[Patch(color=colour, label=f"{name} {(kinds == k + 1).mean():.1%}")
                       for k, (name, colour) in enumerate(zip(names, colours, strict=True))],
              loc="lower left", bbox_to_anchor=(0, 1), ncols=3, frameon=False)
