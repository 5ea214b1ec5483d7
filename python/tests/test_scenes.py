"""Scenes from models and arrays, and the pages of `score` and `optimize`."""
from __future__ import annotations

import pathlib

import numpy as np
import pytest

import underbrush


def half_turn() -> list[float]:
    return [0.0, 0.0, 1.0, 0.0]  # about z


def test_one_model_at_its_place_is_the_model(log: underbrush.BeamLog) -> None:
    model = underbrush.fit(log, keyframes=0.0)  # a scene remembers nothing
    scene = underbrush.scene_from_models([model], model=[0], position=[model.origin])
    assert len(scene) == 1 and scene.models == 1 and scene.names == ["model0"]
    alone = underbrush.simulate(model, like=log, seed=3)
    placed = underbrush.simulate(scene, like=log, seed=3)
    np.testing.assert_array_equal(alone.range_m, placed.range_m)


def test_instances_stand_where_they_are_put(model: underbrush.Model, tmp_path: pathlib.Path) -> None:
    scene = underbrush.scene_from_models([model, model], model=[0, 1, 1], position=[[0, 0, 0], [100, 0, 0], [0, 50, 1]],
                                         rotation=[[0.0, 0.0, 0.0, 1.0], half_turn(), half_turn()], scale=[1, 2, 0.5],
                                         classes=["ground", "large_tree", "pole"], names=["site", "tree"],
                                         materials=["", "bark"])
    np.testing.assert_array_equal(scene.position, [[0, 0, 0], [100, 0, 0], [0, 50, 1]])
    np.testing.assert_array_equal(scene.rotation[1], half_turn())
    np.testing.assert_array_equal(scene.model, [0, 1, 1])
    assert scene.classes == ["pole"] and scene.label[2] == len(underbrush.class_names())
    assert underbrush.class_names()[scene.label[1]] == "large_tree"
    underbrush.write_scene(tmp_path / "scene", scene)
    back = underbrush.read_scene(tmp_path / "scene")
    np.testing.assert_array_equal(back.position, scene.position)
    assert back.materials == ["", "bark"] and back.names == ["site", "tree"]


@pytest.mark.parametrize(("given", "said"), [
    ({"model": [1]}, "model"),
    ({"position": [[0, 0, 0], [1, 1, 1]]}, "one length"),
    ({"rotation": [[0, 0, 0, 2]]}, "unit quaternion"),
    ({"scale": [-1]}, "scale"),
    ({"classes": ["ground", "ground"]}, "one length"),
    ({"names": ["a", "b"]}, "one name a model"),
    ({"model": []}, "no instances"),
])
def test_columns_that_do_not_fit(model: underbrush.Model, given: dict[str, object], said: str) -> None:
    columns: dict[str, object] = {"model": [0], "position": [[0, 0, 0]], **given}
    if given.get("model") == []:
        columns["position"] = np.zeros((0, 3))
    with pytest.raises(ValueError, match=said):
        underbrush.scene_from_models([model], **columns)  # type: ignore[arg-type]


def test_pages(log: underbrush.BeamLog, log_file: pathlib.Path, model: underbrush.Model, tmp_path: pathlib.Path) -> None:
    simulated = underbrush.simulate(model, like=log)
    scores = underbrush.score(log_file, simulated, report=tmp_path / "score")
    page = (tmp_path / "score" / "index.html").read_text()
    assert log_file.name in page and f"{scores.all.f1:.4f}" in page
    tuning = underbrush.optimize(log, budget=2, tune=["tau"], report=tmp_path / "tuning", ground_spacing=1.0)
    page = (tmp_path / "tuning" / "index.html").read_text()
    assert "judge." in page and len(tuning) == 2
    assert "ground-spacing" in page
    with pytest.raises(OSError):
        underbrush.score(log_file, simulated, report=log_file)
