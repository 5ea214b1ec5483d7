"""Tests of the sensor server `underbrush live` and of its client."""
from __future__ import annotations

import contextlib
import importlib
import itertools
import json
import math
import os
import pathlib
import random
import re
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

import underbrush
from underbrush.cli import program

grpc = pytest.importorskip("grpc")
ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = pathlib.Path(program()).resolve()
if not (PROGRAM.parent.parent / "lib" / "underbrush" / "live_grpc.so").exists():
    pytest.skip("built without gRPC: scripts/setup.sh live", allow_module_level=True)
sys.path.append(str(ROOT / "share" / "live"))
live = importlib.import_module("underbrush_live")
SENSOR = "velodyne-vlp16"


class Server:
    """A running server."""

    def __init__(self, *words: object) -> None:
        self.process = subprocess.Popen([PROGRAM, "live", *map(str, words), "--json", "-"], stdout=subprocess.PIPE,
                                        text=True)
        assert self.process.stdout is not None
        lines = iter(self.process.stdout.readline, "")
        started = json.loads("".join(next(lines) for _ in range(5)))
        self.address, self.token = started["address"], started["token"]

    def client(self, token: str | None = None, start_s: float = 0.0) -> Any:
        """A client whose sensor is where the vehicle is at the start."""
        return live.SensorServer(self.address, self.token if token is None else token, start_s, at(start_s))

    def resident_mb(self) -> float:
        """Resident memory, MB."""
        pages = int(pathlib.Path(f"/proc/{self.process.pid}/statm").read_text(encoding="utf-8").split()[1])
        return pages * 4096 / 1e6

    def end(self, signal_number: int = signal.SIGTERM) -> None:
        """Ends the server and waits for it."""
        self.process.send_signal(signal_number)
        self.process.communicate()


@contextlib.contextmanager
def serving(*words: object) -> Iterator[Server]:
    """A server as long as the block runs."""
    server = Server(*words)
    try:
        yield server
    finally:
        if server.process.poll() is None:
            server.end()


def place(time_s: float) -> tuple[list[float], list[float]]:
    """Position and quaternion of the sensor on its way."""
    return [2 * time_s, 0.3 * time_s ** 2, 1.8], [0, 0, math.sin(0.2 * time_s), math.cos(0.2 * time_s)]


def at(time_s: float) -> Any:
    """The same as a pose of the server."""
    return live.pose(*place(time_s))


@pytest.fixture(scope="module")
def world(log_file: pathlib.Path, tmp_path_factory: pytest.TempPathFactory) -> pathlib.Path:
    """The folder of a model."""
    folder = tmp_path_factory.mktemp("live") / "model"
    underbrush.fit(log_file, output=folder)
    return folder


@pytest.fixture(scope="module")
def server(world: pathlib.Path) -> Iterator[Server]:
    """A server that most tests share."""
    with serving(world, "--sensor", SENSOR) as one:
        yield one


def status_of(call: Any) -> Any:
    """The status with which a call ends."""
    try:
        list(call)
    except grpc.RpcError as error:
        assert "\n" not in error.details()
        return error.code()
    return grpc.StatusCode.OK


def test_a_hundred_revolutions_are_those_of_simulate(world: pathlib.Path, server: Server) -> None:
    """Columns of the same bits, whole revolutions and parts of them, in memory that does not grow."""
    times = [0.1 * k for k in range(97)] + [9.6 + 0.01 * k for k in range(1, 41)]
    way = [place(t) for t in times]
    path = underbrush.Trajectory(np.array(times), np.array([p for p, _ in way]), np.array([q for _, q in way]))
    expected = underbrush.simulate(world, sensor=SENSOR, trajectory=path)
    client, pieces, sizes = server.client(), [], []
    for t in times[1:]:
        sizes.append(server.resident_mb())
        pieces.append(client.fire(t, at(t), columns=["range_m", "intensity", "time_s", "ring", "scan", "origin"]))
    assert len(expected) > 2_800_000
    for name in pieces[0]:
        assert np.concatenate([p[name] for p in pieces]).tobytes() == getattr(expected, name).tobytes(), name
    assert sizes[-1] - max(sizes[:15]) < 5, "memory stays flat"


@pytest.fixture(scope="module")
def rig(tmp_path_factory: pytest.TempPathFactory) -> pathlib.Path:
    """A rig of two sensors."""
    file = tmp_path_factory.mktemp("rig") / "rig.yaml"
    file.write_text("name: two\nsensors:\n" + "".join(
        f"  - name: {name}\n    sensor: {SENSOR}\n    position_m: [{x}, 0, 0.2]\n"
        for name, x in (("a", 1), ("b", -1))), encoding="utf-8")
    return file


@pytest.fixture(scope="module")
def rig_server(world: pathlib.Path, rig: pathlib.Path, box_mesh: pathlib.Path) -> Iterator[Server]:
    """A server of a rig of two sensors, and of a box that clients move."""
    with serving(world, "--rig", rig, "--mover", f"box={box_mesh}") as one:
        yield one


def test_describes_itself(rig_server: Server) -> None:
    """Sensors of a rig and movers are listed, and the rig's beams tell their sensors apart."""
    client = rig_server.client()
    told = client.describe()
    assert [s.name for s in told.sensors] == ["a", "b"]
    assert list(told.actors) == ["box"]
    without = client.fire(0.1, at(0.1))
    assert set(without["sensor"]) == {0, 1}
    assert (np.diff(without["time_s"]) >= 0).all()
    again = rig_server.client()
    seen = again.fire(0.1, at(0.1), {"box": live.pose([6, 0, 1.8])})
    assert (seen["range_m"] != without["range_m"]).any()
    clouds = [part.cloud for part in rig_server.client().parts(0.1, at(0.1), layout="velodyne")]
    assert [c.sensor for c in clouds] == ["a", "b"]
    assert all(len(c.data) == c.point_step * c.width * c.height > 0 for c in clouds)


def test_a_lidar_in_process_is_the_server(rig_server: Server, world: pathlib.Path, rig: pathlib.Path,
                                          box_mesh: pathlib.Path) -> None:
    """`Lidar` has the columns and the clouds of the server for the same poses of vehicle and actors, to the bit."""
    times = [0.0, 0.03, 0.1, 0.15]
    box = {0.03: [8, 1, 1.8], 0.1: [7, 2, 1.8], 0.15: None}
    poses = {t: underbrush.Pose(*place(t)) for t in times}
    lidar = underbrush.Lidar(world, rig=rig, movers={"box": box_mesh})
    assert list(lidar.sensors) == [s.name for s in rig_server.client().describe().sensors]
    for layout in ("", "velodyne", "autoware"):
        lidar.reset()
        client = rig_server.client()
        for start, end in itertools.pairwise(times):
            theirs = {"box": box[end] and live.pose(box[end])}
            ours = {"box": underbrush.Pose(box[end]) if box[end] else None}
            span = (poses[start], poses[end], start, end)
            if not layout:
                beams, columns = lidar.fire(*span, actors=ours), client.fire(end, at(end), theirs)
                assert columns.pop("sensor").tobytes() == beams.extra["sensor"].tobytes()
                assert all(values.tobytes() == getattr(beams, name).tobytes() for name, values in columns.items())
                continue
            clouds = lidar.fire_clouds(*span, actors=ours, layout=layout)
            answers = [part.cloud for part in client.parts(end, at(end), theirs, layout=layout)]
            for cloud, answer in zip(clouds, answers, strict=True):
                for name in ("sensor", "height", "width", "point_step", "data"):
                    assert getattr(cloud, name) == getattr(answer, name), name
                assert cloud.fields == [(f.name, f.offset, f.datatype) for f in answer.fields]
                assert cloud.time_s == answer.stamp_s
                body = answer.world_from_sensor.world_from_body
                assert list(cloud.world_from_sensor.position) == [body.x, body.y, body.z]


def test_learnt_actors_are_those_of_simulate(world: pathlib.Path, learnt_actors: pathlib.Path,
                                             tmp_path: pathlib.Path) -> None:
    """Learnt actors that move as recorded or on other paths, or are absent, are those of `simulate --actors`."""
    times = [0.05 * k for k in range(1, 11)]  # from the first scan in which the actor was found
    way = [place(t) for t in times]
    car = {t: ([6 - 9 * t, 4 + 2 * t, 1.2], [0, 0, math.sin(t), math.cos(t)]) for t in times}
    (tmp_path / "car.txt").write_text("".join(
        " ".join(map(repr, map(float, [t, *p, *q]))) + "\n" for t, (p, q) in car.items()), encoding="utf-8")

    def edited(name: str, **edit: str) -> pathlib.Path:
        path = tmp_path / f"{name}.json"
        path.write_text(json.dumps({"format": "underbrush-actor-edits", "version": 1, "actors": str(learnt_actors),
                                    "edits": [{"edit": name, "actor": "car-1", **edit}]}), encoding="utf-8")
        return path

    poses = {t: live.pose(*at_time) for t, at_time in car.items()}
    cases: list[tuple[pathlib.Path, Any]] = [
        (learnt_actors, lambda t: {}), (edited("trajectory", trajectory="car.txt"), lambda t: {"car-1": poses[t]}),
        (edited("remove"), lambda t: {"car-1": None})]
    path = underbrush.Trajectory(np.array(times), np.array([p for p, _ in way]), np.array([q for _, q in way]))
    columns = ["range_m", "intensity", "time_s", "ring", "scan", "origin", "direction"]
    seen = []
    with serving(world, "--sensor", SENSOR, "--actors", learnt_actors) as own:
        assert list(own.client().describe().actors) == ["car-1"]
        for actors, given in cases:
            expected = underbrush.simulate(world, sensor=SENSOR, trajectory=path, actors=actors)
            client = live.SensorServer(own.address, own.token, times[0], at(times[0]), **given(times[0]))
            pieces = [client.fire(t, at(t), given(t), columns=columns) for t in times[1:]]
            for name in columns:
                assert np.concatenate([p[name] for p in pieces]).tobytes() == getattr(expected, name).tobytes(), name
            seen.append(expected.range_m)
    assert all((a != b).sum() > 200 for a, b in itertools.combinations(seen, 2))


def test_requests_name_worlds_of_a_folder(world: pathlib.Path, tmp_path: pathlib.Path) -> None:
    """The same request in another world is answered by that world, and nothing outside of the folder is opened."""
    (tmp_path / "worlds").mkdir()
    wall = "v 5 -9 -9\nv 5 9 -9\nv 5 9 9\nv 5 -9 9\nf 1 2 3\nf 1 3 4\n"
    (tmp_path / "worlds" / "wall.obj").write_text(wall, encoding="utf-8")
    with serving(world, "--sensor", SENSOR, "--worlds", tmp_path / "worlds") as own:
        assert list(own.client().describe().worlds) == ["wall.obj"]
        own.client().describe("wall.obj")
        seen = own.client().fire(0.1, at(0.1), world="wall.obj", columns=["range_m", "origin", "direction"])
        hit = np.isfinite(seen["range_m"])
        ends = (seen["origin"] + seen["range_m"][:, None] * seen["direction"])[hit]
        assert hit.sum() > 1000
        assert np.abs(ends[:, 0] - 5).max() < 0.2
        plain = own.client().fire(0.1, at(0.1))["range_m"]
        assert plain.tobytes() != seen["range_m"].tobytes()
        for name in ("..", "../model", "none", "/"):
            with pytest.raises(grpc.RpcError) as caught:
                own.client().describe(name)
            assert caught.value.code() == grpc.StatusCode.INVALID_ARGUMENT
            assert status_of(own.client().parts(0.1, at(0.1), world=name)) == grpc.StatusCode.INVALID_ARGUMENT


def test_wrong_tokens_and_endless_calls_are_refused(server: Server) -> None:
    """Nobody without the token gets an answer, and no call may wait forever."""
    for token in ("", "0" * 32, server.token[:-1], server.token + "0"):
        other = server.client(token)
        assert status_of(other.parts(0.1, at(0.1))) == grpc.StatusCode.UNAUTHENTICATED
        with pytest.raises(grpc.RpcError):
            other.describe()
    assert status_of(server.client().parts(0.1, at(0.1), timeout=None)) == grpc.StatusCode.INVALID_ARGUMENT
    assert status_of(server.client().parts(0.1, at(0.1), timeout=1e-4)) == grpc.StatusCode.DEADLINE_EXCEEDED
    big = server.client().parts(0.1, at(0.1), columns=["x" * (1 << 21)])
    assert status_of(big) == grpc.StatusCode.RESOURCE_EXHAUSTED


def odd_request(draw: random.Random) -> Any:
    """A request with one or several things that cannot be, or a good one."""
    odd = [math.nan, math.inf, -math.inf, -1.0, 1e300, -1e300, 0.0, 0.05, 0.1, 1e-300, 4e9]
    number = lambda usual: usual if draw.random() < 0.7 else draw.choice(odd)
    poses = [live.proto.StampedPose(time_s=number(t), world_from_body=live.proto.Pose(
        x=number(0), y=number(0), z=number(1.8), qz=number(0), qw=number(1))) for t in (0, 0.001)[: draw.choice([0, 1, 2, 2, 2])]]
    motion = live.proto.Motion(poses=poses)
    if draw.random() < 0.2:
        motion.velocity_m_per_s.x = number(1)
        motion.turn_rate_rad_per_s.z = number(1)
    request = live.proto.FireRequest(start_s=number(0), from_s=number(0), until_s=number(0.001), vehicle=motion)
    if draw.random() < 0.1:
        request.actors.append(live.proto.Actor(name=draw.choice(["", "van", "\x1b[2J"]), motion=motion))
    if draw.random() < 0.1:
        request.columns.extend(draw.choice([["range_m"] * 9, ["\0"], ["weight"], ["origin", "direction"]]))
    if draw.random() < 0.1:
        request.layout = draw.choice(["ouster", "\n", "VELODYNE"])
    return request


def damaged(message: bytes, draw: random.Random) -> bytes:
    """The bytes of a request with some of them changed, cut off or repeated."""
    data = bytearray(message)
    for _ in range(draw.randint(1, 4)):
        at = draw.randrange(len(data) + 1)
        kind = draw.randrange(3)
        if kind == 0 and at < len(data):
            data[at] = draw.randrange(256)
        elif kind == 1:
            del data[at:]
        else:
            data[at:at] = data[: draw.randrange(len(data) + 1)]
    return bytes(data)


def test_odd_requests_get_one_status(server: Server) -> None:
    """Whatever the bytes of 10 000 requests, each is answered or refused in a line, and the server lives on."""
    draw, client = random.Random(50), server.client()
    fire = client.channel.unary_stream("/underbrush.live.v1.SensorServer/Fire")
    seen: dict[Any, int] = {}
    sizes = []
    for k in range(10_000):
        message = odd_request(draw).SerializeToString()
        status = status_of(fire(message if k % 2 else damaged(message, draw), metadata=client.metadata, timeout=20))
        seen[status] = seen.get(status, 0) + 1
        if k % 100 == 0:
            sizes.append(server.resident_mb())
    assert set(seen) == {grpc.StatusCode.OK, grpc.StatusCode.INVALID_ARGUMENT, grpc.StatusCode.INTERNAL}
    assert min(seen.values()) > 100
    assert server.process.poll() is None
    assert max(sizes) - max(sizes[:20]) < 10, "memory stays flat"


def test_slow_clients_neither_hold_the_server_nor_fill_it(server: Server) -> None:
    """Clients that do not read are served up to the limit; others are refused beyond it, and else answered meanwhile."""
    wanted = {"columns": ["origin", "direction", "time_s"]}
    before, slow, status = server.resident_mb(), [], grpc.StatusCode.OK
    while status == grpc.StatusCode.OK and len(slow) < 12:
        client = server.client()
        call = client.parts(2.5, at(2.5), timeout=20, **wanted)
        with contextlib.suppress(grpc.RpcError):
            next(iter(call))
        slow.append((client, call))
        status = status_of(server.client().parts(0.01, at(0.01)))
    assert status == grpc.StatusCode.RESOURCE_EXHAUSTED
    assert server.resident_mb() - before < 500
    for client, _ in slow:
        client.channel.close()
    time.sleep(0.2)
    start = time.monotonic()
    assert len(server.client().fire(0.1, at(0.1))["ring"]) > 20_000
    assert time.monotonic() - start < 2


def test_a_killed_server_goes_on_where_it_was(world: pathlib.Path, tmp_path: pathlib.Path) -> None:
    """With the same token and address, a client does not notice that the server was started anew."""
    (tmp_path / "token").write_text("a-token-of-this-test\n", encoding="utf-8")
    words = (world, "--sensor", SENSOR, "--token", tmp_path / "token", "--listen", f"unix:{tmp_path}/socket")
    answers = []
    for killed in (False, True):
        server = Server(*words)
        client = server.client()
        found = [client.fire(0.05, at(0.05))["range_m"]]
        if killed:
            server.end(signal.SIGKILL)
            assert status_of(client.parts(0.15, at(0.15), timeout=0.3)) != grpc.StatusCode.OK
            server = Server(*words)
        found.append(client.fire(0.15, at(0.15))["range_m"])
        answers.append(np.concatenate(found).tobytes())
        server.end()
    assert answers[0] == answers[1]


def test_says_what_is_wrong(world: pathlib.Path, server: Server, tmp_path: pathlib.Path) -> None:
    """One line and a status for a port that is taken, a bad token, and a program without the server's library."""
    (tmp_path / "token").write_text("short", encoding="utf-8")
    shutil.copy(PROGRAM, tmp_path / "underbrush")
    for start, words, line in (
            (PROGRAM, ["--listen", server.address], "cannot be listened to"),
            (PROGRAM, ["--token", str(tmp_path / "token")], "a token is one word"),
            (PROGRAM, ["--mover", "box"], "--mover takes NAME=MODEL"),
            (tmp_path / "underbrush", [], "this build has no sensor server")):
        done = subprocess.run([start, "live", world, "--sensor", SENSOR, *words], capture_output=True, text=True,
                              check=False)
        assert done.returncode != 0
        assert line in done.stderr and done.stderr.count("\n") == 1


def test_the_loop_of_the_page_keeps_to_its_street(tmp_path: pathlib.Path) -> None:
    """The vehicle stays in the middle of its street and behind the van."""
    page = (ROOT / "docs" / "how-to" / "in-your-loop.md").read_text(encoding="utf-8")
    found = re.search(r"```python\n(.*?)^```", page, re.M | re.S)
    assert found
    where = dict(os.environ, PATH=f"{PROGRAM.parent}{os.pathsep}{os.environ['PATH']}",
                 PYTHONPATH=str(ROOT / "share" / "live"))
    done = subprocess.run([sys.executable, "-c", found.group(1)], cwd=tmp_path, env=where, capture_output=True, text=True,
                          check=True)
    along, beside, behind = map(float, re.findall(r"-?[0-9.]+(?= m)", done.stdout))
    assert along > 20 and abs(beside) < 1 and 6 < behind < 20
