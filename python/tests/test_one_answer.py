"""Python gives the bits of the program on a log that has every feature at once (tests/pipeline/every_feature.py)."""
from __future__ import annotations

import importlib.util
import json
import pathlib
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from test_same_bits import same_models

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


def without_times(report: dict[str, Any]) -> dict[str, Any]:
    """A report of a fit without what differs from run to run and what the program adds."""
    return {k: v for k, v in report.items() if k not in ("seconds", "beams_per_s", "program")}


@pytest.mark.parametrize("log, words, options", [
    ("train.ply", [], {}),
    ("train.ply", ["--sensor", "velodyne-vlp16", "--fitter", "hierarchical", "--seed", "2"],
     {"sensor": "velodyne-vlp16", "fitter": "hierarchical", "seed": 2}),
    ("echoes.ply", ["--echoes", "all"], {"echoes": "all"}),
    ("echoes.ply", ["--fitter", "surface", "--surface-carve"], {"fitter": "surface", "surface_carve": True}),
])
def test_fit(run: Callable[..., str], folder: pathlib.Path, tmp_path: pathlib.Path, log: str, words: list[str],
             options: dict[str, object]) -> None:
    if log == "echoes.ply" and not (folder / log).exists():
        run("simulate", folder / "model", "--like", folder / "test.ply", "--super-sample", "7", "--returns", "3", "-o",
            folder / log)
    run("fit", folder / log, "-o", tmp_path / "program", "--json", tmp_path / "program.json", *words)
    model = underbrush.fit(folder / log, tmp_path / "python", **options)
    same_models(tmp_path / "program", tmp_path / "python")
    printed = json.loads((tmp_path / "program.json").read_text())
    assert without_times(underbrush.report_of(model)) == without_times(printed)
    inputs = json.loads((tmp_path / "program" / "model.json").read_text())["provenance"]["inputs"]
    assert json.loads(model.provenance)["inputs"] == inputs


def test_fit_update(run: Callable[..., str], folder: pathlib.Path, tmp_path: pathlib.Path) -> None:
    run("fit", folder / "train.ply", "-o", tmp_path / "model")
    for growth in (0.25, 0.0):
        run("fit", folder / "test.ply", "--update", tmp_path / "model", "--growth", growth, "-o",
            tmp_path / f"program{growth}", "--json", tmp_path / "program.json")
        grown = underbrush.fit(folder / "test.ply", tmp_path / f"python{growth}", update=tmp_path / "model", growth=growth)
        same_models(tmp_path / f"program{growth}", tmp_path / f"python{growth}")
        printed = json.loads((tmp_path / "program.json").read_text())
        assert without_times(underbrush.report_of(grown)) == without_times(printed)
    # A model in memory, of this process or read from its folder, is as good as its folder.
    for k, model in enumerate((underbrush.fit(folder / "train.ply"), underbrush.read_model(tmp_path / "model"))):
        underbrush.fit(folder / "test.ply", tmp_path / f"memory{k}", update=model)
        same_models(tmp_path / "program0.25", tmp_path / f"memory{k}")


def test_fit_update_refuses(folder: pathlib.Path, tmp_path: pathlib.Path) -> None:
    model = underbrush.fit(folder / "train.ply", fitter="hierarchical")
    with pytest.raises(underbrush.FormatError, match="fitted to this log already"):
        underbrush.fit(folder / "train.ply", update=model)
    with pytest.raises(underbrush.FormatError, match="train.ply.*which is not there"):
        underbrush.fit(folder / "test.ply", update=model, logs=tmp_path)
    in_memory = underbrush.fit(underbrush.read_log(folder / "train.ply"), fitter="ground_mesh")
    with pytest.raises(underbrush.FormatError, match="is in no file"):
        underbrush.fit(folder / "test.ply", update=in_memory)
    with pytest.raises(ValueError, match="growth and logs require update"):
        underbrush.fit(folder / "test.ply", growth=0)
    for options in ({"tau": 2.0}, {"seed": 2}, {"echoes": "all"}, {"sensor": "velodyne-vlp16"}):
        with pytest.raises(ValueError, match="update excludes"):
            underbrush.fit(folder / "test.ply", update=model, **options)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="keyframes hold beams"):
        underbrush.fit(folder / "test.ply", echoes="all", keyframes=2.0)
    with pytest.raises(ValueError, match="echoes is first or all"):
        underbrush.fit(folder / "test.ply", echoes="some")  # type: ignore[arg-type]


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


@pytest.mark.parametrize("words, train", [([], None), (["--train", "train.ply"], "train.ply")])
def test_score(run: Callable[..., str], folder: pathlib.Path, words: list[str], train: str | None) -> None:
    run("simulate", folder / "model", "--like", folder / "test.ply", "-o", folder / "sim.ply", "--force")
    printed = json.loads(run("score", folder / "test.ply", folder / "sim.ply", "--model", folder / "model", "--json",
                             "-", *(folder / word if word.endswith(".ply") else word for word in words)))
    score = underbrush.score(folder / "test.ply", folder / "sim.ply", model=underbrush.read_model(folder / "model"),
                             train=folder / train if train else None)
    ours = json.loads(underbrush._core.scores_json(["sim"], [score], "{}"))
    of_program = {"provenance", "program"}
    assert {k: v for k, v in ours.items() if k not in of_program} == {
        k: v for k, v in printed.items() if k not in of_program}
    assert list(score.baselines) == ["always hit"] + ["look-up"] * bool(train)
    assert score.baselines["always hit"].all.f1 == printed["baselines"]["always hit"]["f1"]
