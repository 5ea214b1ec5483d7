"""Poses in ROS recordings: a tree of frames from /tf and /tf_static, odometry, paths, and stamped poses and transforms."""
from __future__ import annotations

import array
import collections
import dataclasses
from typing import Any

import numpy as np

from .ros_messages import frame_name, seconds
from .scans import Poses
from .trajectory import compose, conjugate, in_order, rotate

#: Message types with poses, by the name that rosbags gives them.
POSE_TYPES = {"tf2_msgs/msg/TFMessage": "tf", "tf/msg/tfMessage": "tf", "nav_msgs/msg/Odometry": "odometry",
              "geometry_msgs/msg/PoseStamped": "pose", "geometry_msgs/msg/PoseWithCovarianceStamped": "covariance",
              "geometry_msgs/msg/TransformStamped": "transform", "nav_msgs/msg/Path": "path"}
#: Names of frames that do not move.
FIXED = ("map", "world", "odom", "earth", "local", "utm", "camera_init")
_STILL = 1e-9  # Poses differ by less where they are repeated.
_BODIES = ("base_link", "base_footprint", "body")  # Frames of a vehicle; the first is REP 105's.


@dataclasses.dataclass
class LidarPoses:
    """The poses of a lidar, and how they were found."""

    poses: Poses | None
    text: str = "none"  #: From which topic, by which frames.
    note: str = ""  #: What was assumed of the frames; empty if nothing was.
    world: bool = False  #: Whether the point clouds are in the frame of the poses, so that only positions are used.
    ask: str = ""  #: Why there are none, and which option to add; empty where the recording has nothing of the kind.


class _Samples:
    """The poses of one frame seen from another, eight numbers a pose."""

    def __init__(self, static: bool) -> None:
        self.static, self.rows = static, array.array("d")

    def add(self, time_s: float, position: Any, q: Any) -> None:
        self.rows.extend((time_s, position.x, position.y, position.z, q.x, q.y, q.z, q.w))

    def poses(self) -> Poses:
        table = np.array(self.rows).reshape(-1, 8)
        if self.rigid():
            table = table[-1:]
        return in_order(table[:, 0], table[:, 1:4], table[:, 4:])

    def rigid(self) -> bool:
        """Whether the pose never changes. ROS 1 repeats static transforms in /tf."""
        table = np.array(self.rows).reshape(-1, 8)[:, 1:]
        return self.static or bool(np.all(np.abs(table - table[:1]) < _STILL))

    def bad(self) -> int:
        """Number of poses that are no rotations or not finite."""
        table = np.array(self.rows).reshape(-1, 8)
        with np.errstate(over="ignore"):
            norm = np.linalg.norm(table[:, 4:], axis=1)
        return int(np.count_nonzero(~(np.isfinite(table).all(axis=1) & (np.abs(norm - 1) < 0.005))))


_Step = tuple[_Samples, bool]  # A transform, and whether it leads from the child to the parent.


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

    def _climb(self, frame: str) -> list[str]:
        """The frames from a frame upwards to the root, itself first. Of several parents the one with most poses counts."""
        chain = [frame]
        while self._edges.get(frame):
            frame = max(self._edges[frame].items(), key=lambda item: len(item[1].rows))[0]
            if frame in chain:
                break
            chain.append(frame)
        return chain

    def _path(self, top: str, frame: str, rigid: bool = False) -> list[_Step] | None:
        """The transforms, up and down, whose product is `top` from `frame`; with `rigid` those that do not move. None
        where no transforms lead there."""
        links: dict[str, dict[str, _Step]] = collections.defaultdict(dict)
        for child, parents in self._edges.items():
            for parent, samples in parents.items():
                if not rigid or samples.rigid():
                    links[parent][child] = samples, False
                    links[child].setdefault(parent, (samples, True))
        before, queue = {top: ""}, collections.deque([top])
        while queue and frame not in before:
            here = queue.popleft()
            for there in links[here]:
                if there not in before:
                    before[there] = here
                    queue.append(there)
        if frame not in before:
            return None
        path: list[_Step] = []
        while frame != top:
            path.append(links[before[frame]][frame])
            frame = before[frame]
        return path[::-1]

    def choices(self) -> list[str]:
        """Topics of odometry and poses."""
        return sorted(self._topics)

    def poses_of(self, lidar: str, topic: str | None) -> LidarPoses:
        """Poses of the lidar's frame, from that topic (None: whatever is there), and how they were found."""
        if topic not in (None, "/tf", "tf"):
            return self._of_topic(lidar, topic) if topic in self._topics else LidarPoses(None)
        found, root = self._of_tree(lidar), self._climb(lidar)[-1]
        if topic is not None or not self._topics or (found.poses is not None and (root in FIXED or not any(
                root == child for _, child, _ in self._topics.values()))):
            return found
        if len(self._topics) > 1:
            return LidarPoses(None, ask="several topics with poses: add "
                              + " or ".join(f"--poses {name}" for name in self.choices()))
        return self._of_topic(lidar, self.choices()[0])

    def _moves(self, child: str, parent: str) -> bool:
        return not self._edges[child][parent].rigid()

    def _of_tree(self, lidar: str) -> LidarPoses:
        """The lidar's poses from transforms alone."""
        if not self._edges:
            return LidarPoses(None)
        chain, frames = self._climb(lidar), sorted({*self._edges, *(p for edge in self._edges.values() for p in edge)})
        edges = list(zip(chain, chain[1:]))
        if lidar in FIXED or not (edges or self._topics):
            below = [frame for frame in frames if lidar in self._climb(frame)[1:]]
            movers = [frame for frame in below if self._moves(frame, self._climb(frame)[1])]
            fixed = [frame for frame in movers if frame in FIXED]
            if fixed and lidar not in FIXED:
                return LidarPoses(self._product(self._path(fixed[0], lidar)), f"/tf: {fixed[0]} -> {lidar} (inverse)")
            bodies = [name for name in _BODIES if name in movers][:1]
            if not bodies and lidar in FIXED:
                bodies = [frame for frame in movers if not any(frame in self._climb(other)[1:] for other in movers)]
            if len(bodies) == 1:
                return LidarPoses(self._product(self._path(lidar, bodies[0])), f"/tf: {lidar} -> {bodies[0]}",
                                  _in_world(lidar, "/tf", bodies[0]), True)
            if bodies:
                return LidarPoses(None, ask=f"the point clouds are in {lidar}, in which several frames move "
                                            f"({', '.join(bodies)}): add --poses FILE")
        # Transforms that stand still are those of a lidar that stands still, if two of three signs indicate it.
        signs = not self._topics, chain[-1] in FIXED, not all(self._edges[a][b].static for a, b in edges)
        if any(self._moves(*edge) for edge in edges) or (edges and sum(signs) >= 2):
            return LidarPoses(self._product(self._path(chain[-1], lidar)), "/tf: " + " -> ".join(reversed(chain)))
        return LidarPoses(None, ask=f"no transforms lead from {lidar or 'no name'}, the frame of the point clouds, to one "
                                    f"in which it moves (there are {', '.join(frames)})")

    def _of_topic(self, lidar: str, topic: str) -> LidarPoses:
        """The lidar's poses from a topic and the transforms from its frame to the lidar."""
        parent, child, samples = self._topics[topic]
        above = [] if lidar == parent else self._path(lidar, parent, rigid=True) if lidar in FIXED else None
        if above is not None and lidar != child:
            return LidarPoses(self._product([*above, (samples, False)]), f"{topic}: {parent} -> {child or 'sensor'}",
                              _in_world(lidar, topic, child), True)
        body, note = child, ""
        # The frames to which the lidar is fixed, from itself up.
        ups = [name for name in self._climb(lidar) if name not in FIXED
               and self._path(name, lidar, rigid=True) is not None]
        if not child:
            body = _BODIES[0] if _BODIES[0] in ups else ups[-1] if ups else lidar
            note = f"the poses of {topic} name no frame: they are taken for those of {body or 'the sensor'}"
        lower = self._path(body, lidar, rigid=True)
        if lower is None and body in self._climb(lidar):
            lower = self._path(body, lidar)
        text = f"{topic}: {parent} -> {body}" + (f" -> {lidar}" if body != lidar else "")
        if lower is None:
            same = next((name for name in _BODIES if name in ups and child in _BODIES), lidar)
            note = (f"no transforms lead from {body}, whose poses {topic} has, to {lidar or 'no name'}, the frame of the "
                    f"point clouds: {body} and {same or 'no name'} are taken for the same frame")
            text = f"{topic}: {parent} -> {body} (no transform from {body} to {lidar}: {same} taken for the same)"
            lower = self._path(same, lidar, rigid=True) or []
        return LidarPoses(self._product([(samples, False), *lower]), text, note)

    def _product(self, path: list[_Step] | None) -> Poses | None:
        """The product of the transforms of a path; None where one has no poses."""
        total: Poses | None = None
        self.bad = sum(samples.bad() for samples, _ in path or [])
        for samples, up in reversed(path or []):
            poses = _inverse(samples.poses()) if up else samples.poses()
            if not len(poses.time_s):
                return None
            total = poses if total is None else compose(poses, total)
        return total if total is not None and len(total.time_s) else None


def _in_world(cloud: str, topic: str, body: str) -> str:
    return (f"the point clouds are in {cloud}, the frame in which {topic} gives poses: their points are taken for those "
            f"of the world, and beams begin at the positions of {body or 'the sensor'}")


def _inverse(poses: Poses) -> Poses:
    rotation = conjugate(poses.rotation)
    return Poses(poses.time_s, -rotate(rotation, poses.position), rotation)
