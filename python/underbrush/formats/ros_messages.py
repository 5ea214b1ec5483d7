"""ROS messages with point clouds, and the message types as rosbags decodes and encodes them."""
from __future__ import annotations

import functools
from typing import Any

import numpy as np
import numpy.typing as npt

from ._files import need

CLOUD = "sensor_msgs/msg/PointCloud2"
CUSTOM = ("livox_ros_driver/msg/CustomMsg", "livox_ros_driver2/msg/CustomMsg")
FIELD_TYPES = ("", "i1", "u1", "i2", "u2", "i4", "u4", "f4", "f8")  #: By sensor_msgs/PointField's number.


@functools.cache
def typestore(ros1: bool) -> Any:
    """The message types of ROS, as rosbags decodes and encodes them.

    A recording's own definitions are not used: these types do not change, and foreign text is not made into code.
    """
    types = need("rosbags.typesys")
    store = types.get_typestore(types.Stores.ROS1_NOETIC if ros1 else types.Stores.ROS2_HUMBLE)
    if ros1:
        for name in ("tf2_msgs/msg/TFMessage", "tf/msg/tfMessage"):
            store.register(types.get_types_from_msg("geometry_msgs/TransformStamped[] transforms", name))
    return store


def seconds(stamp: Any) -> float:
    """A ROS time as seconds."""
    return float(stamp.sec) + float(stamp.nanosec) * 1e-9


def frame_name(name: str) -> str:
    return str(name).strip("/")


def cloud_points(message: Any) -> npt.NDArray[np.void]:
    """The points of a sensor_msgs/PointCloud2 as a structured array (rows, columns), a view of its bytes.

    `ValueError` where the message's sizes contradict each other.
    """
    order = ">" if message.is_bigendian else "<"
    fields = [f for f in message.fields if f.count <= 1 and 0 < f.datatype < len(FIELD_TYPES)]
    dtype = np.dtype({"names": [f.name for f in fields], "formats": [order + FIELD_TYPES[f.datatype] for f in fields],
                      "offsets": [f.offset for f in fields], "itemsize": message.point_step})
    rows, columns, row_step = int(message.height), int(message.width), int(message.row_step)
    if rows == 1 or row_step == 0:
        row_step = columns * dtype.itemsize
    if not dtype.itemsize or row_step < columns * dtype.itemsize or rows * row_step > len(message.data):
        raise ValueError(f"{rows} x {columns} points of {dtype.itemsize} bytes do not fit {len(message.data)} bytes")
    return np.ndarray((rows, columns), dtype, message.data, 0, (row_step, dtype.itemsize))


def livox_points(raw: bytes, ros1: bool) -> tuple[npt.NDArray[np.void], float, str]:
    """The points of a Livox CustomMsg (1, n), its stamp (s) and its frame. `ValueError` where it is too short."""
    if len(raw) < 48:
        raise ValueError("too short for a Livox message")
    # Both begin with four bytes (sequence number or representation), then s, ns and the frame's length.
    sec, nsec, length = (int(v) for v in np.frombuffer(raw, "<u4", 3, 4))
    frame = bytes(raw[16:16 + length]).rstrip(b"\0").decode(errors="replace")
    at = 16 + length
    if not ros1:
        at = 4 + (at - 4 + 7) // 8 * 8
    at += 8 + 4 + 4
    step = 19 if ros1 else 20
    if len(raw) < at + 4:
        raise ValueError("too short for a Livox message")
    count = int(np.frombuffer(raw, "<u4", 1, at)[0])
    if count and at + 4 + count * step - (step - 19) > len(raw):
        raise ValueError(f"{count} points do not fit {len(raw)} bytes")
    dtype = np.dtype({"names": ["offset_time", "x", "y", "z", "reflectivity", "tag", "line"],
                      "formats": ["<u4", "<f4", "<f4", "<f4", "u1", "u1", "u1"],
                      "offsets": [0, 4, 8, 12, 16, 17, 18], "itemsize": step})
    padded = bytes(raw) + b"\0" if step == 20 else raw  # The last point has no padding.
    points = np.ndarray((1, count), dtype, padded, at + 4)
    return points, float(sec) + float(nsec) * 1e-9, frame
