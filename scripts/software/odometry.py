"""Odometry by KISS-ICP over the scans of a log, and its errors against the poses of the log."""
import typing

import numpy as np

from .logs import Floats

VOXEL_M = 0.8
NEAREST_M, FARTHEST_M = 2.0, 100.0  # the returns that are registered; nearer ones are the vehicle itself


def rotation_vector(rotation: Floats) -> Floats:
    """Axis times angle, rad, (3), of a (3, 3) rotation by less than half a turn."""
    axis = np.array([rotation[2, 1] - rotation[1, 2], rotation[0, 2] - rotation[2, 0],
                     rotation[1, 0] - rotation[0, 1]]) / 2
    sine = float(np.linalg.norm(axis))
    angle = float(np.arctan2(sine, (np.trace(rotation) - 1) / 2))
    return axis * (angle / sine) if sine > 0 else axis


def relative_errors(true: typing.Sequence[Floats], estimated: typing.Sequence[Floats]) -> Floats:
    """What is wrong with each estimated step, (n - 1, 6): translation, m, and rotation vector, rad, of
    (true step)^-1 (estimated step), in the frame of the scan that is reached. Poses are (4, 4), the two worlds may
    differ."""
    out = np.zeros((len(true) - 1, 6))
    for k in range(1, len(true)):
        step = np.linalg.inv(true[k - 1]) @ true[k]
        error = np.linalg.inv(step) @ np.linalg.inv(estimated[k - 1]) @ estimated[k]
        out[k - 1, :3], out[k - 1, 3:] = error[:3, 3], rotation_vector(error[:3, :3])
    return out


def rmse(errors: Floats) -> float:
    """Root of the mean squared length of error vectors, (n, 3)."""
    return float(np.sqrt((errors ** 2).sum(axis=1).mean()))


def correlation(one: Floats, other: Floats) -> float:
    """Pearson's correlation of two series of error vectors, (n, 3), over all components. The mean of each component is
    taken away first, so that a bias that both have does not count as agreement."""
    a, b = one - one.mean(axis=0), other - other.mean(axis=0)
    return float((a * b).sum() / np.sqrt((a * a).sum() * (b * b).sum()))


def estimate(scans: typing.Sequence[Floats], first_step: Floats) -> list[Floats]:
    """Poses (4, 4) of de-skewed scans, (m, 3) in m, by KISS-ICP, in a world of its own. It begins with the true first
    step, since a start from rest at full speed can fail by luck, and runs in one thread, so that it repeats."""
    from kiss_icp.config.parser import KISSConfig
    from kiss_icp.kiss_icp import KissICP
    config = KISSConfig()
    config.mapping.voxel_size = VOXEL_M
    config.data.deskew = False
    config.data.min_range, config.data.max_range = NEAREST_M, FARTHEST_M
    config.registration.max_num_threads = 1
    odometry: typing.Any = KissICP(config)
    odometry.last_delta, odometry.last_pose = first_step, np.linalg.inv(first_step)
    out = []
    for points in scans:
        odometry.register_frame(points, np.array([]))
        out.append(np.array(odometry.last_pose))
    return out


def errors(scans: typing.Sequence[Floats], true: typing.Sequence[Floats]) -> Floats:
    """The errors of KISS-ICP over de-skewed scans, as `relative_errors` gives them."""
    return relative_errors(true, estimate(scans, np.linalg.inv(true[0]) @ true[1]))
