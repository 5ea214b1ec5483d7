"""A live sensor, for simulation in a closed loop."""
from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from underbrush import _core
from underbrush._core import BeamLog, Pose, Sensor
from underbrush.verbs import Mover, World, _options

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from underbrush._parameters import SimulateParameters


class Lidar:
    """A lidar in a world. Each call fires one revolution (or frame).

    `world` is a model or scene, as a value or a path; it is prepared for tracing once, here. `sensor` is a sensor or
    its name. `movers` are objects that move: (model or mesh, poses over time, material), as for `simulate`. `options`
    are those of `simulate`. Scan k draws its random numbers from (seed, k), so the same calls give the same bits. Calls
    from several threads wait for each other.
    """

    def __init__(self, world: World, sensor: Sensor | str, seed: int = 1, *, movers: Sequence[Mover] = (),
                 **options: Unpack[SimulateParameters]) -> None:
        self._sensor = sensor if isinstance(sensor, Sensor) else Sensor(sensor)
        self._core = _core.LidarCore(world, self._sensor, _options(seed, movers, options))

    @property
    def sensor(self) -> Sensor:
        """The sensor that is simulated."""
        return self._sensor

    @property
    def scans(self) -> int:
        """Number of the next scan."""
        return self._core.scans

    def reset(self) -> None:
        """Starts again with scan 0."""
        self._core.reset()

    def scan(self, pose_from: Pose | npt.NDArray[np.float64], pose_to: Pose | npt.NDArray[np.float64] | None = None,
             time: float = 0.0) -> BeamLog:
        """Fires the revolution that starts at `time` (s) and returns its beams, hits and misses.

        The sensor moves from `pose_from` at `time` to `pose_to` at the end of the revolution (by default it stands
        still); both are world from sensor, a `Pose` or a 4 x 4 matrix. Moving objects have their poses at the time of
        each beam. Raises `ValueError` for a matrix that is no rigid transform.
        """
        return self._core.scan(pose_from, pose_from if pose_to is None else pose_to, time)

    def fire(self, pose_from: Pose | npt.NDArray[np.float64], pose_to: Pose | npt.NDArray[np.float64], time: float,
             until: float) -> BeamLog:
        """Fires from `time` to `until` (s), such as a tenth of a revolution, and returns these beams.

        The sensor moves from `pose_from` to `pose_to` meanwhile. A call that begins where the last one ended goes on
        with its revolution, and all of them have the bits of one `simulate` along their poses. Any other call begins a
        new scan. Raises `ValueError` for times that are not finite or not in order, and as `scan` does.
        """
        return self._core.fire(pose_from, pose_to, time, until)
