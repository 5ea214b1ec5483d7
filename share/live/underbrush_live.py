"""A client of the sensor server `underbrush live`. It needs grpcio, grpcio-tools, numpy and the file sensor_server.proto
beside it: copy both files into your project."""
from __future__ import annotations

import pathlib
import sys
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import grpc
import numpy as np

sys.path.append(str(pathlib.Path(__file__).parent))  # where the proto file is looked for
proto, services = grpc.protos_and_services("sensor_server.proto")


def pose(position: Sequence[float], quaternion: Sequence[float] = (0, 0, 0, 1)) -> Any:
    """A pose (world from body): metres, and a unit quaternion x, y, z, w."""
    return proto.Pose(**dict(zip(("x", "y", "z", "qx", "qy", "qz", "qw"), (*position, *quaternion), strict=True)))


class SensorServer:
    """The sensors of a running server, which fire from one time to the next.

    Poses go on from firing to firing: each call gives those at its end, and the motion up to there is even. The last two
    poses are kept here, so that the beams are those of `simulate` for a trajectory of all poses, to the bit, and a server
    that was started anew goes on where the last one ended. Raises `grpc.RpcError`, whose `details()` is one line.
    """

    def __init__(self, address: str, token: str, start_s: float, vehicle: Any, **actors: Any) -> None:
        """Begins at the time `start_s` with the poses of the vehicle (or of the only sensor) and of actors."""
        self.channel = grpc.insecure_channel(address, [  # a connection of its own, made again in a moment if it is lost
            ("grpc.max_receive_message_length", 1 << 28), ("grpc.use_local_subchannel_pool", 1),
            ("grpc.initial_reconnect_backoff_ms", 100), ("grpc.max_reconnect_backoff_ms", 1000)])
        self.stub = services.SensorServerStub(self.channel)
        self.metadata = [("authorization", f"Bearer {token}")]
        self.start_s = self.time_s = start_s
        self.paths = {"": [(start_s, vehicle)], **{name: [(start_s, at)] for name, at in actors.items()}}

    def describe(self, world: str = "") -> Any:
        """What the server simulates in a world, which is opened if need be: a `Description`."""
        return self.stub.Describe(proto.DescribeRequest(world=world), metadata=self.metadata, timeout=60)

    def parts(self, until_s: float, vehicle: Any, actors: Mapping[str, Any] = {}, timeout: float = 60,
              **wanted: Any) -> Iterable[Any]:
        """Fires up to `until_s`, where vehicle and actors have these poses, and yields each `Part` of the answer.

        An actor with the value `None` is absent. The fields `columns`, `layout` and `world` of a request are given by
        `wanted`.
        """
        paths = {name: [*self.paths.get(name, [])[-2:], (until_s, at)] for name, at in {"": vehicle, **actors}.items()}
        motions = {name: proto.Motion(poses=[proto.StampedPose(time_s=t, world_from_body=at) for t, at in path])
                   for name, path in paths.items() if path[-1][1] is not None}
        request = proto.FireRequest(start_s=self.start_s, from_s=self.time_s, until_s=until_s, vehicle=motions.pop(""),
                                    actors=[proto.Actor(name=name, motion=motions.get(name), absent=name not in motions)
                                            for name in actors], **wanted)
        yield from self.stub.Fire(request, metadata=self.metadata, timeout=timeout, wait_for_ready=True)
        paths = {name: path for name, path in {**self.paths, **paths}.items() if path[-1][1] is not None}
        self.time_s, self.paths = until_s, paths

    def fire(self, until_s: float, vehicle: Any, actors: Mapping[str, Any] = {}, **wanted: Any) -> dict[str, Any]:
        """Fires as `parts` does, and returns the columns as arrays, (rows,) or (rows, 3)."""
        pieces: dict[str, list[Any]] = {}
        for part in self.parts(until_s, vehicle, actors, **wanted):
            for c in part.columns:
                values = np.frombuffer(c.data, c.type)
                pieces.setdefault(c.name, []).append(values if c.width == 1 else values.reshape(-1, c.width))
        return {name: np.concatenate(found) for name, found in pieces.items()}
