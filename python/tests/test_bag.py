"""ROS recordings: every driver's layout, every storage, poses, and what is missing."""
from __future__ import annotations

import contextlib
import pathlib
import sqlite3
import struct
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

pytest.importorskip("rosbags", reason="rosbags is not installed: pip install 'underbrush[formats]'")

from bag_messages import CLOUD, ODOMETRY, POSE, bag, some_points  # noqa: E402
from format_data import Columns, data, end_points, generated_log, joined, pieces, straight_path  # noqa: E402
from rosbags.typesys import Stores, get_types_from_msg, get_typestore  # noqa: E402

from underbrush.formats import FormatError, OptionMissing, Poses, beams, open_recording  # noqa: E402
from underbrush.formats.layouts import LAYOUTS  # noqa: E402
from underbrush.formats.trajectory import pose_at  # noqa: E402
from underbrush.formats.write_bag import BagWriter  # noqa: E402


def sorted_rows(log: Columns, hits_only: bool = False) -> Columns:
    rows = np.lexsort((log["range_m"], log["ring"], np.round(log["time_s"], 7)))
    rows = rows[np.isfinite(log["range_m"][rows])] if hits_only else rows
    return {name: column[rows] for name, column in log.items()}


def assert_same(back: Columns, log: Columns, times_s: float = 1e-8) -> None:
    assert len(back["range_m"]) == len(log["range_m"])
    np.testing.assert_array_equal(np.isfinite(back["range_m"]), np.isfinite(log["range_m"]))
    np.testing.assert_allclose(back["time_s"], log["time_s"], atol=times_s)
    np.testing.assert_array_equal(back["ring"], log["ring"])
    np.testing.assert_array_equal(back["intensity"], log["intensity"])
    np.testing.assert_allclose(end_points(back), end_points(log), atol=2e-5)
    np.testing.assert_allclose(back["direction"], log["direction"], atol=1e-6)
    np.testing.assert_allclose(back["origin"], log["origin"], atol=1e-6)


@pytest.mark.parametrize(("name", "start_s"), [("log.mcap", 0.0), ("log.mcap", 1.7e9), ("log.db3", 1.7e9),
                                               ("log.bag", 1.7e9), ("log", 1.7e9)])
@pytest.mark.parametrize("layout", list(LAYOUTS))
def test_what_goes_in_comes_out(tmp_path: pathlib.Path, layout: str, name: str, start_s: float) -> None:
    log, poses = generated_log(start_s=start_s)
    with BagWriter(tmp_path / name, poses, layout=layout) as writer:
        for piece in pieces(log):
            writer.write(piece)
    recording = open_recording(tmp_path / name)
    back = joined(list(beams(recording)))
    keeps = LAYOUTS[layout].miss is not None
    assert recording.organised == keeps and not recording.skipped
    assert writer.lost == ({} if keeps else {"misses": int(np.count_nonzero(np.isinf(log["range_m"])))})
    assert_same(sorted_rows(back), sorted_rows(log, hits_only=not keeps), 5e-7 if start_s else 1e-8)
    assert writer.scans == 3 and writer.written == len(back["range_m"])


def test_layouts_are_the_drivers_to_the_byte(tmp_path: pathlib.Path) -> None:
    steps = {"velodyne": 22, "ouster": 48, "hesai": 26, "livox": 26, "autoware": 32}
    assert {name: layout.dtype.itemsize for name, layout in LAYOUTS.items()} == steps
    log, poses = generated_log(scans=1)
    with BagWriter(tmp_path / "log.mcap", poses, layout="ouster") as writer:
        writer.write(log)
    from rosbags.rosbag2 import Reader
    store = get_typestore(Stores.ROS2_HUMBLE)
    with Reader(tmp_path / "log.mcap") as reader:
        raw = next(raw for c, _, raw in reader.messages() if c.topic == "/points")
    cloud: Any = store.deserialize_cdr(raw, CLOUD)
    assert (cloud.height, cloud.width, cloud.point_step, cloud.row_step) == (16, 180, 48, 180 * 48)
    assert not cloud.is_dense
    assert [(f.name, f.offset, f.datatype) for f in cloud.fields] == [
        ("x", 0, 7), ("y", 4, 7), ("z", 8, 7), ("intensity", 16, 7), ("t", 20, 6), ("reflectivity", 24, 4),
        ("ring", 26, 4), ("ambient", 28, 4), ("range", 32, 6)]


def test_several_returns(tmp_path: pathlib.Path) -> None:
    log, poses = generated_log(echoes=4)
    counts = {}
    for layout in LAYOUTS:
        with BagWriter(tmp_path / (layout + ".mcap"), poses, layout=layout) as writer:
            writer.write(log)
        counts[layout] = dict(writer.lost)
    hits, later = int(np.isfinite(log["range_m"]).sum()), int((log["echo"] > 1).sum())
    misses = len(log["echo"]) - hits
    assert counts["ouster"] == {"pulse widths": hits, "echoes after the first": later}
    assert counts["autoware"] == {"pulse widths": hits, "misses": misses}
    for layout in ("velodyne", "hesai", "livox"):
        assert counts[layout] == {"pulse widths": hits, "misses": misses, "echo numbers": later}
    back = sorted_rows(joined(list(beams(open_recording(tmp_path / "autoware.mcap")))))
    same = sorted_rows(log, hits_only=True)
    np.testing.assert_array_equal(back["echo"], same["echo"])
    np.testing.assert_array_equal(back["echoes"], same["echoes"])
    first = {name: column[log["echo"] <= 1] for name, column in log.items()}
    assert_same(sorted_rows(joined(list(beams(open_recording(tmp_path / "ouster.mcap"))))), sorted_rows(first))


def test_a_real_scan_with_its_misses(tmp_path: pathlib.Path) -> None:
    path = data("marv_forest", "1727353472_601360559.npz")
    cloud = np.load(path)["cloud"].reshape(128, 1024)
    points = np.zeros(cloud.shape, LAYOUTS["ouster"].dtype)
    for name in ("x", "y", "z", "intensity", "t", "reflectivity", "ambient"):
        points[name] = np.nan_to_num(cloud[name])
    points["ring"] = np.arange(128)[:, None]
    with bag(tmp_path / "real", "sqlite3") as out:
        out.cloud("/ouster/points", 1727353472.601360559, points)
    recording = open_recording(tmp_path / "real")
    assert recording.sensor == "ouster-os0-128" and recording.organised
    scan = next(recording.scans())
    miss = np.isnan(cloud["x"]).reshape(-1)
    assert scan.shape == (128, 1024) and scan.xyz is not None and scan.beam_time_s is not None
    np.testing.assert_array_equal(np.isnan(scan.xyz[:, 0]), miss)
    np.testing.assert_array_equal(scan.xyz[~miss], np.stack([cloud[n] for n in "xyz"], -1).reshape(-1, 3)[~miss])
    np.testing.assert_allclose(scan.beam_time_s - scan.time_s, cloud["t"].reshape(-1) * 1e-9, atol=3e-7)


@pytest.mark.parametrize("storage", ["ros1", "mcap"])
def test_livox_custom_messages(tmp_path: pathlib.Path, storage: str) -> None:
    n, ros1 = 100, storage == "ros1"
    rows = np.zeros(n, [("offset_time", "<u4"), ("x", "<f4"), ("y", "<f4"), ("z", "<f4"), ("reflectivity", "u1"),
                        ("tag", "u1"), ("line", "u1")] + ([] if ros1 else [("pad", "u1")]))
    rows["offset_time"], rows["x"], rows["line"] = np.arange(n) * 1000, np.arange(n) + 1, np.arange(n) % 4
    rows["reflectivity"] = np.arange(n)
    head = struct.pack("<III", 1, 50, 5000) if ros1 else b"\0\1\0\0" + struct.pack("<II", 50, 5000)
    frame = struct.pack("<I", 5) + b"livox" if ros1 else struct.pack("<I", 6) + b"livox\0"
    body = head + frame
    if not ros1:
        body += b"\0" * (-(len(body) - 4) % 8)
    body += struct.pack("<QIB3xI", 50 * 10**9, n, 0, n) + (rows.tobytes() if ros1 else rows.tobytes()[:-1])
    with bag(tmp_path / "livox", storage) as out:
        out.store.register(get_types_from_msg(
            "std_msgs/Header header\nuint64 timebase\nuint32 point_num\nuint8 lidar_id\nuint8[3] rsvd\n"
            "livox_ros_driver2/CustomPoint[] points\n", "livox_ros_driver2/msg/CustomMsg"))
        out.store.register(get_types_from_msg(
            "uint32 offset_time\nfloat32 x\nfloat32 y\nfloat32 z\nuint8 reflectivity\nuint8 tag\nuint8 line\n",
            "livox_ros_driver2/msg/CustomPoint"))
        out.raw("/livox/lidar", "livox_ros_driver2/msg/CustomMsg", 50.0, body)
    scan = next(open_recording(tmp_path / "livox").scans())
    assert scan.xyz is not None and scan.beam_time_s is not None
    assert scan.ring is not None and scan.intensity is not None
    np.testing.assert_array_equal(scan.xyz[:, 0], np.arange(n) + 1)
    np.testing.assert_allclose(scan.beam_time_s, 50.000005 + np.arange(n) * 1e-6, atol=1e-12)
    np.testing.assert_array_equal(scan.ring, np.arange(n) % 4)
    np.testing.assert_array_equal(scan.intensity, np.arange(n))


@pytest.mark.parametrize("kind", ["f4", "f8"])
@pytest.mark.parametrize("order", ["<", ">"])
def test_generic_fields(tmp_path: pathlib.Path, kind: str, order: str) -> None:
    points = some_points(64, kind, order).reshape(4, 16)
    points["x"][1, 3], points["x"][2, 5], points["y"][2, 5] = np.nan, 0, 0
    with bag(tmp_path / "generic") as out:
        out.cloud("/points", 10.0, points, row_padding=7)
        out.cloud("/points", 10.1, points.reshape(-1))
    recording = open_recording(tmp_path / "generic")
    first, second = recording.scans()
    assert first.xyz is not None and first.shape == (4, 16) and first.beam_time_s is None
    assert np.flatnonzero(np.isnan(first.xyz[:, 0])).tolist() == [19, 37]
    assert second.shape is None and len(second) == 62
    assert recording.skipped == {"points without coordinates in a cloud that is not organised": 2}


def moving_bag(path: pathlib.Path, storage: str, parts: str) -> tuple[Poses, Poses]:
    """A bag with poses in these parts; returns the poses of the base and those of the lidar."""
    base = straight_path(100.0, 101.0)
    arm, turn = np.array([0.5, -0.2, 1.5]), np.array([0.0, 0.0, np.sqrt(0.5), np.sqrt(0.5)])
    with bag(path, storage) as out:
        for k in range(10):
            out.cloud("/points", 100.0 + 0.1 * k, some_points())
        if "static" in parts:
            out.transform("/tf_static", 100.0, "base_link", "mount", arm, [0, 0, 0, 1])
            out.transform("/tf_static", 100.0, "/mount", "lidar", [0, 0, 0], turn)
        for t, p, q in zip(base.time_s, base.position, base.rotation):
            if "tf " in parts:
                out.transform("/tf", t, "odom", "base_link", p, q)
            if "map" in parts and t in base.time_s[::5]:
                out.transform("/tf", t, "map", "odom", [1000, 0, 0], [0, 0, 0, 1])
            if "odometry" in parts:
                out.pose("/odometry", ODOMETRY, t, "odom", "base_link", p, q)
            if "second" in parts:
                out.pose("/second", ODOMETRY, t, "odom", "base_link", p, q)
            if "pose" in parts:
                out.pose("/pose", POSE, t, "map", "", p, q)
    from underbrush.formats.trajectory import compose
    return base, compose(base, Poses(np.zeros(1), arm[None, :], turn[None, :]))


@pytest.mark.parametrize("storage", ["ros1", "mcap", "sqlite3"])
@pytest.mark.parametrize("parts", ["tf static ", "tf static map ", "odometry static ", "odometry ", "pose "])
def test_poses(tmp_path: pathlib.Path, storage: str, parts: str) -> None:
    base, lidar = moving_bag(tmp_path / "bag", storage, parts)
    recording = open_recording(tmp_path / "bag")
    poses = recording.poses
    assert poses is not None
    expected = lidar if "static" in parts else base
    shift = np.array([1000.0, 0, 0]) if "map" in parts else 0
    position, rotation, inside = pose_at(poses, expected.time_s)
    assert inside.all()
    np.testing.assert_allclose(position, expected.position + shift, atol=1e-6)
    np.testing.assert_allclose(np.abs(np.sum(rotation * expected.rotation, axis=1)), 1, atol=1e-12)
    text = recording.found()[-1]
    assert text.startswith("poses from ")
    assert ("taken for the same" in text) == (parts == "odometry ")


def test_what_is_missing_is_one_line_with_the_option(tmp_path: pathlib.Path) -> None:
    moving_bag(tmp_path / "none", "mcap", "")
    with pytest.raises(OptionMissing, match="none: no poses in it: add --poses FILE"):
        next(beams(open_recording(tmp_path / "none")))
    moving_bag(tmp_path / "many", "mcap", "odometry second static ")
    recording = open_recording(tmp_path / "many")
    assert recording.poses is None
    assert recording.found()[-1].endswith("add --poses /odometry or --poses /second")
    assert open_recording(tmp_path / "many", poses="/second").poses is not None
    with pytest.raises(ValueError, match="no topic and no file '/third' with poses: /odometry, /second, /tf_static"):
        next(beams(open_recording(tmp_path / "many", poses="/third")))
    with bag(tmp_path / "two") as out:
        out.cloud("/a", 1.0, some_points(), "left")
        out.cloud("/b", 1.0, some_points(), "left")
        out.cloud("/b", 1.1, some_points(), "right")
    with pytest.raises(OptionMissing, match="several topics with point clouds: add --topic /a or --topic /b"):
        next(open_recording(tmp_path / "two").scans())
    with pytest.raises(OptionMissing, match="several sensors publish in /b: add --frame left or --frame right"):
        list(open_recording(tmp_path / "two", topic="/b").scans())
    assert len(list(open_recording(tmp_path / "two", topic="/b", frame="right").scans())) == 1
    with pytest.raises(ValueError, match="no point clouds in /c: /a, /b"):
        open_recording(tmp_path / "two", topic="/c")
    with bag(tmp_path / "empty") as out:
        out.pose("/pose", POSE, 1.0, "map", "", [0, 0, 0], [0, 0, 0, 1])
    with pytest.raises(FormatError, match="no topic with point clouds"):
        open_recording(tmp_path / "empty")


def test_poses_that_are_none_are_counted(tmp_path: pathlib.Path) -> None:
    with bag(tmp_path / "bag") as out:
        out.cloud("/points", 1.0, some_points())
        for k in range(4):
            out.transform("/tf", 1.0 + 0.1 * k, "map", "lidar", [k, 0, 0], [0, 0, 0, 1] if k != 2 else [0, 0, 0, 0.5])
    recording = open_recording(tmp_path / "bag")
    assert recording.poses is not None and len(recording.poses.time_s) == 3
    assert recording.skipped == {"poses that are no rotations or not finite": 1}


def test_poses_of_a_file(tmp_path: pathlib.Path) -> None:
    moving_bag(tmp_path / "bag", "mcap", "")
    (tmp_path / "poses.txt").write_text("# t x y z qx qy qz qw\n99 0 0 0 0 0 0 1\n102 3 0 0 0 0 0 1\n")
    back = next(beams(open_recording(tmp_path / "bag", poses=tmp_path / "poses.txt")))
    np.testing.assert_allclose(back["origin"][0], [1, 0, 0])


def test_clocks_that_jump(tmp_path: pathlib.Path) -> None:
    with bag(tmp_path / "jump") as out:
        for k, shift in enumerate((0, 0, -50, 0, 3600, 0)):
            out.cloud("/points", 100 + 0.1 * k + shift, some_points(), bag_s=200 + 0.1 * k)
    recording = open_recording(tmp_path / "jump")
    assert [round(scan.time_s, 3) for scan in recording.scans()] == [100, 100.1, 100.3, 100.5]
    assert list(recording.skipped.values()) == [2] and "--clock bag" in next(iter(recording.skipped))
    times = [round(scan.time_s, 3) for scan in open_recording(tmp_path / "jump", clock="bag").scans()]
    assert times == [200, 200.1, 200.2, 200.3, 200.4, 200.5]


def test_a_sensor_with_a_clock_of_its_own(tmp_path: pathlib.Path) -> None:
    points = np.zeros(10, LAYOUTS["hesai"].dtype)
    points["x"], points["timestamp"] = 1, 1.5e9 + np.arange(10) * 1e-3
    with bag(tmp_path / "clock") as out:
        out.cloud("/points", 1.7e9, points)
    recording = open_recording(tmp_path / "clock")
    assert any("clock of its own" in line for line in recording.found())
    scan = next(recording.scans())
    assert scan.beam_time_s is not None
    np.testing.assert_allclose(scan.beam_time_s, 1.7e9 + np.arange(10) * 1e-3, atol=1e-6)


@pytest.mark.parametrize("storage", ["ros1", "mcap", "sqlite3"])
def test_broken_messages_are_counted(tmp_path: pathlib.Path, storage: str) -> None:
    with bag(tmp_path / "broken", storage) as out:
        for k in range(6):
            out.cloud("/points", 1 + 0.1 * k, some_points())
            if k in (2, 4):
                out.raw("/points", CLOUD, 1.05 + 0.1 * k, b"\0\1\0\0nonsense" * k)
    recording = open_recording(tmp_path / "broken")
    assert len(list(recording.scans())) == 6
    assert recording.skipped == {"messages that cannot be read": 2}


@pytest.mark.parametrize("empty", ['""', "''", "", None])
@pytest.mark.parametrize("storage", ["mcap", "sqlite3"])
def test_folders_that_do_not_name_their_formats_are_read(tmp_path: pathlib.Path, storage: str, empty: str | None) -> None:
    """Without `empty`, the database alone does not name the format of the messages."""
    with bag(tmp_path / "log", storage) as out:
        out.cloud("/points", 1, some_points())
    metadata = tmp_path / "log" / "metadata.yaml"
    named = metadata.read_text()
    told = named
    if empty is not None:
        told = named.replace(f"storage_identifier: {storage}", f"storage_identifier: {empty}")
        told = told.replace("serialization_format: cdr", f"serialization_format: {empty}")
        assert len(named) - len(told) >= 3 + len(storage) - 2 * 2
    metadata.write_text(told)
    (tmp_path / "log" / "notes.mcap").write_text("no recording")
    if storage == "sqlite3":
        with contextlib.closing(sqlite3.connect(next((tmp_path / "log").glob("*.db3")))) as database, database:
            database.execute("update topics set serialization_format = ''")
    assert len(list(open_recording(tmp_path / "log").scans())) == 1
    assert metadata.read_text() == told


def test_a_broken_chunk_is_left_out(tmp_path: pathlib.Path) -> None:
    with bag(tmp_path / "log", "ros1") as out:
        for k in range(40):
            out.cloud("/points", 1 + 0.1 * k, some_points(4000))
    content = bytearray((tmp_path / "log").read_bytes())
    middle = len(content) // 2
    content[middle:middle + 200_000] = b"\xff" * 200_000
    (tmp_path / "log").write_bytes(content)
    recording = open_recording(tmp_path / "log")
    count = len(list(recording.scans()))
    assert 20 < count < 40
    assert recording.skipped["messages in parts of the file that cannot be read"] + count + recording.skipped[
        "messages that cannot be read"] == 40


def test_damaged_files_are_refused_in_one_line(tmp_path: pathlib.Path) -> None:
    for storage, name in (("ros1", "x.bag"), ("mcap", "x/x.mcap"), ("sqlite3", "x/x.db3")):
        root = tmp_path / storage
        root.mkdir()
        with bag(root / name.partition("/")[0], storage) as out:
            out.cloud("/points", 1.0, some_points())
        good = (root / name).read_bytes()
        sizes = [20, len(good) // 3, len(good) - 9]
        if storage == "mcap":  # Its whole messages are read where only the end is lost.
            (root / "bad").write_bytes(good[:sizes.pop()])
            assert len(list(open_recording(root / "bad").scans())) == 1
        for size in sizes:
            (root / "bad").write_bytes(good[:size])
            with pytest.raises(FormatError, match=r"^[^\n]*bad: [^\n]*$"):
                list(open_recording(root / "bad").scans())
    (tmp_path / "text").write_text("nothing of the kind\n")
    with pytest.raises(FormatError, match="is none of LAS"):
        open_recording(tmp_path / "text")
    with pytest.raises(FileNotFoundError):
        open_recording(tmp_path / "absent.bag")


def test_topics_that_are_not_read_are_named(tmp_path: pathlib.Path) -> None:
    """Places without rotations, and scans in a plane, are no poses and no clouds."""
    with bag(tmp_path / "a") as out:
        out.cloud("/points", 1.6e9, some_points())
        at, turn = out.pose_parts(np.zeros(3), np.array([0, 0, 0, 1]))
        kind = "geometry_msgs/msg/PoseArray"
        pose = out.store.types["geometry_msgs/msg/Pose"](position=out.store.types["geometry_msgs/msg/Point"](*at),
                                                         orientation=turn)
        out.send("/array", kind, 1.6e9, out.store.types[kind](header=out.header(1.6e9, "map"), poses=[pose]))
    with pytest.raises(OptionMissing, match=r"no poses in it, and /array .geometry_msgs/msg/PoseArray. is not read: add"):
        next(beams(open_recording(tmp_path / "a")))
    with bag(tmp_path / "b") as out:
        kind = "sensor_msgs/msg/LaserScan"
        out.send("/scan", kind, 1.6e9, out.store.types[kind](
            header=out.header(1.6e9, "laser"), angle_min=0.0, angle_max=1.0, angle_increment=0.5, time_increment=0.0,
            scan_time=0.1, range_min=0.1, range_max=9.0, ranges=np.ones(3, np.float32), intensities=np.zeros(0, np.float32)))
    with pytest.raises(FormatError, match=r"no topic with point clouds .*, and /scan .sensor_msgs/msg/LaserScan. is not read"):
        open_recording(tmp_path / "b")
