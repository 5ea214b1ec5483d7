"""Writes ROS recordings of messages of our own making into any storage, for the tests."""
from __future__ import annotations

import contextlib
import pathlib
from collections.abc import Iterator
from typing import Any

import numpy as np
import numpy.typing as npt
from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import StoragePlugin, Writer as Writer2
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

CLOUD, TF = "sensor_msgs/msg/PointCloud2", "tf2_msgs/msg/TFMessage"
ODOMETRY, POSE = "nav_msgs/msg/Odometry", "geometry_msgs/msg/PoseStamped"
KINDS = {"i1": 1, "u1": 2, "i2": 3, "u2": 4, "i4": 5, "u4": 6, "f4": 7, "f8": 8}


class Bag:
    """Writes messages of our own making into any storage."""

    def __init__(self, path: pathlib.Path, storage: str) -> None:
        self.ros1 = storage == "ros1"
        self.store = get_typestore(Stores.ROS1_NOETIC if self.ros1 else Stores.ROS2_HUMBLE)
        self.topics: dict[str, Any] = {}
        if self.ros1:
            self.store.register(get_types_from_msg("geometry_msgs/TransformStamped[] transforms", TF))
            self.writer: Any = Writer1(path)
        else:
            self.writer = Writer2(path, version=9, storage_plugin=StoragePlugin[storage.upper()])

    def header(self, time_s: float, frame: str) -> Any:
        stamp = self.store.types["builtin_interfaces/msg/Time"](sec=int(time_s), nanosec=round((time_s % 1) * 1e9))
        extra = {"seq": 0} if self.ros1 else {}
        return self.store.types["std_msgs/msg/Header"](stamp=stamp, frame_id=frame, **extra)

    def raw(self, topic: str, kind: str, time_s: float, content: bytes) -> None:
        if topic not in self.topics:
            self.topics[topic] = self.writer.add_connection(topic, kind, typestore=self.store)
        self.writer.write(self.topics[topic], round(time_s * 1e9), content)

    def send(self, topic: str, kind: str, time_s: float, message: Any) -> None:
        serialize = self.store.serialize_ros1 if self.ros1 else self.store.serialize_cdr
        self.raw(topic, kind, time_s, bytes(serialize(message, kind)))

    def cloud(self, topic: str, time_s: float, points: npt.NDArray[Any], frame: str = "lidar",
              bag_s: float | None = None, row_padding: int = 0) -> None:
        grid = points.reshape(1, -1) if points.ndim == 1 else points
        dtype = points.dtype
        assert dtype.fields is not None
        field = self.store.types["sensor_msgs/msg/PointField"]
        fields = [field(name=n, offset=dtype.fields[n][1], datatype=KINDS[dtype[n].str[1:]], count=1)
                  for n in dtype.names or ()]
        content = b"".join(row.tobytes() + b"\xff" * row_padding for row in grid)
        self.send(topic, CLOUD, time_s if bag_s is None else bag_s, self.store.types[CLOUD](
            header=self.header(time_s, frame), height=grid.shape[0], width=grid.shape[1], fields=fields,
            is_bigendian=dtype["x"].byteorder == ">", point_step=dtype.itemsize,
            row_step=dtype.itemsize * grid.shape[1] + row_padding, data=np.frombuffer(content, np.uint8),
            is_dense=False))

    def pose_parts(self, position: npt.NDArray[Any], q: npt.NDArray[Any]) -> tuple[Any, Any]:
        return [float(v) for v in position], self.store.types["geometry_msgs/msg/Quaternion"](*(float(v) for v in q))

    def transform(self, topic: str, time_s: float, parent: str, child: str, position: Any, q: Any) -> None:
        types = self.store.types
        at, turn = self.pose_parts(position, q)
        stamped = types["geometry_msgs/msg/TransformStamped"](
            header=self.header(time_s, parent), child_frame_id=child, transform=types["geometry_msgs/msg/Transform"](
                translation=types["geometry_msgs/msg/Vector3"](*at), rotation=turn))
        self.send(topic, TF, time_s, types[TF](transforms=[stamped]))

    def pose(self, topic: str, kind: str, time_s: float, parent: str, child: str, position: Any, q: Any) -> None:
        types = self.store.types
        at, turn = self.pose_parts(position, q)
        pose = types["geometry_msgs/msg/Pose"](position=types["geometry_msgs/msg/Point"](*at), orientation=turn)
        if kind == POSE:
            message = types[POSE](header=self.header(time_s, parent), pose=pose)
        else:
            zero = types["geometry_msgs/msg/Vector3"](0.0, 0.0, 0.0)
            none = np.zeros(36)
            message = types[ODOMETRY](
                header=self.header(time_s, parent), child_frame_id=child,
                pose=types["geometry_msgs/msg/PoseWithCovariance"](pose=pose, covariance=none),
                twist=types["geometry_msgs/msg/TwistWithCovariance"](
                    twist=types["geometry_msgs/msg/Twist"](linear=zero, angular=zero), covariance=none))
        self.send(topic, kind, time_s, message)


@contextlib.contextmanager
def bag(path: pathlib.Path, storage: str = "mcap") -> Iterator[Bag]:
    one = Bag(path, storage)
    with one.writer:
        yield one


def some_points(n: int = 64, kind: str = "f4", order: str = "<") -> np.ndarray:
    fields = [(name, order + kind) for name in "xyz"] + [("intensity", order + "f4"), ("ring", order + "u2")]
    points = np.zeros(n, fields)
    points["x"], points["y"], points["ring"] = np.linspace(1, 5, n), 2, np.arange(n) % 4
    points["intensity"] = np.arange(n)
    return points
