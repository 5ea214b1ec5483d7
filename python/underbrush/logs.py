"""Logs from arrays, and the shape of ellipsoids."""
from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import numpy.typing as npt

from underbrush._core import BeamLog, EllipsoidTable, LogInfo


def log_from_columns(*, origin: npt.ArrayLike, direction: npt.ArrayLike, range_m: npt.ArrayLike,
                     time_s: npt.ArrayLike | None = None, intensity: npt.ArrayLike | None = None,
                     ring: npt.ArrayLike | None = None, scan: npt.ArrayLike | None = None,
                     packet: npt.ArrayLike | None = None, flags: npt.ArrayLike | None = None,
                     extra: Mapping[str, npt.ArrayLike] | None = None, info: LogInfo | None = None) -> BeamLog:
    """Makes a log from arrays of n rows; they are copied once, into the log.

    `origin` (n, 3) m, world; `direction` (n, 3) unit vectors, world; `range_m` (n,) m, infinity for a miss; the others
    (n,), zero where left out. `extra` gives further columns by name, of int8 to int32, uint8 to uint32, float32 or
    float64. Without `info`, `has_misses` of the log is true if there is a miss among the rows. To copy nothing, fill
    the views of `BeamLog(n)` instead.

    Raises `ValueError` for a column of another length or shape, for directions that are not unit vectors, for ranges that
    are not positive and for integers that a column cannot hold, and `TypeError` for a column of another kind of number.
    """
    ranges = np.asarray(range_m)
    if info is None:
        info = LogInfo(has_misses=bool(np.isinf(ranges).any()))
    log = BeamLog(len(ranges), info)
    columns = {"origin": origin, "direction": direction, "range_m": ranges, "time_s": time_s, "intensity": intensity,
               "ring": ring, "scan": scan, "packet": packet, "flags": flags}
    for name, given in columns.items():
        if given is not None:
            _fill(getattr(log, name), given, name)
    _check_beams(log)
    for name, given in (extra or {}).items():
        values = np.asarray(given)
        _fill(log.add_column(name, values.dtype), values, name)
    return log


def _check_beams(log: BeamLog) -> None:
    with np.errstate(over="ignore", invalid="ignore"):
        square = np.einsum("ij,ij->i", log.direction, log.direction)
    bad = np.flatnonzero(~(np.abs(square - 1) < 2e-3))
    if len(bad):
        raise ValueError(f"log: the direction of row {bad[0]} is not a unit vector: its length is "
                         f"{np.sqrt(square[bad[0]]):g}")
    bad = np.flatnonzero(~(log.range_m > 0))
    if len(bad):
        raise ValueError(f"log: the range of row {bad[0]} is {log.range_m[bad[0]]:g}: it must be positive, infinity "
                         "for a miss")


def _fill(view: npt.NDArray[np.generic], given: npt.ArrayLike, name: str) -> None:
    values = np.asarray(given)
    if values.shape != view.shape:
        raise ValueError(f"log: the column {name} has the shape {values.shape}, expected {view.shape}")
    whole = values.dtype.kind in "iu" and view.dtype.kind in "iu"
    if whole and values.size and not np.can_cast(values.dtype, view.dtype):
        bounds = np.iinfo(view.dtype)
        if values.min() < bounds.min or values.max() > bounds.max:
            raise ValueError(f"log: the column {name} has numbers beyond {bounds.min} to {bounds.max}")
    np.copyto(view, values, casting="unsafe" if whole else "same_kind")


def ellipsoid_axes(ellipsoids: EllipsoidTable) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Returns new arrays: standard deviations (n, 3), m, rising, and axes (n, 3, 3), unit vectors in columns."""
    matrices = np.empty((len(ellipsoids), 3, 3))
    places = ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))
    for k, (i, j) in enumerate(places):
        matrices[:, i, j] = matrices[:, j, i] = ellipsoids.covariance[:, k]
    variances, axes = np.linalg.eigh(matrices)
    return np.sqrt(np.maximum(variances, 0)), axes
