"""Live sensors, for simulation in a closed loop."""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from underbrush import _core
from underbrush._core import BeamLog, Model, PointCloud, Pose, Sensor, Trajectory
from underbrush.verbs import Mover, Path, World, _options, _sensor

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from underbrush._parameters import SimulateParameters

AnyPose = Pose | npt.NDArray[np.float64]
#: Poses of actors at the end of a firing, or their motions over its time; `None` for those that no beam meets.
Actors = Mapping[str, AnyPose | Trajectory | None]


class Lidar:
    """A lidar, or the sensors of a rig (YAML), in a world: what the server `underbrush live` has, in process.

    `world` is a model or scene, as a value or a path; it is prepared for tracing once, here. `sensor` is a sensor or
    its name. `movers` are objects that move: (model or mesh, poses over time, material), as for `simulate`, or names
    with a model or mesh each, which are absent until a call gives them a pose. `options` are those of `simulate`, such
    as `actors`. Scan k draws its random numbers from (seed, k), so the same calls give the same bits. Calls from
    several threads wait for each other.

    Each call may give `actors` poses, by name. Such a pose is the one at the end of the call, and the motion to it from
    the pose of an earlier call is even; without an earlier one, the actor stands there during the call. Actors that a
    call does not name move as in the file of the world. The beams of a rig come in order of time, and their extra
    column `sensor` has the index of the sensor in `sensors`.
    """

    def __init__(self, world: World, sensor: Sensor | str | None = None, seed: int = 1, *, rig: Path | None = None,
                 movers: Sequence[Mover] | Mapping[str, Model | Path] = (),
                 **options: Unpack[SimulateParameters]) -> None:
        core = _options(seed, () if isinstance(movers, Mapping) else movers, options)
        if isinstance(movers, Mapping):
            core.absent = dict(movers)
        self._core = _core.LidarCore(world, core, _sensor(sensor), rig)

    @property
    def sensor(self) -> Sensor:
        """The sensor that is simulated; of a rig, the first one."""
        return self._core.sensor

    @property
    def sensors(self) -> dict[str, Sensor]:
        """The sensors by their names in the rig, in its order."""
        return self._core.sensors

    @property
    def actors(self) -> list[str]:
        """The names of everything that moves."""
        return self._core.actors

    @property
    def scans(self) -> int:
        """Number of the next scan."""
        return self._core.scans

    def reset(self) -> None:
        """Starts again with scan 0."""
        self._core.reset()

    def scan(self, pose_from: AnyPose, pose_to: AnyPose | None = None, time: float = 0.0, *,
             actors: Actors = {}) -> BeamLog:
        """Fires the revolution that starts at `time` (s) and returns its beams, hits and misses.

        The sensor (or the vehicle of the rig) moves from `pose_from` at `time` to `pose_to` at the end of the
        revolution (by default it stands still); both are world from sensor, a `Pose` or a 4 x 4 matrix. Moving objects
        have their poses at the time of each beam. Raises `ValueError` for a matrix that is no rigid transform, and for
        unknown actors.
        """
        return self._core.scan(pose_from, pose_from if pose_to is None else pose_to, time, actors)

    def fire(self, pose_from: AnyPose, pose_to: AnyPose, time: float, until: float, *, actors: Actors = {}) -> BeamLog:
        """Fires from `time` to `until` (s), such as a tenth of a revolution, and returns these beams.

        The sensor moves from `pose_from` to `pose_to` meanwhile. A call that begins where the last one ended goes on
        with its revolution, and all of them have the bits of one `simulate` along their poses. Any other call begins a
        new scan. Raises `ValueError` for times that are not finite or not in order, and as `scan` does.
        """
        return self._core.fire(pose_from, pose_to, time, until, actors)

    def fire_clouds(self, pose_from: AnyPose, pose_to: AnyPose, time: float, until: float, *, actors: Actors = {},
                    layout: str = "velodyne") -> list[PointCloud]:
        """Fires as `fire` does, and returns the cloud of each sensor, in the layout of a driver.

        The layouts are velodyne, ouster and autoware.
        """
        return self._core.fire_clouds(pose_from, pose_to, time, until, actors, layout)
