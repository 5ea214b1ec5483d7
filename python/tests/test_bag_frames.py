"""ROS recordings whose frames, fields or times are not a driver's: landmarks must come back where they stand."""
from __future__ import annotations

import pathlib
import re
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

pytest.importorskip("rosbags", reason="rosbags is not installed: pip install 'underbrush[formats]'")

from bag_messages import ODOMETRY, POSE, Bag, bag  # noqa: E402
from format_data import end_points, joined  # noqa: E402

import underbrush  # noqa: E402
from underbrush.formats import OptionMissing, Poses, beams, open_recording  # noqa: E402
from underbrush.formats.bag import BagRecording  # noqa: E402
from underbrush.formats.log import inference_of  # noqa: E402
from underbrush.formats.trajectory import compose, conjugate, from_angles, pose_at, rotate  # noqa: E402
from underbrush.import_recording import run  # noqa: E402

POINTS, SCANS, START_S = 50, 4, 1.6e9
LANDMARKS = np.random.default_rng(3).uniform([-20, -20, 0], [20, 20, 5], (POINTS, 3))
ARM = np.array([0.5, 0.2, 1.2])
LIDAR = Poses(np.linspace(-0.1, 0.6, 36) + START_S,
              np.column_stack([6 * np.linspace(-0.1, 0.6, 36), np.zeros(36), np.full(36, 1.8)]),
              from_angles(np.zeros(36), np.zeros(36), np.linspace(0, 0.4, 36)))
BASE = compose(LIDAR, Poses(np.zeros(1), -ARM[None, :], np.array([[0.0, 0, 0, 1]])))
OFFSETS = np.linspace(0, 0.099, POINTS)
POSTS = np.concatenate([LANDMARKS * [1, 1, 0] + [0, 0, z] for z in np.arange(0, 5, 0.2)])
Fields = Callable[[npt.NDArray[np.float64]], Mapping[str, npt.NDArray[Any]]]
Sends = Callable[[Bag, float, npt.NDArray[np.float64], npt.NDArray[np.float64]], None]


def drive(path: pathlib.Path, send: Sends, poses: Poses = LIDAR, fields: Fields | None = None, frame: str = "velodyne",
          arm: bool = False, registered: bool = False, landmarks: npt.NDArray[np.float64] = LANDMARKS) -> BagRecording:
    """Writes clouds of landmarks as a moving lidar measures them, with times, and poses; and opens it."""
    points, offsets = len(landmarks), np.linspace(0, 0.099, len(landmarks))
    with bag(path, "ros1") as out:
        if arm:
            out.transform("/tf_static", START_S - 0.1, "base_link", "velodyne", ARM, [0, 0, 0, 1])
        for time, position, rotation in zip(poses.time_s, poses.position, poses.rotation):
            send(out, time, position, rotation)
        for k in range(SCANS):
            stamp = START_S + 0.1 * k
            position, rotation, _ = pose_at(LIDAR, stamp + offsets)
            xyz = landmarks if registered else rotate(conjugate(rotation), landmarks - position)
            columns = {**dict(zip("xyz", xyz.T.astype(np.float32))), "intensity": np.arange(points, dtype=np.float32),
                       "ring": np.arange(points, dtype=np.uint16) % 16}
            columns.update({"time": offsets.astype(np.float32)} if fields is None else fields(stamp + offsets))
            table = np.zeros(points, [(name, "<" + column.dtype.str[1:]) for name, column in columns.items()])
            for name, column in columns.items():
                table[name] = column
            out.cloud("/points", stamp, table, frame)
    recording = open_recording(path)
    assert isinstance(recording, BagRecording)
    return recording


def tf(parent: str, child: str) -> Sends:
    return lambda out, time, position, rotation: out.transform("/tf", time, parent, child, position, rotation)


def topic(kind: str, parent: str, child: str, name: str = "/odometry") -> Sends:
    return lambda out, time, position, rotation: out.pose(name, kind, time, parent, child, position, rotation)


def error_m(recording: BagRecording) -> float:
    back = joined(list(beams(recording)))
    assert len(back["range_m"]) == POINTS * SCANS
    return float(np.abs(end_points(back) - np.tile(LANDMARKS, (SCANS, 1))).max())


@pytest.mark.parametrize(("frame", "send"), [
    ("camera_init", topic(ODOMETRY, "camera_init", "body")), ("map", topic(POSE, "map", "")),
    ("camera_init", tf("camera_init", "body")), ("map", tf("map", "base_link")), ("slam", tf("slam", "base_link"))])
def test_registered_clouds_have_the_coordinates_of_the_world(tmp_path: pathlib.Path, frame: str, send: Sends) -> None:
    recording = drive(tmp_path / "d.bag", send, frame=frame, registered=True)
    back = joined(list(beams(recording)))
    np.testing.assert_allclose(end_points(back), np.tile(LANDMARKS, (SCANS, 1)), atol=1e-5)
    times = (START_S + 0.1 * np.arange(SCANS)[:, None] + OFFSETS.astype(np.float32)).reshape(-1)
    np.testing.assert_allclose(back["origin"], pose_at(LIDAR, times)[0], atol=1e-5)
    note, = recording.notes()
    assert f"the point clouds are in {frame}, the frame in which" in note and "the world" in note
    assert recording.world and not recording.organised
    with pytest.raises(ValueError, match="--infer-misses needs points in the sensor's frame"):
        inference_of(recording, "velodyne-vlp16")


def test_clouds_of_a_sensor_that_are_said_to_be_in_the_world(tmp_path: pathlib.Path) -> None:
    """Some name the frame of a sensor's clouds map, whatever it is. A moving sensor sees cones about itself."""
    azimuth, ring = np.tile(np.linspace(-3, 3, 30), 8), np.repeat(np.arange(8), 30).astype(np.uint16)
    with bag(tmp_path / "d.bag", "ros1") as out:
        for k in range(SCANS):
            table = np.zeros(240, [(name, "<f4") for name in "xyz"] + [("ring", "<u2")])
            flat = 5 + np.sin(3 * azimuth)
            table["x"], table["y"], table["ring"] = flat * np.cos(azimuth), flat * np.sin(azimuth), ring
            table["z"] = flat * np.tan(np.deg2rad(2.0 * ring - 8))
            out.cloud("/points", START_S + 0.1 * k, table, "map")
        for time, position, rotation in zip(LIDAR.time_s, LIDAR.position + [5, 0, 0], LIDAR.rotation):
            topic(POSE, "map", "")(out, time, position, rotation)
    recording = open_recording(tmp_path / "d.bag")
    first = end_points(next(beams(recording)))
    position, rotation, _ = pose_at(LIDAR, np.full(240, START_S))
    flat = 5 + np.sin(3 * azimuth)
    xyz = np.column_stack([flat * np.cos(azimuth), flat * np.sin(azimuth), flat * np.tan(np.deg2rad(2.0 * ring - 8))])
    np.testing.assert_allclose(first, rotate(rotation, xyz) + position + [5, 0, 0], atol=1e-5)
    assert not recording.world and "taken for those of the sensor" in recording.notes()[0]  # type: ignore[attr-defined]


def test_a_file_of_poses_for_clouds_of_the_world_is_said_to_be_applied(tmp_path: pathlib.Path) -> None:
    (tmp_path / "poses.txt").write_text(f"{START_S - 1} 5 0 0 0 0 0 1\n{START_S + 1} 9 0 0 0 0 0 1\n")
    recording = drive(tmp_path / "d.bag", lambda *_: None, frame="map", registered=True)
    recording.take_poses(tmp_path / "poses.txt")
    assert next(beams(recording))["range_m"].size
    assert "are in map, by its name a frame that does not move" in recording.notes()[0]


@pytest.mark.parametrize(("send", "poses", "note"), [
    (topic(POSE, "map", ""), BASE, "are taken for those of base_link"),
    (topic(ODOMETRY, "odom", ""), BASE, "are taken for those of base_link"),
    (topic(ODOMETRY, "odom", "base_link"), BASE, ""), (topic(ODOMETRY, "odom", "velodyne"), LIDAR, ""),
    (tf("map", "base_link"), BASE, "")])
def test_the_mounting_of_the_lidar_is_applied(tmp_path: pathlib.Path, send: Sends, poses: Poses, note: str) -> None:
    recording = drive(tmp_path / "d.bag", send, poses, arm=True)
    assert error_m(recording) < 1e-5
    assert [note in said for said in recording.notes()] == [True] * bool(note)


def test_frames_beside_the_lidar_and_repeated_transforms(tmp_path: pathlib.Path) -> None:
    """The poses are an IMU's, which the vehicle has beside the lidar, and ROS 1 repeats static transforms in /tf."""
    imu = np.array([0.1, 0.0, 0.4])
    poses = compose(BASE, Poses(np.zeros(1), imu[None, :], np.array([[0.0, 0, 0, 1]])))

    def send(out: Bag, time: float, position: Any, rotation: Any) -> None:
        out.pose("/imu_odometry", ODOMETRY, time, "odom", "imu", position, rotation)
        out.transform("/tf", time, "base_link", "imu", imu, [0, 0, 0, 1])
        out.transform("/tf", time, "base_link", "velodyne", ARM, [0, 0, 0, 1])

    recording = drive(tmp_path / "d.bag", send, poses)
    assert error_m(recording) < 1e-5 and not recording.notes()


def test_a_tree_with_the_world_below_the_lidar(tmp_path: pathlib.Path) -> None:
    turned = conjugate(LIDAR.rotation)
    recording = drive(tmp_path / "d.bag", tf("velodyne", "map"),
                      Poses(LIDAR.time_s, -rotate(turned, LIDAR.position), turned))
    assert error_m(recording) < 1e-2  # The inverse poses are interpolated on another way.


def test_a_mounting_that_is_not_known_is_said(tmp_path: pathlib.Path) -> None:
    recording = drive(tmp_path / "a.bag", topic(ODOMETRY, "odom", "gps"), arm=True)
    assert error_m(recording) < 1e-5
    note, = recording.notes()
    assert "no transforms lead from gps" in note and "gps and velodyne are taken for the same" in note
    recording = drive(tmp_path / "b.bag", topic(ODOMETRY, "odom", "base_footprint"), BASE, arm=True)
    assert error_m(recording) < 1e-5
    assert "base_footprint and base_link are taken for the same" in recording.notes()[0]


def test_poses_that_are_missing_are_asked_for_with_their_frames(tmp_path: pathlib.Path) -> None:
    def both(out: Bag, *pose: Any) -> None:
        topic(ODOMETRY, "odom", "base_link", "/odom")(out, *pose)
        topic(ODOMETRY, "map", "velodyne", "/lio/odom")(out, *pose)

    with pytest.raises(OptionMissing, match=r"two\.bag: several topics with poses: add --poses /lio/odom or --poses /odom$"):
        next(beams(drive(tmp_path / "two.bag", both)))
    recording = drive(tmp_path / "other.bag", tf("map", "base_link"), frame="os_sensor", arm=True)
    with pytest.raises(OptionMissing, match="no transforms lead from os_sensor, .* base_link, map, velodyne.*: add --poses"):
        next(beams(recording))

    def wheels(out: Bag, time: float, position: Any, rotation: Any) -> None:
        for name in ("left", "right"):
            out.transform("/tf", time, "map", name, position, rotation)

    with pytest.raises(OptionMissing, match="in map, in which several frames move .left, right.: add --poses"):
        next(beams(drive(tmp_path / "many.bag", wheels, frame="map", registered=True)))


@pytest.mark.parametrize(("fields", "note"), [
    (lambda t: {"gps_time": t}, ""), (lambda t: {"Time": OFFSETS.astype(np.float32)}, ""),
    (lambda t: {"time_ns": np.rint(OFFSETS * 1e9).astype(np.uint32)}, ""), (lambda t: {"TimeStamp": t}, ""),
    (lambda t: {"ts": t}, ""), (lambda t: {"rel_time_ms": (OFFSETS * 1e3).astype(np.float32)}, ""),
    (lambda t: {"adjustedtime": np.rint(OFFSETS * 1e6).astype(np.uint32)}, "to be µs"),
    (lambda t: {"time": np.zeros(POINTS, np.float32), "timestamp": t}, ""),
    (lambda t: {"timestamp": t - START_S + 3}, "their clock is another one: the first is 3 s"),
    (lambda t: {"time": (OFFSETS * 10).astype(np.float32)}, "0 to 1: it spans 0.99 of them where scans are 0.1 s apart")])
def test_times_by_the_names_of_import(tmp_path: pathlib.Path, fields: Fields, note: str) -> None:
    recording = drive(tmp_path / "d.bag", tf("map", "velodyne"), fields=fields)
    assert error_m(recording) < 1e-4
    assert [note in said for said in recording.notes()] == [True] * bool(note)
    assert "/points: sensor_msgs/msg/PointCloud2, 4 messages, 10.0 Hz" in "\n".join(recording.found())


def test_names_in_capitals(tmp_path: pathlib.Path) -> None:
    with bag(tmp_path / "d.bag", "ros1") as out:
        table = np.zeros(POINTS, [(name, "<f4") for name in ("x", "Y", "Z", "Intensity", "Other")] + [("Ring", "<u2")])
        table["x"], table["Intensity"], table["Ring"] = 3, 7, 5
        out.cloud("/points", START_S, table)
    scan = next(open_recording(tmp_path / "d.bag").scans())
    assert scan.xyz is not None and scan.xyz[0].tolist() == [3, 0, 0] and list(scan.extra) == ["Other"]
    assert scan.ring is not None and set(scan.ring) == {5} and set(np.asarray(scan.intensity)) == {7}


@pytest.mark.parametrize(("fields", "note"), [
    (lambda t: {"time": np.zeros(POINTS, np.float32)}, "times .time. are all 0"),
    (lambda t: {"timestamp": t.astype(np.float32)}, "floats of 4 bytes in steps of 1.3e.02 s"),
    (lambda t: {}, "the points have no times .their fields are x y z intensity ring.")])
def test_times_that_say_nothing_are_the_stamp_with_a_note(tmp_path: pathlib.Path, fields: Fields, note: str) -> None:
    recording = drive(tmp_path / "d.bag", tf("map", "velodyne"), fields=fields)
    back = joined(list(beams(recording)))
    np.testing.assert_allclose(back["time_s"], START_S + np.repeat(0.1 * np.arange(SCANS), POINTS), atol=1e-6)
    said, = recording.notes()
    assert re.search(note, said), said


@pytest.mark.parametrize(("count", "time"), [("before", lambda t: t), ("until", lambda t: 0.099 - t), ("after", lambda t: -t)])
def test_times_that_count_back_from_the_stamp(tmp_path: pathlib.Path, count: str, time: Callable[[Any], Any]) -> None:
    """The clouds' stamps are those of their last points."""
    azimuth = np.linspace(np.pi, -np.pi, 720)  # clockwise
    before = np.linspace(0.099, 0, 720)
    with bag(tmp_path / "d.bag", "ros1") as out:
        for k in range(-3, 6):
            out.transform("/tf", START_S + 0.1 * k, "map", "velodyne", [0.6 * k, 0, 1.8], [0, 0, 0, 1])
        for k in range(3):
            table = np.zeros(720, [(name, "<f4") for name in ("x", "y", "z", "t")])
            table["x"], table["y"], table["t"] = 9 * np.cos(azimuth), 9 * np.sin(azimuth), time(before)
            out.cloud("/points", START_S + 0.1 * k, table, "velodyne")

    def off_m(count: str) -> tuple[float, list[str]]:
        recording = open_recording(tmp_path / "d.bag", point_times=count)
        found = np.sort(end_points(joined(list(beams(recording))))[:, 0])
        right = [9 * np.cos(azimuth) + 0.6 * k - 6 * before for k in range(3)]
        return float(np.abs(found - np.sort(np.concatenate(right))).max()), recording.notes()  # type: ignore[attr-defined]

    assert off_m(count)[0] < 0.01 and not off_m(count)[1]
    if count == "before":
        assert off_m("after")[0] > 0.5 and "Then --point-times before" in off_m("after")[1][0]


def identity(poses: Poses) -> npt.NDArray[np.float64]:
    return np.tile([0.0, 0, 0, 1], (len(poses.time_s), 1))


@pytest.mark.parametrize(("wrong", "cause"), [
    (lambda p: p, ""),
    (lambda p: Poses(p.time_s, 0 * p.position, identity(p)), "are all poses the same"),
    (lambda p: Poses(p.time_s, 1e3 * p.position, p.rotation), "in mm"),
    (lambda p: Poses(p.time_s, p.position, identity(p)), "rotations and axes"),
    (lambda p: Poses(p.time_s, p.position, p.rotation[:, [3, 0, 1, 2]]), "qw qx qy qz"),
    (lambda p: Poses(p.time_s, -rotate(conjugate(p.rotation), p.position), conjugate(p.rotation)), "inverted")])
def test_poses_of_bags_are_checked(tmp_path: pathlib.Path, capsys: pytest.CaptureFixture[str],
                                   wrong: Callable[[Poses], Poses], cause: str) -> None:
    drive(tmp_path / "d.bag", tf("odom", "velodyne"), wrong(LIDAR), landmarks=POSTS)
    assert run([str(tmp_path / "d.bag"), "-o", str(tmp_path / "log.ply")]) == 0
    warned = capsys.readouterr().err.splitlines()
    assert len(warned) == (1 if cause else 0)
    assert not cause or cause in warned[0] and warned[0].startswith("underbrush: warning: by the poses")


def test_clouds_in_another_unit(tmp_path: pathlib.Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Clouds in mm give a warning, and with their unit the same log as clouds in m."""
    for name, unit in (("m", 1.0), ("mm", 1e3)):
        with bag(tmp_path / name, "mcap") as out:
            for time, position, rotation in zip(LIDAR.time_s, LIDAR.position, LIDAR.rotation):
                tf("odom", "velodyne")(out, time, position, rotation)
            table = np.zeros(POINTS, [(axis, "<f8") for axis in "xyz"])
            for axis, column in zip("xyz", 10 * unit * LANDMARKS.T):
                table[axis] = column
            out.cloud("/points", START_S, table, "velodyne")
    assert run([str(tmp_path / "mm"), "-o", str(tmp_path / "long.ply")]) == 0
    assert "in mm? Then --unit mm" in capsys.readouterr().err
    (tmp_path / "mm" / "metadata.yaml").unlink()  # As when the recorder dies.
    logs = []
    for words in (["m"], ["mm", "--unit", "mm"]):
        assert run([str(tmp_path / words[0]), *words[1:], "-o", str(tmp_path / "log.ply")]) == 0
        logs.append(underbrush.read_log(tmp_path / "log.ply"))
    np.testing.assert_allclose(logs[0].end_points(), logs[1].end_points(), atol=1e-3)
