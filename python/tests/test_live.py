"""Tests of live sensors in process: several on a vehicle, objects that the caller moves, and point clouds."""
from __future__ import annotations

import json
import pathlib

import numpy as np
import pytest

import underbrush

SENSOR = "velodyne-vlp16"
TIMES = [0.0, 0.01, 0.0233, 0.05, 0.1, 0.17, 0.2]
PLACES = np.array([[3 * t, 4 * t * t, 1.8] for t in TIMES])
TURNS = np.array([[0, 0, np.sin(t), np.cos(t)] for t in TIMES])
AT = [underbrush.Pose(p, q) for p, q in zip(PLACES, TURNS, strict=True)]
PATH = underbrush.Trajectory(np.array(TIMES), PLACES, TURNS)
#: Where an object is: it passes and turns.
ASIDE = [underbrush.Pose(p + [6 - 10 * t, 40 * t - 4, -0.6], q) for t, p, q in zip(TIMES, PLACES, TURNS, strict=True)]
COLUMNS = ("range_m", "intensity", "time_s", "ring", "scan", "packet", "origin", "direction")


def passing() -> underbrush.Trajectory:
    """The object's poses over time."""
    return underbrush.Trajectory(np.array(TIMES), np.array([p.position for p in ASIDE]),
                                 np.array([p.rotation for p in ASIDE]))


def beginning() -> underbrush.Trajectory:
    """The object's motion during the first part."""
    return underbrush.Trajectory(np.array(TIMES[:2]), np.array([p.position for p in ASIDE[:2]]),
                                 np.array([p.rotation for p in ASIDE[:2]]))


def same(parts: list[underbrush.BeamLog], whole: underbrush.BeamLog) -> bool:
    """Whether the parts are the whole, to the bit."""
    columns = [([getattr(part, name) for part in parts], getattr(whole, name)) for name in COLUMNS]
    columns += [([part.extra[name] for part in parts], values) for name, values in whole.extra.items()]
    return all(np.concatenate(pieces).tobytes() == values.tobytes() for pieces, values in columns)


@pytest.fixture
def rig(tmp_path: pathlib.Path) -> pathlib.Path:
    """A rig of two sensors."""
    file = tmp_path / "rig.yaml"
    file.write_text("name: two\nsensors:\n" + "".join(
        f"  - name: {name}\n    sensor: {sensor}\n    position_m: [{x}, 0, 0.2]\n"
        for name, sensor, x in (("front", SENSOR, 1), ("back", "velodyne-hdl32e", -1))), encoding="utf-8")
    return file


def test_a_rig_is_that_of_simulate(model: underbrush.Model, rig: pathlib.Path) -> None:
    """Parts of a rig's time are what `simulate` answers, and a firing after a gap has numbers of its own."""
    lidar = underbrush.Lidar(model, rig=rig)
    assert [s.name for s in lidar.sensors.values()] == [SENSOR, "velodyne-hdl32e"]
    assert list(lidar.sensors) == ["front", "back"]
    parts = [lidar.fire(AT[k - 1], AT[k], TIMES[k - 1], TIMES[k]) for k in range(1, len(TIMES))]
    whole = underbrush.simulate(model, rig=rig, trajectory=PATH)
    assert set(whole.extra["sensor"]) == {0, 1}
    assert same(parts, whole)
    later = lidar.fire(AT[0], AT[1], 5.0, 5.01)
    assert set(later.scan) == {2}
    assert (later.range_m != parts[0].range_m).any(), "random numbers are not drawn twice"
    lidar.reset()
    assert same([lidar.scan(AT[0], time=1.0)], underbrush.Lidar(model, rig=rig).scan(AT[0], time=1.0))


def test_objects_move_with_the_calls(model: underbrush.Model, box_mesh: pathlib.Path) -> None:
    """Poses that calls give are those of `simulate --mover`; without one, no beam meets the object."""
    lidar = underbrush.Lidar(model, SENSOR, movers={"van": box_mesh})
    assert lidar.actors == ["van"]
    moves: list[underbrush.live.Actors] = [{"van": beginning()}, *({"van": at} for at in ASIDE[2:4]),
                                           *({"van": at.matrix()} for at in ASIDE[4:])]
    parts = [lidar.fire(AT[k - 1], AT[k], TIMES[k - 1], TIMES[k], actors=moves[k - 1]) for k in range(1, len(TIMES))]
    seen = underbrush.simulate(model, sensor=SENSOR, trajectory=PATH, movers=[(box_mesh, passing(), "")])
    plain = underbrush.simulate(model, sensor=SENSOR, trajectory=PATH)
    assert (seen.range_m != plain.range_m).sum() > 500
    assert same(parts, seen)
    for absent in ({}, {"van": None}):
        lidar.reset()
        assert same([lidar.fire(AT[k - 1], AT[k], TIMES[k - 1], TIMES[k], actors=absent)
                     for k in range(1, len(TIMES))], plain)
    with pytest.raises(ValueError, match="no actor 'car'"):
        lidar.scan(AT[0], actors={"car": AT[1]})


def test_an_actor_without_an_earlier_pose_stands(model: underbrush.Model, box_mesh: pathlib.Path) -> None:
    """The first pose holds for all of its call, after an absence and for a time before, too."""
    lidar = underbrush.Lidar(model, SENSOR, movers={"van": box_mesh})
    still = underbrush.Trajectory(np.array([0.0]), ASIDE[6].position[None], ASIDE[6].rotation[None])
    expected = lidar.scan(AT[0], actors={"van": still})
    for before in (None, ASIDE[0]):
        lidar.reset()
        lidar.scan(AT[0], time=5.0, actors={"van": before})
        moved = lidar.scan(AT[0], actors={"van": ASIDE[6]})
        lidar.reset()
        lidar.scan(AT[0], time=5.0)
        assert same([moved], lidar.scan(AT[0], actors={"van": still}))
    assert (expected.range_m != underbrush.Lidar(model, SENSOR).scan(AT[0]).range_m).any()


def test_learnt_actors_are_those_of_simulate(model: underbrush.Model, learnt_actors: pathlib.Path,
                                             tmp_path: pathlib.Path) -> None:
    """Without poses they move as they were recorded, and with poses as along a trajectory of an edit."""
    lidar = underbrush.Lidar(model, SENSOR, actors=learnt_actors)
    assert lidar.actors == ["car-1"]
    plain = underbrush.simulate(model, sensor=SENSOR, trajectory=PATH)
    recorded = underbrush.simulate(model, sensor=SENSOR, trajectory=PATH, actors=learnt_actors)
    assert (recorded.range_m != plain.range_m).sum() > 200
    assert same([lidar.fire(AT[k - 1], AT[k], TIMES[k - 1], TIMES[k]) for k in range(1, len(TIMES))], recorded)
    rows = [" ".join(map(repr, map(float, [t, *p.position, *p.rotation]))) for t, p in zip(TIMES, ASIDE, strict=True)]
    (tmp_path / "poses.txt").write_text("\n".join(rows) + "\n", encoding="utf-8")
    edit = {"edit": "trajectory", "actor": "car-1", "trajectory": "poses.txt"}
    (tmp_path / "edits.json").write_text(json.dumps({
        "format": "underbrush-actor-edits", "version": 1, "actors": str(learnt_actors), "edits": [edit]}),
        encoding="utf-8")
    lidar.reset()
    given: list[underbrush.live.Actors] = [{"car-1": beginning()}, *({"car-1": at} for at in ASIDE[2:])]
    parts = [lidar.fire(AT[k - 1], AT[k], TIMES[k - 1], TIMES[k], actors=given[k - 1]) for k in range(1, len(TIMES))]
    edited = underbrush.simulate(model, sensor=SENSOR, trajectory=PATH, actors=tmp_path / "edits.json")
    assert (edited.range_m != recorded.range_m).sum() > 200
    assert same(parts, edited)


def test_clouds_have_the_points_of_the_beams(model: underbrush.Model, rig: pathlib.Path) -> None:
    """Each sensor has a cloud of its returns, in its own frame, at the distances of its beams."""
    beams = underbrush.Lidar(model, rig=rig).fire(AT[0], AT[3], 0.0, 0.05)
    clouds = underbrush.Lidar(model, rig=rig).fire_clouds(AT[0], AT[3], 0.0, 0.05, layout="velodyne")
    assert [c.sensor for c in clouds] == ["front", "back"]
    for k, cloud in enumerate(clouds):
        offsets = {name: offset for name, offset, _ in cloud.fields}
        kinds = np.dtype({"names": ["x", "y", "z"], "formats": ["<f4"] * 3, "itemsize": cloud.point_step,
                          "offsets": [offsets[axis] for axis in "xyz"]})
        points = np.frombuffer(cloud.data, kinds)
        assert len(points) == cloud.width * cloud.height
        far = np.sqrt(sum(points[axis].astype(float) ** 2 for axis in "xyz"))
        ranges = beams.range_m[(beams.extra["sensor"] == k) & np.isfinite(beams.range_m)]
        assert len(points) > 1000
        assert np.allclose(np.sort(far[np.isfinite(far)]), np.sort(ranges), atol=1e-3)
        assert cloud.time_s == 0
        assert np.allclose(cloud.world_from_sensor.position, [1 - 2 * k, 0, 2.0])


def test_says_what_is_wrong(model: underbrush.Model, rig: pathlib.Path) -> None:
    with pytest.raises(ValueError, match="a sensor or a rig"):
        underbrush.Lidar(model)
    with pytest.raises(ValueError, match="a sensor or a rig"):
        underbrush.Lidar(model, SENSOR, rig=rig)
    lidar = underbrush.Lidar(model, SENSOR)
    with pytest.raises(ValueError, match="no profile .odd."):
        lidar.fire_clouds(AT[0], AT[1], 0.0, 0.1, layout="odd")
    with pytest.raises(ValueError, match="rigid"):
        lidar.scan(AT[0], actors={"van": np.ones((4, 4))})
    assert lidar.scans == 0
