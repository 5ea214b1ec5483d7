"""Tests of what carries the scans of the sensor server on: the Foxglove stream, and the example package of ROS 2."""
from __future__ import annotations

import importlib
import importlib.util
import json
import pathlib
import struct
import subprocess
import sys
import threading
import types
from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

import pytest

from test_live_server import ROOT, SENSOR, Server, at, place, serving

TIMES = [0.0, 0.1, 0.2, 0.25]


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    """A server of two sensors before a wall."""
    folder = tmp_path_factory.mktemp("stream")
    (folder / "wall.obj").write_text("v 9 -9 -9\nv 9 9 -9\nv 9 9 9\nv 9 -9 9\nf 1 2 3\nf 1 3 4\n", encoding="utf-8")
    rig = "name: two\nsensors:\n" + "".join(
        f"  - name: {name}\n    sensor: {SENSOR}\n    position_m: [{x}, 0, 0.2]\n" for name, x in (("a", 1), ("b", -1)))
    (folder / "rig.yaml").write_text(rig, encoding="utf-8")
    with serving(folder / "wall.obj", "--rig", folder / "rig.yaml") as one:
        yield one


def clouds_of(server: Server) -> list[Any]:
    """The clouds of a drive, as the server sends them."""
    client = server.client()
    return [part.cloud for t in TIMES[1:] for part in client.parts(t, at(t), layout="velodyne")]


def test_a_recording_has_the_clouds_of_the_server(server: Server, tmp_path: pathlib.Path) -> None:
    """Points, fields, times and places of the MCAP file are those of the answers."""
    pytest.importorskip("foxglove")
    make_reader = pytest.importorskip("mcap.reader").make_reader
    decoders = [pytest.importorskip("mcap_protobuf.decoder").DecoderFactory()]
    rows = [" ".join(map(repr, [t, *place(t)[0], *place(t)[1]])) for t in TIMES]
    (tmp_path / "poses.txt").write_text("# a drive\n" + "\n".join(rows) + "\n", encoding="utf-8")
    (tmp_path / "token").write_text(server.token, encoding="utf-8")
    done = subprocess.run([sys.executable, ROOT / "share/live/foxglove_stream.py", server.address, "--token",
                           tmp_path / "token", "--trajectory", tmp_path / "poses.txt", "--mcap", tmp_path / "drive.mcap"],
                          check=True, capture_output=True, text=True)
    expected = clouds_of(server)
    assert done.stdout == f"{len(expected)} clouds\n"
    with open(tmp_path / "drive.mcap", "rb") as file:
        found = [(channel.topic, message.log_time, decoded) for _, channel, message, decoded
                 in make_reader(file, decoder_factories=decoders).iter_decoded_messages()]
    points = [m for m in found if m[0] != "/tf"]
    places = [m for m in found if m[0] == "/tf"]
    assert len(points) == len(places) == len(expected) == 6
    names = {0: "", 1: "Int8", 2: "UINT8", 3: "INT16", 4: "UINT16", 5: "INT32", 6: "UINT32", 7: "FLOAT32", 8: "FLOAT64"}
    for cloud, (topic, stamp, message), (_, _, where) in zip(expected, points, places, strict=True):
        assert topic == f"/{cloud.sensor}/points"
        assert message.frame_id == where.child_frame_id == cloud.sensor
        assert message.data == cloud.data
        assert len(cloud.data) > 0
        assert stamp == round(1e9 * cloud.stamp_s)
        told = [(f.name, f.offset, type(f).NumericType.Name(f.type)) for f in message.fields]
        assert told == [(f.name, f.offset, names[f.datatype]) for f in cloud.fields]
        assert message.point_stride == cloud.point_step
        body = cloud.world_from_sensor.world_from_body
        assert (where.translation.x, where.translation.y, where.translation.z) == (body.x, body.y, body.z)
        assert (where.rotation.z, where.rotation.w) == (body.qz, body.qw)


def test_foxglove_gets_the_clouds_as_they_are_made(server: Server) -> None:
    """A client of the WebSocket that subscribes to a sensor gets the bytes of its clouds."""
    pytest.importorskip("foxglove")
    sync = pytest.importorskip("websockets.sync.client")
    stream_of = importlib.import_module("foxglove_stream")
    stream = stream_of.FoxgloveStream(port=0)
    expected = [cloud for cloud in clouds_of(server) if cloud.sensor == "b"]
    for cloud in expected[:1]:
        stream.send(cloud)
    with sync.connect(f"ws://127.0.0.1:{stream.port}", subprotocols=["foxglove.sdk.v1"], max_size=None) as socket:
        channels: dict[str, int] = {}
        while "/b/points" not in channels:
            message = json.loads(socket.recv(timeout=10))
            channels.update({c["topic"]: c["id"] for c in message.get("channels", [])})
        subscription = {"id": 7, "channelId": channels["/b/points"]}
        socket.send(json.dumps({"op": "subscribe", "subscriptions": [subscription]}))
        more = threading.Event()

        def send() -> None:
            while not more.wait(0.05):  # until the subscription has arrived
                stream.send(expected[1])

        sender = threading.Thread(target=send)
        sender.start()
        try:
            while True:
                got = socket.recv(timeout=10)
                if isinstance(got, bytes) and got[0] == 1:
                    break
        finally:
            more.set()
            sender.join()
    assert struct.unpack_from("<IQ", got, 1) == (7, round(1e9 * expected[1].stamp_s))
    assert expected[1].data in got
    stream.close()


class _Message:
    """Stands for any message of ROS: members come into being when they are asked for."""

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        value: Any = [] if name == "fields" else _Message()
        setattr(self, name, value)
        return value


class _Node:
    """Stands for rclpy's Node."""

    def __init__(self, name: str) -> None:
        self.parameters: dict[str, Any] = {}
        self.published: dict[str, list[Any]] = {}
        self.callback: Any = None

    def declare_parameter(self, name: str, value: Any) -> None:
        self.parameters[name] = value

    def get_parameter(self, name: str) -> Any:
        return SimpleNamespace(value=self.parameters[name])

    def create_subscription(self, kind: type, topic: str, callback: Any, depth: int) -> None:
        self.callback = callback

    def create_publisher(self, kind: type, topic: str, depth: int) -> Any:
        return SimpleNamespace(publish=self.published.setdefault(topic, []).append)


def test_the_node_of_ros_publishes_the_clouds(server: Server, tmp_path: pathlib.Path,
                                              monkeypatch: pytest.MonkeyPatch) -> None:
    """With stand-ins for ROS 2: each odometry but the first is answered by the clouds of all sensors."""
    places: list[Any] = []
    stand_ins = {"rclpy": {}, "rclpy.node": {"Node": _Node}, "geometry_msgs.msg": {"TransformStamped": _Message},
                 "nav_msgs.msg": {"Odometry": _Message},
                 "sensor_msgs.msg": {"PointCloud2": _Message, "PointField": _Message},
                 "tf2_ros": {"TransformBroadcaster": lambda node: SimpleNamespace(sendTransform=places.append)}}
    for name, members in stand_ins.items():
        module = types.ModuleType(name)
        vars(module).update(members)
        monkeypatch.setitem(sys.modules, name, module)
    spec = importlib.util.spec_from_file_location("node", ROOT / "share/live/ros2/underbrush_live_ros/node.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    node = module.LiveNode()
    (tmp_path / "token").write_text(server.token + "\n", encoding="utf-8")
    node.parameters.update(address=server.address, token_file=str(tmp_path / "token"))
    for t in TIMES:
        odometry = _Message()
        odometry.header.stamp.sec, odometry.header.stamp.nanosec = 0, round(1e9 * t)
        position, quaternion = place(t)
        at_message = odometry.pose.pose
        at_message.position.x, at_message.position.y, at_message.position.z = position
        o = at_message.orientation
        o.x, o.y, o.z, o.w = quaternion
        node.callback(odometry)
    expected = clouds_of(server)
    assert set(node.published) == {"a/points", "b/points"}
    assert len(places) == len(expected)
    for name in ("a", "b"):
        told = node.published[f"{name}/points"]
        for message, cloud in zip(told, [c for c in expected if c.sensor == name], strict=True):
            assert message.data == cloud.data
            assert message.header.frame_id == name
            assert message.row_step * message.height == len(cloud.data)
            assert [(f.name, f.offset, f.datatype) for f in message.fields] == [(f.name, f.offset, f.datatype)
                                                                               for f in cloud.fields]


def test_the_package_of_ros_is_built(tmp_path: pathlib.Path) -> None:
    """Where ROS 2 is installed, the package is built and its node can be imported."""
    pytest.importorskip("rclpy")
    subprocess.run([sys.executable, "-m", "pip", "install", "-q", "--no-deps", "--no-build-isolation", "--target", tmp_path,
                    ROOT / "share/live/ros2"], check=True)
    subprocess.run([sys.executable, "-c", "import underbrush_live_ros.node"], check=True, env={"PYTHONPATH": str(tmp_path)})
