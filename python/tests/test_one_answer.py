"""Python gives the bits of the program on a log that has every feature at once (tests/pipeline/every_feature.py)."""
from __future__ import annotations

import importlib.util
import json
import pathlib
from collections.abc import Callable

import numpy as np
import pytest

import underbrush

TESTS = pathlib.Path(__file__).resolve().parents[2] / "tests"


@pytest.fixture(scope="module")
def folder(run: Callable[..., str], tmp_path_factory: pytest.TempPathFactory) -> pathlib.Path:
    """train.ply, test.ply and model/, with every feature."""
    spec = importlib.util.spec_from_file_location("every_feature", TESTS / "pipeline" / "every_feature.py")
    assert spec and spec.loader
    every_feature = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(every_feature)
    path = tmp_path_factory.mktemp("every_feature")
    every_feature.make(run, path)
    return path


def body(path: pathlib.Path) -> bytes:
    """A log without the comments, of which one says what wrote it."""
    content = path.read_bytes()
    return content[content.index(b"element vertex"):]


@pytest.mark.parametrize("words, options", [
    ([], {}),
    (["--draw", "median"], {"draw": "median"}),
    (["--element-ids", "--intensity", "drawn", "--seed", "4"], {"element_ids": True, "intensity": "drawn", "seed": 4}),
    (["--super-sample", "sensor", "--footprint", "whole"], {"super_sample": "sensor", "footprint": "whole"}),
])
def test_simulate(run: Callable[..., str], folder: pathlib.Path, words: list[str], options: dict[str, object]) -> None:
    run("simulate", folder / "model", "--like", folder / "test.ply", "-o", folder / "program.ply", "--force", *words)
    model = underbrush.read_model(folder / "model")
    underbrush.simulate(model, like=folder / "test.ply", output=folder / "python.ply", **options)
    assert body(folder / "program.ply") == body(folder / "python.ply")


def test_a_rig_and_a_mesh(run: Callable[..., str], folder: pathlib.Path, tmp_path: pathlib.Path) -> None:
    (tmp_path / "box.obj").write_text("v -5 3 -1\nv 5 3 -1\nv 5 3 4\nv -5 3 4\nf 1 2 3 4\n")
    (tmp_path / "rig.yaml").write_text(
        "name: two\nsensors:\n"
        "  - {name: left, sensor: velodyne-vlp16, position_m: [0, 0.5, 1.5]}\n"
        "  - {name: right, sensor: velodyne-vlp16, position_m: [0, -0.5, 1.5]}\n")
    (tmp_path / "poses.txt").write_text("0 0 0 0 0 0 0 1\n0.1 0.5 0 0 0 0 0 1\n")
    run("simulate", tmp_path / "box.obj", "--up", "y", "--rig", tmp_path / "rig.yaml", "--trajectory",
        tmp_path / "poses.txt", "-o", tmp_path / "program.ply")
    log = underbrush.simulate(tmp_path / "box.obj", up="y", rig=tmp_path / "rig.yaml",
                              trajectory=tmp_path / "poses.txt")
    assert np.isfinite(log.range_m).any()
    underbrush.write_log(tmp_path / "python.ply", log)
    assert body(tmp_path / "program.ply") == body(tmp_path / "python.ply")


def test_score(run: Callable[..., str], folder: pathlib.Path) -> None:
    run("simulate", folder / "model", "--like", folder / "test.ply", "-o", folder / "sim.ply", "--force")
    printed = json.loads(run("score", folder / "test.ply", folder / "sim.ply", "--model", folder / "model", "--json",
                             "-"))
    score = underbrush.score(folder / "test.ply", folder / "sim.ply", model=underbrush.read_model(folder / "model"))
    ours = json.loads(underbrush._core.scores_json(["sim"], [score], "{}"))
    of_program = {"provenance", "program", "baselines"}  # `underbrush.score` has no baselines yet
    assert set(printed) - set(ours) == of_program - set(ours)
    assert {k: v for k, v in ours.items() if k not in of_program} == {
        k: v for k, v in printed.items() if k not in of_program}
