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
    ("echoes.ply", ["--fitter", "surface", "--surface-cell", "0.5", "--surface-carve"],
     {"fitter": "surface", "surface_cell": 0.5, "surface_carve": True}),
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
    with pytest.raises(ValueError, match="require --update"):
        underbrush.fit(folder / "test.ply", growth=0)
    for options in ({"tau": 2.0}, {"seed": 2}, {"echoes": "all"}, {"sensor": "velodyne-vlp16"}):
        with pytest.raises(ValueError, match="update excludes"):
            underbrush.fit(folder / "test.ply", update=model, **options)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="keyframes hold beams"):
        underbrush.fit(folder / "test.ply", echoes="all", keyframes=2.0)
    with pytest.raises(ValueError, match="echoes is one of first, all"):
        underbrush.fit(folder / "test.ply", echoes="some")  # type: ignore[arg-type]


@pytest.mark.parametrize("words, options", [
    ([], {}),
    (["--draw", "median"], {"draw": "median"}),
    (["--element-ids", "--intensity", "drawn", "--seed", "4"], {"element_ids": True, "intensity": "drawn", "seed": 4}),
    (["--super-sample", "sensor"], {"super_sample": "sensor"}),
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


def test_compare_clouds(run: Callable[..., str], folder: pathlib.Path) -> None:
    printed = json.loads(run("score", folder / "train.ply", folder / "test.ply", "--protocol", "clouds", "--json", "-"))
    stages: list[tuple[str, bool]] = []
    found = underbrush.compare_clouds(folder / "train.ply", underbrush.read_log(folder / "test.ply"),
                                      progress=lambda stage, done, total: stages.append((stage, done <= total)))
    assert found == printed["models"]["test"]
    assert found["points"] > 0 and all(fits for _, fits in stages)
    empty = underbrush.read_log(folder / "test.ply")
    empty.range_m[:] = np.inf
    with pytest.raises(ValueError, match="the simulated log has no return"):
        underbrush.compare_clouds(folder / "train.ply", empty)


@pytest.mark.parametrize("protocol, words, options", [("kitti360", ["--protocol", "kitti360"], {"protocol": "kitti360"}),
                                                      ("repeats", ["--repeats"], {"repeats": True})])
def test_protocols_of_score(run: Callable[..., str], folder: pathlib.Path, protocol: str, words: list[str],
                            options: dict[str, Any]) -> None:
    run("simulate", folder / "model", "--like", folder / "test.ply", "-o", folder / "sim.ply", "--force")
    printed = json.loads(run("score", folder / "test.ply", folder / "sim.ply", "--train", folder / "train.ply", *words,
                             "--json", "-"))
    score = underbrush.score(folder / "test.ply", underbrush.read_log(folder / "sim.ply"), train=folder / "train.ply",
                             **options)
    assert getattr(score, protocol) == printed["models"]["sim"][protocol] and getattr(score, protocol)["scans"] > 0
    for name, baseline in score.baselines.items():
        assert getattr(baseline, protocol) == printed["baselines"][name][protocol]
    assert underbrush.score(folder / "test.ply", folder / "sim.ply").kitti360 is None


def test_score_refuses_the_protocol_of_other_beams(folder: pathlib.Path) -> None:
    with pytest.raises(ValueError, match="compare_clouds"):
        underbrush.score(folder / "test.ply", folder / "sim.ply", protocol="clouds")
    with pytest.raises(ValueError, match="protocol is one of kitti360, clouds, not other"):
        underbrush.score(folder / "test.ply", folder / "sim.ply", protocol="other")


def without_origin(value: object) -> object:
    """JSON without what says what wrote it and when."""
    if isinstance(value, dict):
        return {k: without_origin(v) for k, v in value.items() if k not in ("provenance", "program", "seconds")}
    return value


def same(ours: pathlib.Path, theirs: pathlib.Path) -> None:
    """Holds a file or folder of Python's against that of the program."""
    if theirs.is_dir():
        names = sorted(p.relative_to(theirs) for p in theirs.rglob("*") if p.is_file())
        assert names and names == sorted(p.relative_to(ours) for p in ours.rglob("*") if p.is_file())
        for name in names:
            same(ours / name, theirs / name)
    elif theirs.suffix == ".json":
        assert without_origin(json.loads(ours.read_text())) == without_origin(json.loads(theirs.read_text())), theirs
    elif theirs.suffix == ".ply" and b"comment underbrush" in theirs.read_bytes()[:4096]:
        assert body(ours) == body(theirs), theirs
    else:
        assert ours.read_bytes() == theirs.read_bytes(), theirs


def printed(run: Callable[..., str], *words: object) -> object:
    """The results of a verb of the program."""
    return without_origin(json.loads(run(*words, "--json", "-")))


@pytest.mark.parametrize("words, options", [
    ([], {}),
    (["--unknown-below-deg", "-13", "--max-range", "60", "--float"],
     {"unknown_below_deg": -13.0, "max_range": 60.0, "float_coordinates": True}),
])
def test_import(run: Callable[..., str], tmp_path: pathlib.Path, words: list[str], options: dict[str, Any]) -> None:
    scan = TESTS.parent / "share" / "examples" / "marv_forest.pcd"
    report = printed(run, "import", scan, "-o", tmp_path / "program.ply", *words)
    ours = underbrush.import_log(scan, tmp_path / "python.ply", **options)
    same(tmp_path / "python.ply", tmp_path / "program.ply")
    assert ours.report == report and ours.report["misses"] > 1000
    assert len(ours.log) == ours.report["beams"] and ours.log.info.has_misses


@pytest.mark.parametrize("words, options", [
    (["--columns", "3", "--offset", "2"], {"columns": 3, "offset": 2}),
    (["--time", "0", "4"], {"time": (0.0, 4.0)}),
])
def test_split(run: Callable[..., str], folder: pathlib.Path, tmp_path: pathlib.Path, words: list[str],
               options: dict[str, Any]) -> None:
    run("split", folder / "test.ply", "--train", tmp_path / "a.ply", "--test", tmp_path / "b.ply", *words)
    parts = underbrush.split(folder / "test.ply", tmp_path / "train.ply", tmp_path / "test.ply", **options)
    same(tmp_path / "train.ply", tmp_path / "a.ply")
    same(tmp_path / "test.ply", tmp_path / "b.ply")
    assert min(len(parts.train), len(parts.test)) > 0
    with pytest.raises(ValueError, match="one of --every, --columns, --time and --region"):
        underbrush.split(folder / "test.ply", every=2, columns=2)
    with pytest.raises(underbrush.FormatError, match="test.ply: one part would be empty"):
        underbrush.split(folder / "test.ply", time=(0.0, 1e9))


def test_segment_extract_compose(run: Callable[..., str], folder: pathlib.Path, tmp_path: pathlib.Path) -> None:
    report = printed(run, "segment", folder / "train.ply", "-o", tmp_path / "program.ply", "--min-points", "5", "--cell",
                     "0.5")
    ours = underbrush.segment(folder / "train.ply", tmp_path / "python.ply", min_points=5, cell=0.5)
    same(tmp_path / "python.ply", tmp_path / "program.ply")
    assert ours.report == report and ours.report["objects"] > 5
    given = printed(run, "segment", folder / "train.ply", "--labels", tmp_path / "program.ply", "-o", tmp_path / "c.ply")
    again = underbrush.segment(folder / "train.ply", tmp_path / "d.ply", labels=tmp_path / "program.ply")
    same(tmp_path / "d.ply", tmp_path / "c.ply")
    assert again.report == given

    report = printed(run, "extract", folder / "model", tmp_path / "program.ply", "-o", tmp_path / "program", "--elements",
                     "box", "--min-elements", "2")
    primitives = underbrush.extract(folder / "model", tmp_path / "program.ply", tmp_path / "python", elements="box",
                                    min_elements=2)
    same(tmp_path / "python", tmp_path / "program")
    assert underbrush.report_of(primitives) == report and len(primitives) > 5

    site = tmp_path / "site.json"
    run("annotate", tmp_path / "program.ply", "--ground", folder / "model", "-o", site)
    tree = next(name for name in primitives.labels if name.endswith("tree"))
    report = printed(run, "compose", site, tmp_path / "program", "-o", tmp_path / "scene", "--nearest", "3", "--scale",
                     "--class-density", f"{tree}=1.5", "--seed", "4", "--allow-outside")
    scene = underbrush.compose(site, tmp_path / "program", tmp_path / "ours", nearest=3, scale=True,
                               class_density={tree: 1.5}, seed=4, allow_outside=True)
    same(tmp_path / "ours", tmp_path / "scene")
    assert isinstance(report, dict)
    assert without_times(underbrush.report_of(scene)) == without_times(report)
    with pytest.raises(underbrush.FormatError, match="no primitives of the class"):
        underbrush.compose(site, tmp_path / "program", leave_out=[str(site)], strict=True, ground=folder / "model",
                           allow_outside=True)


def test_perceive(run: Callable[..., str], folder: pathlib.Path, tmp_path: pathlib.Path) -> None:
    log = folder / "test.ply"
    report = printed(run, "perceive", log, "--pipeline", "real", "--needed", "2", "--existence", "in-a-row", "--grid",
                     tmp_path / "program.png", "--sensor-height", "1.8", "-o", tmp_path / "program.csv")
    ours = underbrush.perceive(log, tmp_path / "python.csv", pipeline="real", needed=2, existence="in-a-row",
                               grid=tmp_path / "python.png", sensor_height=1.8)
    same(tmp_path / "python.csv", tmp_path / "program.csv")
    same(tmp_path / "python.png", tmp_path / "program.png")
    assert isinstance(report, dict)
    report["grid"].pop("seconds", None)
    assert without_origin(underbrush.report_of(ours)) == report and report["objects"] > 0
    assert sum(len(ours.objects(k)) for k in range(len(ours))) == report["objects"]

    words = ["--truth", tmp_path / "program.csv", "--ghosts-per-s", "2", "--seed", "3"]
    report = printed(run, "perceive", log, *words, "-o", tmp_path / "program.json", "--write-truth",
                     tmp_path / "program_truth.csv")
    ours = underbrush.perceive(log, tmp_path / "python.json", truth=tmp_path / "program.csv", ghosts_per_s=2.0, seed=3,
                               write_truth=tmp_path / "python_truth.csv")
    same(tmp_path / "python.json", tmp_path / "program.json")
    same(tmp_path / "python_truth.csv", tmp_path / "program_truth.csv")
    assert without_origin(underbrush.report_of(ours)) == report
    with pytest.raises(ValueError, match="the tracking model needs the truth"):
        underbrush.perceive(log)
