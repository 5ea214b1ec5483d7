"""Poses in ROS recordings: a tree of frames from /tf and /tf_static, odometry, paths, and stamped poses and transforms."""
from __future__ import annotations

import array
import collections
from typing import Any

import numpy as np

from .ros_messages import frame_name, seconds
from .scans import Poses
from .trajectory import compose, in_order

#: Message types with poses, by the name that rosbags gives them.
POSE_TYPES = {"tf2_msgs/msg/TFMessage": "tf", "tf/msg/tfMessage": "tf", "nav_msgs/msg/Odometry": "odometry",
              "geometry_msgs/msg/PoseStamped": "pose", "geometry_msgs/msg/PoseWithCovarianceStamped": "covariance",
              "geometry_msgs/msg/TransformStamped": "transform", "nav_msgs/msg/Path": "path"}
_FIXED = ("map", "world", "odom", "earth", "local", "utm")  # Names of frames that do not move.


class _Samples:
    """The poses of one frame seen from another, eight numbers a pose."""

    def __init__(self, static: bool) -> None:
        self.static, self.rows = static, array.array("d")

    def add(self, time_s: float, position: Any, q: Any) -> None:
        self.rows.extend((time_s, position.x, position.y, position.z, q.x, q.y, q.z, q.w))

    def poses(self) -> Poses:
        table = np.array(self.rows).reshape(-1, 8)
        if self.static:
            table = table[-1:]
        return in_order(table[:, 0], table[:, 1:4], table[:, 4:])

    def bad(self) -> int:
        """Number of poses that are no rotations or not finite."""
        table = np.array(self.rows).reshape(-1, 8)
        with np.errstate(over="ignore"):
            norm = np.linalg.norm(table[:, 4:], axis=1)
        return int(np.count_nonzero(~(np.isfinite(table).all(axis=1) & (np.abs(norm - 1) < 0.005))))


class FrameTree:
    """Collects pose messages and answers with the poses of a lidar's frame in the world."""

    def __init__(self) -> None:
        self.bad = 0  #: Poses left out because they are no rotations or not finite.
        self._edges: dict[str, dict[str, _Samples]] = collections.defaultdict(dict)  # child: {parent: samples}
        self._topics: dict[str, tuple[str, str, _Samples]] = {}  # topic: parent, child, samples

    def add(self, kind: str, topic: str, message: Any) -> None:
        """Adds a message of a kind of `POSE_TYPES`."""
        if kind == "tf":
            for t in message.transforms:
                child, parent = frame_name(t.child_frame_id), frame_name(t.header.frame_id)
                static = topic.endswith("tf_static")
                edge = self._edges[child].setdefault(parent, _Samples(static))
                edge.add(seconds(t.header.stamp), t.transform.translation, t.transform.rotation)
            return
        child = frame_name(message.child_frame_id) if kind in ("odometry", "transform") else ""
        _, _, samples = self._topics.setdefault(
            topic, (frame_name(message.header.frame_id), child, _Samples(False)))
        if kind == "path":  # Each message has the whole path.
            del samples.rows[:]
            for stamped in message.poses:
                samples.add(seconds(stamped.header.stamp), stamped.pose.position, stamped.pose.orientation)
        elif kind == "transform":
            samples.add(seconds(message.header.stamp), message.transform.translation, message.transform.rotation)
        else:
            pose = message.pose if kind == "pose" else message.pose.pose
            samples.add(seconds(message.header.stamp), pose.position, pose.orientation)

    def _climb(self, frame: str, stop: str = "", static_only: bool = False) -> list[tuple[str, _Samples]]:
        """The edges from a frame upwards to `stop` or the root: (parent, samples), lowest first."""
        chain: list[tuple[str, _Samples]] = []
        seen = {frame}
        while frame != stop and self._edges.get(frame):
            parent, samples = max(self._edges[frame].items(), key=lambda item: len(item[1].rows))
            if parent in seen or (static_only and not samples.static):
                break
            chain.append((parent, samples))
            seen.add(parent)
            frame = parent
        return chain

    def choices(self) -> list[str]:
        """Topics of odometry and poses."""
        return sorted(self._topics)

    def poses_of(self, lidar: str, topic: str | None) -> tuple[Poses | None, str]:
        """Poses of the lidar's frame, from that topic (None: whatever is there), and how they were found."""
        chain = self._climb(lidar)
        moving = any(not samples.static for _, samples in chain)
        fixed = bool(chain) and chain[-1][0] in _FIXED
        if topic in (None, "/tf", "tf") and (moving or (fixed and not self._topics)):
            return self._joined(chain), "/tf: " + " -> ".join([parent for parent, _ in reversed(chain)] + [lidar])
        if topic is None and len(self._topics) != 1:
            return None, "several: " + " or ".join(self.choices()) if self._topics else "none"
        chosen = topic if topic is not None else self.choices()[0]
        if chosen not in self._topics:
            return None, "none"
        parent, child, samples = self._topics[chosen]
        lower = self._climb(lidar, stop=child, static_only=True) if child and child != lidar else []
        text = f"{chosen}: {parent} -> {child or lidar}"
        if child and child != lidar and (not lower or lower[-1][0] != child):
            lower = []
            text += f" (no transform from {child} to {lidar}: taken for the same)"
        elif lower:
            text += "".join(f" -> {name}" for name, _ in reversed(lower[:-1])) + f" -> {lidar}"
        return self._joined([*lower, (parent, samples)]), text

    def _joined(self, chain: list[tuple[str, _Samples]]) -> Poses | None:
        total: Poses | None = None
        self.bad = sum(samples.bad() for _, samples in chain)
        for _, samples in chain:
            poses = samples.poses()
            if not len(poses.time_s):
                return None
            total = poses if total is None else compose(poses, total)
        return total if total is not None and len(total.time_s) else None
