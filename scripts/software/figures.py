"""The figures of the study: what software makes of a source's scans, against what it makes of the real ones."""
import typing

import numpy as np

from . import ground, odometry
from .logs import Floats, Log, clouds

Figures = dict[str, typing.Any]
PARTS = {"translation": slice(0, 3), "rotation": slice(3, 6)}
RESAMPLES = 1000
EVERY, NEIGHBOURS, NEAR_M = 16, 10, 0.5  # of `scan_difference`


def interval(real: Floats, sources: typing.Sequence[Floats]) -> tuple[float, float]:
    """The 95 % interval of the ratio of RMSEs: steps are drawn with replacement, the same for both, and a seed."""
    random = np.random.default_rng(1)
    ratios = []
    for _ in range(RESAMPLES):
        steps = random.integers(len(real), size=len(real))
        source = sources[int(random.integers(len(sources)))]
        ratios.append(odometry.rmse(source[steps]) / odometry.rmse(real[steps]))
    low, high = np.percentile(ratios, [2.5, 97.5])
    return float(low), float(high)


def odometry_figures(real: Floats, sources: typing.Sequence[Floats]) -> Figures:
    """RMSE (m, rad), its ratio to the real one and the correlation with the real errors, means over the seeds; all
    errors are (n, 6) as `odometry.errors` gives them. Ratios and correlations of each seed are listed, too."""
    out: Figures = {"steps": len(real)}
    for part, columns in PARTS.items():
        true = real[:, columns]
        errors = [source[:, columns] for source in sources]
        ratios = [odometry.rmse(error) / odometry.rmse(true) for error in errors]
        correlations = [odometry.correlation(error, true) for error in errors]
        out[part] = {"rmse": float(np.mean([odometry.rmse(error) for error in errors])),
                     "ratio": float(np.mean(ratios)), "ratio_interval": interval(true, errors),
                     "correlation": float(np.mean(correlations)), "ratios": ratios, "correlations": correlations}
    return out


def scan_difference(log: Log) -> float:
    """How much successive scans differ, m: the median distance of a point to the plane of the NEIGHBOURS points nearest
    to it in the scan before, of every EVERY-th point that has them within NEAR_M; NaN of a single scan."""
    from scipy.spatial import KDTree
    end, before = log.end_points(), None
    distances: list[Floats] = []
    for _, rows in log.scans():
        points = end[rows]
        points = points[~np.isnan(points[:, 0])]
        if before is not None:
            some = points[::EVERY]
            reach, index = KDTree(before).query(some, k=NEIGHBOURS, distance_upper_bound=NEAR_M)
            full = np.isfinite(reach[:, -1])
            near = before[index[full]]
            centre = near.mean(axis=1)
            apart = near - centre[:, None]
            _, axes = np.linalg.eigh(np.einsum("nki,nkj->nij", apart, apart))
            distances.append(np.abs(((some[full] - centre) * axes[:, :, 0]).sum(axis=1)))
        before = points
    return float(np.median(np.concatenate(distances))) if distances else float("nan")


class Real:
    """The held-out scans as they were measured, and what the software makes of them."""

    def __init__(self, log: Log, moves: bool):
        self.log = log
        first = next(rows for _, rows in log.scans())
        pose = log.poses()[0]
        points = (log.end_points()[first] - pose[:3, 3]) @ pose[:3, :3]
        self.height_m = ground.sensor_height(points[~np.isnan(points[:, 0])])
        self.ground = ground.labels(log, self.height_m)
        self.difference_m = scan_difference(log)
        self.errors = self.errors_of(log) if moves else None

    def errors_of(self, log: Log) -> Floats:
        """The errors of odometry over a log of the same beams."""
        return odometry.errors(clouds(log), log.poses())

    def odometry(self, sources: typing.Sequence[Log]) -> Figures:
        """Figures of odometry over what a source answers, one log for each seed."""
        assert self.errors is not None
        return odometry_figures(self.errors, [self.errors_of(log) for log in sources])

    def scans(self, sources: typing.Sequence[Log], halved: bool = False) -> Figures:
        """Figures of ground and of successive scans, means over the sources. `halved`: the sources have some beams
        only, and are compared on these."""
        rows = [~np.isnan(log.range_m) if halved else None for log in sources]
        found = [ground.labels(log, self.height_m) for log in sources]
        real_share = ground.share(self.ground, self.log)
        return {
            "ground_share_ratio": float(np.mean([ground.share(g, log) for g, log in zip(found, sources)]) / real_share),
            "ground_agreement": float(np.mean([ground.agreement(self.ground, self.log, g, log, some)
                                               for g, log, some in zip(found, sources, rows)])),
            "difference_ratio": float(np.mean([scan_difference(log) for log in sources]) / self.difference_m)}

    def own_figures(self) -> Figures:
        """What the software makes of the real scans themselves."""
        out: Figures = {"ground_share": ground.share(self.ground, self.log), "sensor_height_m": self.height_m,
                        "difference_m": self.difference_m}
        if self.errors is not None:
            out.update(steps=len(self.errors), **{f"{part}_rmse": odometry.rmse(self.errors[:, columns])
                                                  for part, columns in PARTS.items()})
        return out
