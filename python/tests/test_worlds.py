"""Worlds of other programs: meshes and voxels where a model or scene is taken, and a tripod of one pose."""
from __future__ import annotations

import pathlib

import numpy as np
import pytest

import underbrush

WALL = "o wall\nusemtl Plaster\nv 10 -5 0\nv 10 5 0\nv 10 5 9\nv 10 -5 9\nf 1 2 3 4\n"


def tripod() -> underbrush.Trajectory:
    return underbrush.Trajectory(np.zeros(1), np.array([[0.0, 0.0, 2.0]]), np.array([[0.0, 0.0, 0.0, 1.0]]))


def test_a_mesh_is_a_world(tmp_path: pathlib.Path) -> None:
    path = tmp_path / "wall.obj"
    path.write_text(WALL)
    scene = underbrush.read_scene(path)
    assert len(scene) == 2
    assert scene.classes == ["Plaster"]
    sensor = underbrush.Sensor("velodyne-vlp16")
    logs = [underbrush.simulate(world, sensor=sensor, trajectory=tripod(), element_ids=True) for world in (path, scene)]
    for log in logs:
        hit = np.isfinite(log.range_m)
        assert hit.any() and not hit.all()
        ends = log.origin[hit] + log.range_m[hit][:, None].astype(float) * log.direction[hit]
        np.testing.assert_allclose(ends[:, 0], 10, atol=1e-4)
        assert set(log.extra["instance"][hit]) == {1}
    np.testing.assert_array_equal(logs[0].range_m, logs[1].range_m)


def test_beams_that_meet_nothing_are_a_warning(tmp_path: pathlib.Path) -> None:
    path = tmp_path / "wall.obj"
    path.write_text(WALL)
    far = underbrush.Trajectory(np.zeros(1), np.array([[0.0, 0.0, 2000.0]]), np.array([[0.0, 0.0, 0.0, 1.0]]))
    sensor = underbrush.Sensor("velodyne-vlp16")
    with pytest.warns(UserWarning, match=r"the sensor lies at x 0.0, y 0.0, z 2000.0 m, the world at x 10.0, y -5.0 to "
                                         r"5.0, z 0.0 to 9.0 m; it is 1.991 km above and 10 m beside the world, beyond"):
        log = underbrush.simulate(path, sensor=sensor, trajectory=far)
    assert not np.isfinite(log.range_m).any()


def test_what_is_wrong_is_a_format_error(tmp_path: pathlib.Path) -> None:
    path = tmp_path / "bad.stl"
    path.write_bytes(b"solid")
    with pytest.raises(underbrush.FormatError):
        underbrush.read_scene(path)
