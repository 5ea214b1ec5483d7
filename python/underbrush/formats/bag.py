"""ROS recordings: ROS 1 bags, ROS 2 bags of SQLite files and of MCAP files."""
from __future__ import annotations

import collections
import contextlib
import dataclasses
import itertools
import pathlib
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from ..errors import FormatError
from ._files import OptionMissing, PathLike, guarded, size_of, with_thousands
from .bag_messages import BagMessages
from .bag_packets import STRING, BagPackets, is_packets, packets_in
from .layouts import guess_sensor, scan_from_points
from .point_times import PointTimes, turn_by
from .ros_messages import CLOUD, CUSTOM, cloud_points, frame_name, livox_points, seconds, typestore
from .scans import NO_POSES, Poses, Scan, middles
from .trajectory import pose_at, read_poses
from .transforms import FIXED, POSE_TYPES, FrameTree, LidarPoses

_JUMP_S = 10.0
_ELSEWHERE_M, _CONE_RAD = 3.0, 0.01  # From the origin; standard deviation of the elevations of a ring.
_PEEKED = 10  # Messages of each topic that are looked at first.
_LONGEST_IMU = 256  # Bytes; a lidar's packet is longer.
_UNTIMED = "the points have no times (their fields are {}): each {} at its cloud's stamp{}"
_BACK = ("by the points' times the sensor turns counter-clockwise, as few lidars do: do they count back from the scan's last "
         "point? Then --point-times before")
_UNREADABLE = "messages that cannot be read"
_CLOCK = "scans whose clock jumps (--clock bag takes the times of the recording)"


@dataclasses.dataclass
class _Topic:
    """Facts from the first messages of a topic with point clouds."""

    layout: str = "unknown"
    sensor: str = ""
    organised: bool = False
    points: int = 0
    fields: tuple[str, ...] = ()
    frames: tuple[str, ...] = ()
    period_s: float = 0.0  #: Median step of the first stamps of one frame, s; 0 = not known.


class BagRecording:
    """A ROS recording. It holds one message at a time; poses are read in a pass of their own, when needed.

    `topic` is the point cloud to read, or the packets of a sensor, which are read where there is no point cloud;
    `frame` the sensor, where several publish there, or the frame of an Ouster's packets; `poses` a topic of the
    recording or a file of poses; `clock` "stamp" (the messages' stamps) or "bag" (the times of recording). `metadata`
    and `sensor` determine how packets are decoded (see `PacketRecording`).
    """

    numbered = True  #: Whether its scans are revolutions or frames, and no pieces of a survey.
    crs = ""

    def __init__(self, path: PathLike, *, topic: str | None = None, frame: str | None = None,
                 poses: PathLike | None = None, clock: str = "stamp", metadata: PathLike | None = None,
                 sensor: str | None = None, unit_m: float = 1.0, point_times: str = "after") -> None:
        self.unit_m, self._count = unit_m, point_times
        self.path, self.frame, self.clock = pathlib.Path(path), frame, clock
        if clock not in ("stamp", "bag"):
            raise ValueError(f"no clock '{clock}': stamp or bag")
        self._poses_from, self._found = poses, list[LidarPoses]()
        self.skipped: collections.Counter[str] = collections.Counter()
        self.sensor, self.bytes_total, self.bytes_done, self._organised = "", size_of(path), 0, False
        self._messages, self._own_clock, self._untimed = BagMessages(self.path), False, False
        self._turns_back = False
        self._ros1 = self._messages.is_ros1
        self._store = typestore(self._ros1)
        topics = [(t, kind) for t, kind, n in self._messages.topics if n]
        with self._messages.opened() as reader, guarded(path, "index"):
            self._first = {t: self._peek(reader, t) for t, kind in topics if _is_cloud(kind)}
            packets = {t: self._peek_packets(reader, t) for t, kind in topics if is_packets(kind)}
        self._packets: BagPackets | None = None
        packets = {t: first for t, first in packets.items() if first.points}
        if topic in packets or not self._first:
            self._first = packets
        clouds = sorted(self._first)
        self.skipped.clear()  # What was counted while peeking is counted again.
        if not clouds:
            raise FormatError(path, "", "no topic with point clouds (sensor_msgs/PointCloud2, Livox CustomMsg)"
                              + self._messages.no_packets() + (
                                  f"; the recording was not closed, and has {self._messages.recovered} whole messages"
                                  if self._messages.recovered else ""))
        if topic is not None and topic not in clouds:
            raise ValueError(f"{path}: no point clouds in {topic}: {', '.join([*clouds, *packets])}")
        self.topic = topic if topic is not None else clouds[0] if len(clouds) == 1 else None
        if self.topic is not None:
            self.sensor, self._organised = self._first[self.topic].sensor, self._first[self.topic].organised
            if self.topic in packets:
                texts = [t for t, kind in topics if kind == STRING]
                self._packets = BagPackets(path, self.topic, self._all_messages, self._ros1, texts, metadata, sensor,
                                           clock == "bag")
                self.sensor, self._organised = self._packets.sensor, self._packets.organised
            self._times = self._times_of(self.topic, self._first[self.topic].period_s)

    def found(self) -> list[str]:
        names = {"ros1": "ROS 1 bag", "mcap": "ROS 2 MCAP file", "sqlite3": "ROS 2 SQLite file", "folder": "ROS 2 bag"}
        file = self._messages
        lines = [f"{names[file.kind]}, {file.duration_s:.1f} s{file.start}, {self.bytes_total / 1e6:.1f} MB"]
        for topic, kind, count in file.topics:
            rate = f"{(count - 1) / file.duration_s:.1f} Hz" if count > 1 and file.duration_s > 0 else "once"
            if topic in self._first and self._first[topic].period_s > 0:
                rate = f"{1 / self._first[topic].period_s:.1f} Hz"
            text = f"{topic}: {kind}, {with_thousands(count)} messages, {rate}"
            if topic in self._first and self._first[topic].layout == "packets":
                misses = " with their misses" if self._packets is None or self._packets.organised else ""
                text += f"; packets of a sensor, decoded{misses}, frame {self._first[topic].frames[0] or '-'}"
            elif topic in self._first:
                first = self._first[topic]
                text += (f"; layout {first.layout} ({' '.join(first.fields)}), {with_thousands(first.points)} points a "
                         f"scan, {'organised, with misses' if first.organised else 'no misses'}, "
                         f"frame {' and '.join(first.frames) or '-'}"
                         + (f", probably {first.sensor}" if first.sensor else ""))
            lines.append(text)
        if self._packets is not None:
            lines += self._packets.found()
        if self._own_clock:
            lines.append("the sensor has a clock of its own: its times count from the messages' stamps")
        if self.topic is None:
            return [*lines, self._ask_topic()]
        if self.frame is None and len(self._first[self.topic].frames) > 1:
            return [*lines, self._ask_frame(self._first[self.topic].frames)]
        if self.poses is None:
            return [*lines, self.ask_poses()]
        way = np.ptp(self.poses.position, axis=0)
        lines += [self._lidar.note] if self._lidar.note else []
        return [*lines, f"poses from {self._lidar.text}; {with_thousands(len(self.poses.time_s))} of them within "
                        f"{way[0]:.1f} x {way[1]:.1f} x {way[2]:.1f} m"]

    def notes(self) -> list[str]:
        """What was assumed so far, one line each."""
        notes = [self._times.note] if self._times.note else []
        notes += [self._lidar.note] if self._lidar.note else []
        poses = self.poses
        if self._untimed and poses is not None and np.ptp(poses.position, axis=0).max(initial=0) > 0:
            notes.append(_UNTIMED.format(" ".join(self._first[str(self.topic)].fields), *(
                ("begins where the sensor was", "") if self.world else
                ("is placed by the pose", ", without compensation of the motion within a scan"))))
        notes += [_BACK] if self._turns_back else []
        if self._messages.recovered:
            notes.append(f"the recording was not closed: its {self._messages.recovered} whole messages are read")
        return notes

    @property
    def topics(self) -> list[dict[str, Any]]:
        """Name, type and number of messages of each topic."""
        return [{"topic": topic, "type": kind, "messages": n} for topic, kind, n in self._messages.topics]

    @property
    def has_packets(self) -> bool:
        """Whether packets are read, and not point clouds."""
        return self._packets is not None

    @property
    def poses(self) -> Poses | None:
        """World from the lidar's frame; None where the recording has none."""
        return self._lidar.poses

    @poses.setter
    def poses(self, poses: Poses | None) -> None:
        self._found = [LidarPoses(poses)]

    @property
    def world(self) -> bool:
        """Whether the point clouds are in the frame of the poses."""
        return self._lidar.world

    @property
    def organised(self) -> bool:
        """Whether its scans keep misses. In the frame of the world they do not: a miss has no direction there."""
        return self._organised and not self.world

    @property
    def _lidar(self) -> LidarPoses:
        if not self._found:
            self._found = [self._read_poses()]
        return self._found[0]

    def take_poses(self, source: PathLike) -> None:
        """Takes the poses from a topic of the recording or from a file."""
        self._poses_from, self._found = source, []

    def scans(self) -> Iterator[Scan]:
        number = 0
        if self._packets is not None:
            yield from self._packets.scans()
            self.skipped.update(self._packets.skipped)
            self.bytes_done = self.bytes_total
            return
        reason = "no message of this topic can be read"
        for points, stamp, shift in self._clouds():
            try:
                with guarded(self.path, "message"):
                    scan, _ = self._scan(points, stamp, number)
            except FormatError as error:
                self.skipped[_UNREADABLE] += 1
                reason = f"no message of this topic can be read: {str(error).rpartition(': message: ')[2]}"
                continue
            self._untimed = self._untimed or scan.beam_time_s is None
            if not number and scan.beam_time_s is not None and scan.xyz is not None and not self.world:
                self._turns_back = turn_by(scan.xyz, scan.beam_time_s) > np.pi
            if shift:
                scan.time_s += shift
                if scan.beam_time_s is not None:
                    scan.beam_time_s += shift
            number += 1
            yield scan
        if not number:
            raise FormatError(self.path, str(self.topic), reason)
        self.bytes_done = self.bytes_total

    def scan_times(self) -> list[float]:
        """Reference times (s) of the scans that `scans` yields; a pass that decodes packets, but no point clouds."""
        if self._packets is not None:
            return [scan.time_s for scan in self._packets.scans()]
        kept, self.skipped = self.skipped, collections.Counter()
        times = [stamp + shift for _, stamp, shift in self._clouds()]
        self.skipped = kept
        return times

    def pose_times(self) -> npt.NDArray[np.float64]:
        """Times (s) of the middles of the scans, where poses have none; a pass over the messages."""
        kept, self.skipped = self.skipped, collections.Counter()
        times = middles(self.scans())
        self.skipped, self.bytes_done = kept, 0
        return times

    def _clouds(self) -> Iterator[tuple[npt.NDArray[np.void], float, float]]:
        """Points, stamp (s) and what to add to the times (s) of the sensor's clouds whose clock does not jump."""
        if self.topic is None:
            raise OptionMissing(self._ask_topic())
        frames, last = set(self._first[self.topic].frames), None
        for kind, bag_ns, raw in self._all_messages(self.topic, self.skipped):
            try:
                with guarded(self.path, "message"):
                    points, stamp, frame = self._points(kind, raw)
            except FormatError:
                self.skipped[_UNREADABLE] += 1
                continue
            frames.add(frame)
            if self.frame is None and len(frames) > 1:
                raise OptionMissing(self._ask_frame(sorted(frames)))
            if self.frame is not None and frame != frame_name(self.frame):
                continue
            bag_s = bag_ns * 1e-9
            shift = bag_s - stamp if self.clock == "bag" else 0.0
            step = np.inf if last is None else stamp + shift - last[0]
            if last is not None and (step <= 0 or abs(step - (bag_s - last[1])) > _JUMP_S):
                self.skipped[_CLOCK] += 1
                continue
            last = (stamp + shift, bag_s)
            yield points, stamp, shift

    def _ask_topic(self) -> str:
        return f"{self.path}: several topics with point clouds: add " + " or ".join(
            f"--topic {t}" + (f" ({f.sensor})" if f.sensor else "") for t, f in sorted(self._first.items()))

    def _ask_frame(self, frames: Sequence[str]) -> str:
        return f"{self.path}: several sensors publish in {self.topic}: add " + " or ".join(
            f"--frame {name}" for name in frames)

    def ask_poses(self) -> str:
        """The error line that names the option for poses, if there are none."""
        ask = self._lidar.ask or "no poses in it" + self._messages.only({"NavSatFix", "PoseArray", "Imu", "NavSatStatus"})
        return f"{self.path}: {ask if '--poses' in ask else NO_POSES.replace('no poses in it', ask)}"

    def _all_messages(self, topic: str, skipped: collections.Counter[str]) -> Iterator[tuple[str, int, bytes]]:
        """The topic's messages; `bytes_done` is kept up to date."""
        def report(share: float) -> None:
            self.bytes_done = int(self.bytes_total * share)

        return self._messages.all_of(topic, skipped, report)

    def _peek(self, reader: Any, topic: str) -> _Topic:
        """Facts from the first messages of a topic."""
        first, stamps = _Topic(), list[tuple[float, float]]()
        self._times = self._times_of(topic, 0.0)
        for kind, bag_ns, raw in itertools.islice(self._messages.of(reader, topic, self.skipped), _PEEKED):
            with contextlib.suppress(FormatError), guarded(self.path, topic):
                points, stamp, frame = self._points(kind, raw)
                if not first.frames:
                    scan, first.layout = self._scan(points, stamp, 0)
                    first.fields, first.points = points.dtype.names or (), points.size
                    first.sensor, first.organised = guess_sensor(first.layout, scan), scan.shape is not None
                if frame == (first.frames or (frame,))[0]:
                    stamps.append((stamp, bag_ns * 1e-9))
                first.frames = tuple(sorted({*first.frames, frame}))
        if len(stamps) > 1:  # The times of recording help where the stamps do not rise.
            first.period_s = next((float(step) for step in np.median(np.diff(stamps, axis=0), axis=0) if step > 0), 0.0)
        return first

    def _peek_packets(self, reader: Any, topic: str) -> _Topic:
        """The frame of a topic's packets, and whether one is long enough for a lidar's: those of an IMU have 48."""
        for kind, time_ns, raw in itertools.islice(self._messages.of(reader, topic, self.skipped), _PEEKED):
            with contextlib.suppress(ValueError):
                packets, frame = packets_in(kind, raw, time_ns * 1e-9, self._ros1, False)
                longest = max((len(packet.data) for packet in packets), default=0)
                if longest > _LONGEST_IMU:
                    return _Topic("packets", organised=True, points=longest,
                                  frames=(frame_name(self.frame or frame),))
        return _Topic()

    def _times_of(self, topic: str, period_s: float) -> PointTimes:
        """The times of a topic's points: Livox's own messages have ns."""
        unit_s = 0.0 if self._messages.kind_of(topic) == CLOUD else 1e-9
        return PointTimes(self.path, period_s, unit_s, self._count)

    def _are_of_sensor(self, poses: Poses) -> bool:
        """Whether the rings of a cloud are cones about the origin although the sensor is elsewhere."""
        kept, self.skipped, are_cones = self.skipped, collections.Counter(), False
        for points, stamp, shift in self._clouds():
            place, _, inside = pose_at(poses, np.array([stamp + shift]))
            if not inside[0] or np.linalg.norm(place) < _ELSEWHERE_M:
                continue
            with contextlib.suppress(FormatError), guarded(self.path, "message"):
                scan, _ = self._scan(points, stamp, 0)
                if scan.xyz is not None and scan.ring is not None:
                    elevation = np.arctan2(scan.xyz[:, 2], np.hypot(scan.xyz[:, 0], scan.xyz[:, 1]))
                    rings = [elevation[scan.ring == ring] for ring in np.unique(scan.ring)]
                    spreads = [float(np.nanstd(ring)) for ring in rings]
                    are_cones = len(rings) > 1 and float(np.median(spreads)) < _CONE_RAD
            break
        self.skipped, self.bytes_done = kept, 0
        return are_cones

    def _points(self, kind: str, raw: bytes) -> tuple[npt.NDArray[np.void], float, str]:
        """The points of a message, its stamp (s) and its frame."""
        if kind != CLOUD:
            points, stamp, frame = livox_points(raw, self._ros1)
            return points, stamp, frame_name(frame)
        read = self._store.deserialize_ros1 if self._ros1 else self._store.deserialize_cdr
        message = read(raw, CLOUD)
        return cloud_points(message), seconds(message.header.stamp), frame_name(message.header.frame_id)

    def _scan(self, points: npt.NDArray[np.void], stamp: float, number: int) -> tuple[Scan, str]:
        scan, layout = scan_from_points(points, stamp, number, self.skipped, self._times)
        if scan.xyz is not None:
            scan = dataclasses.replace(scan, xyz=self.unit_m * scan.xyz)
        times = scan.beam_time_s
        if times is not None and len(times) and np.isfinite(times[0]) and abs(times[0] - stamp) > _JUMP_S:
            times += stamp - float(np.nanmin(times))  # The sensor's clock is not the messages'.
            self._own_clock = True
        return scan, layout

    def _read_poses(self) -> LidarPoses:
        topics = {topic: POSE_TYPES[kind] for topic, kind, n in self._messages.topics if kind in POSE_TYPES and n}
        asked = None if self._poses_from is None else str(self._poses_from)
        lidar = "" if self.topic is None else frame_name(self.frame) if self.frame is not None else next(
            iter(self._first[self.topic].frames), "")
        if asked is not None and asked not in topics:
            if topics and not pathlib.Path(asked).exists():
                raise ValueError(f"{self.path}: no topic and no file '{asked}' with poses: {', '.join(sorted(topics))}")
            poses = read_poses(asked, self.pose_times if self.topic is not None else None)
            unclear = lidar in FIXED and not self._are_of_sensor(poses)
            return LidarPoses(poses, asked, f"the point clouds are in {lidar}, by its name a frame that does not move, but "
                              f"the poses of {asked} are applied to them" if unclear else "")
        if self.topic is None or not topics:
            return LidarPoses(None)
        tree = FrameTree()
        read = self._store.deserialize_ros1 if self._ros1 else self._store.deserialize_cdr
        with self._messages.opened() as reader:
            for topic, kind in topics.items():
                for msgtype, _, raw in self._messages.of(reader, topic, self.skipped):
                    try:
                        with guarded(self.path, topic):
                            tree.add(kind, topic, read(raw, msgtype))
                    except FormatError:
                        self.skipped["poses that cannot be read"] += 1
        found = tree.poses_of(lidar, asked)
        if found.world and found.poses is not None and self._are_of_sensor(found.poses):
            found.world, found.note = False, (
                f"the point clouds are in {lidar}, by its name the frame of the poses ({found.text}), but their rings are "
                "cones about the origin: they are taken for those of the sensor")
        if tree.bad:
            self.skipped["poses that are no rotations or not finite"] += tree.bad
        return found


def _is_cloud(msgtype: str) -> bool:
    return msgtype == CLOUD or msgtype in CUSTOM
