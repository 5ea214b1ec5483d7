"""The functions give the same bits as the program."""
from __future__ import annotations

import json
import pathlib
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import underbrush


def without_provenance(path: pathlib.Path) -> bytes:
    """A file without the lines that say which command wrote it."""
    return b"\n".join(line for line in path.read_bytes().split(b"\n") if b"rovenance" not in line[:40])


def same_models(a: pathlib.Path, b: pathlib.Path) -> None:
    names = {p.relative_to(a) for p in a.rglob("*")}
    assert names == {p.relative_to(b) for p in b.rglob("*")}
    for name in names - {pathlib.Path("model.json"), pathlib.Path("training")}:
        assert (a / name).read_bytes() == (b / name).read_bytes(), name
    one, other = (json.loads((folder / "model.json").read_text()) for folder in (a, b))
    one.pop("provenance"), other.pop("provenance")
    assert one == other


@pytest.mark.parametrize("words, parameters", [
    ([], {}),
    (["--fitter", "voxel", "--voxel-side", "0.5"], {"fitter": "voxel", "voxel_side": 0.5}),
    (["--fitter", "ground_mesh", "--seed", "3"], {"fitter": "ground_mesh", "seed": 3}),
    (["--fitter", "likelihood", "--rounds", "1"], {"fitter": "likelihood", "rounds": 1}),
])
def test_fit(run: Callable[..., str], log_file: pathlib.Path, tmp_path: pathlib.Path, words: list[str],
             parameters: dict[str, object]) -> None:
    run("fit", log_file, "-o", tmp_path / "program", *words)
    underbrush.fit(log_file, tmp_path / "python", **parameters)  # type: ignore[arg-type]
    same_models(tmp_path / "program", tmp_path / "python")


def test_fit_of_several_logs(run: Callable[..., str], log_file: pathlib.Path, tmp_path: pathlib.Path) -> None:
    other = tmp_path / "other.ublog"
    log = underbrush.read_log(log_file)
    log.origin[:, 0] += 1
    underbrush.write_log(other, log)
    run("fit", log_file, other, "-o", tmp_path / "program")
    model = underbrush.fit([log_file, other], tmp_path / "python")
    same_models(tmp_path / "program", tmp_path / "python")
    assert underbrush.report_of(model)["beams"] == 2 * len(log)
    for logs in ([log_file, log], [log, log]):
        with pytest.raises(TypeError):
            underbrush.fit(logs)  # type: ignore[list-item]
    with pytest.raises(ValueError, match="adds one log"):
        underbrush.fit([log_file, other], update=model)
    with pytest.raises(underbrush.FormatError, match="twice"):
        underbrush.fit([log_file, log_file])


def test_fit_in_memory(log_file: pathlib.Path, model: underbrush.Model) -> None:
    again = underbrush.fit(underbrush.read_log(log_file))
    for name in ("mean", "covariance", "hit_probability", "hits", "misses", "label"):
        assert np.array_equal(getattr(again.ellipsoids, name), getattr(model.ellipsoids, name)), name
    assert np.array_equal(again.ground.vertices, model.ground.vertices)


@pytest.mark.parametrize("words, options", [
    ([], {}),
    (["--matter", "anew", "--seed", "9"], {"matter": "anew", "seed": 9}),
    (["--element-ids", "--max-range", "30"], {"element_ids": True, "max_range": 30}),
    (["--draw", "volumetric", "--range-noise", "0.1"], {"draw": "volumetric", "range_noise": 0.1}),
    (["--draw", "median"], {"draw": "median"}),
    (["--super-sample", "7", "--returns", "2", "--rain", "5"], {"super_sample": "7", "returns": "2", "rain": 5}),
])
def test_simulate(run: Callable[..., str], log_file: pathlib.Path, model: underbrush.Model, tmp_path: pathlib.Path,
                  words: list[str], options: dict[str, object]) -> None:
    underbrush.write_model(tmp_path / "model", model)
    run("simulate", tmp_path / "model", "--like", log_file, "-o", tmp_path / "a.ply", *words)
    counts = underbrush.simulate(model, like=log_file, output=tmp_path / "b.ply",
                                 **options)  # type: ignore[call-overload]
    assert without_provenance(tmp_path / "a.ply") == without_provenance(tmp_path / "b.ply")
    memory = underbrush.simulate(model, like=log_file, **options)  # type: ignore[call-overload]
    assert counts["rows"] == len(memory)
    underbrush.write_log(tmp_path / "c.ply", memory)
    assert without_provenance(tmp_path / "c.ply") == without_provenance(tmp_path / "a.ply")


def test_live_sensor_is_simulate(run: Callable[..., str], model: underbrush.Model, tmp_path: pathlib.Path) -> None:
    """The first revolution of a live sensor is that of the program, to the bit."""
    underbrush.write_model(tmp_path / "model", model)
    (tmp_path / "poses.txt").write_text("0 0 0 1.8 0 0 0 1\n0.1 0.6 0 1.8 0 0 0 1\n")
    run("simulate", tmp_path / "model", "--sensor", "velodyne-vlp16", "--trajectory", tmp_path / "poses.txt", "-o",
        tmp_path / "a.ply")
    lidar = underbrush.Lidar(model, "velodyne-vlp16")
    scan = lidar.scan(underbrush.Pose([0, 0, 1.8]), underbrush.Pose([0.6, 0, 1.8]), 0)
    underbrush.write_log(tmp_path / "b.ply", scan)
    assert without_provenance(tmp_path / "a.ply") == without_provenance(tmp_path / "b.ply")
    assert np.isfinite(scan.range_m).mean() > 0.3


def test_parts_of_revolutions_are_simulate(model: underbrush.Model) -> None:
    """Parts that follow each other have the bits of one simulation along their poses; a gap begins a new scan."""
    times = [0.0, 0.01, 0.0233, 0.05, 0.1, 0.17, 0.2]
    places = np.array([[3 * t, 4 * t * t, 1.8] for t in times])
    turns = np.array([[0, 0, np.sin(t), np.cos(t)] for t in times])
    whole = underbrush.simulate(model, sensor="velodyne-vlp16",
                                trajectory=underbrush.Trajectory(np.array(times), places, turns))
    at = [underbrush.Pose(p, q) for p, q in zip(places, turns, strict=True)]
    lidar = underbrush.Lidar(model, "velodyne-vlp16")
    parts = [lidar.fire(at[k - 1], at[k], times[k - 1], times[k]) for k in range(1, len(times))]
    for name in ("range_m", "intensity", "time_s", "ring", "scan", "packet", "origin", "direction"):
        together = np.concatenate([getattr(part, name) for part in parts])
        assert together.tobytes() == getattr(whole, name).tobytes(), name
    assert lidar.scans == 2
    assert set(lidar.fire(at[0], at[1], 5.0, 5.01).scan) == {2}
    with pytest.raises(ValueError, match="order"):
        lidar.fire(at[0], at[1], 5.01, 5.0)
    lidar.reset()
    again = lidar.fire(at[0], at[1], times[0], times[1])
    assert again.range_m.tobytes() == parts[0].range_m.tobytes()


def test_score(run: Callable[..., str], log_file: pathlib.Path, model: underbrush.Model,
               tmp_path: pathlib.Path) -> None:
    underbrush.write_model(tmp_path / "model", model)
    simulated = underbrush.simulate(model, like=log_file)
    underbrush.write_log(tmp_path / "sim.ply", simulated)
    printed = json.loads(run("score", log_file, tmp_path / "sim.ply", "--model", tmp_path / "model", "--json", "-"))
    score = underbrush.score(log_file, tmp_path / "sim.ply", model=model)
    for name in ("beams", "true_hits", "packet_error_m", "f1", "cloud_error_m", "nll_per_beam", "crps_m"):
        assert getattr(score.all, name) == printed[name], name
    assert score.per_range["10-20"].f1 == printed["per_range"]["10-20"]["f1"]
    assert score.all.f1 > 0.7


def test_segment_extract(run: Callable[..., str], log_file: pathlib.Path, model: underbrush.Model,
                         tmp_path: pathlib.Path) -> None:
    underbrush.write_model(tmp_path / "model", model)
    run("segment", log_file, "-o", tmp_path / "a.ply", "--min-points", "5")
    labelled = underbrush.segment(log_file, tmp_path / "b.ply", min_points=5)
    assert without_provenance(tmp_path / "a.ply") == without_provenance(tmp_path / "b.ply")
    assert labelled.report["objects"] >= 1
    run("extract", tmp_path / "model", tmp_path / "a.ply", "-o", tmp_path / "set")
    primitives = underbrush.extract(model, tmp_path / "a.ply", tmp_path / "other")
    for file in (tmp_path / "set").rglob("ellipsoids.ply"):
        assert file.read_bytes() == (tmp_path / "other" / file.relative_to(tmp_path / "set")).read_bytes()
    # The log in memory has the ranges of before the file: the same objects.
    assert len(underbrush.extract(model, labelled.log)) == len(primitives)


def test_compose(run: Callable[..., str], log_file: pathlib.Path, model: underbrush.Model,
                 tmp_path: pathlib.Path) -> None:
    underbrush.write_model(tmp_path / "model", model)
    run("segment", log_file, "-o", tmp_path / "labelled.ply", "--min-points", "5")
    run("annotate", tmp_path / "labelled.ply", "--ground", tmp_path / "model", "-o", tmp_path / "site.json")
    run("compose", tmp_path / "site.json", "mesh_primitives", "-o", tmp_path / "a")
    scene = underbrush.compose(tmp_path / "site.json", "mesh_primitives", tmp_path / "b")
    assert (tmp_path / "a" / "instances.ply").read_bytes() == (tmp_path / "b" / "instances.ply").read_bytes()
    assert len(scene) >= 2 and scene.position.shape == (len(scene), 3) and scene.label[0] == 1
    assert underbrush.report_of(scene)["objects"] >= 1
    run("simulate", tmp_path / "a", "--like", log_file, "-o", tmp_path / "a.ply")
    underbrush.simulate(scene, like=log_file, output=tmp_path / "b.ply")
    assert without_provenance(tmp_path / "a.ply") == without_provenance(tmp_path / "b.ply")


def test_marked_movers(run: Callable[..., str], log_file: pathlib.Path, model: underbrush.Model,
                       box_mesh: pathlib.Path, tmp_path: pathlib.Path) -> None:
    """A box that comes by is marked, as by the program, and the trees are not."""
    poses = tmp_path / "poses.txt"
    poses.write_text("0 -12 8 1.2 0 0 0 1\n4 12 8 1.2 0 0 0 1\n")
    still = underbrush.Trajectory(np.array([0.0, 4.0]), np.array([[0, 0, 1.8], [0, 0, 1.8]]),
                                  np.tile([0.0, 0, 0, 1], (2, 1)))
    log = underbrush.simulate(model, sensor="velodyne-vlp16", trajectory=still, movers=[(box_mesh, poses, "")],
                              element_ids=True)
    underbrush.write_log(tmp_path / "log.ply", log)
    printed = json.loads(run("movers", tmp_path / "log.ply", "-o", tmp_path / "a.ply", "--json", "-"))
    marked = underbrush.movers(tmp_path / "log.ply", tmp_path / "b.ply")
    assert without_provenance(tmp_path / "a.ply") == without_provenance(tmp_path / "b.ply")
    assert marked.report == {name: printed[name] for name in ("rows", "returns", "marked", "skipped")}
    is_box, is_marked = log.extra["instance"] == 1, marked.log.flags & underbrush.MOVER != 0
    assert is_marked.sum() == printed["marked"]
    assert is_marked[is_box].mean() > 0.5 and is_marked[~is_box].mean() < 0.001
    boxes = tmp_path / "boxes.csv"
    boxes.write_text("time,id,class,x,y,z,yaw,length,width,height\n" +
                     "".join(f"{0.1 * k:.1f},1,car,{0.6 * k - 12:.1f},8,1.2,0,4,2,2\n" for k in range(41)))
    printed = json.loads(run("actors", tmp_path / "log.ply", "--boxes", boxes, "-o", tmp_path / "program", "--marked",
                             tmp_path / "c.ply", "--json", "-"))
    learnt = underbrush.actors(tmp_path / "log.ply", tmp_path / "python", boxes=boxes)
    assert learnt.report["actors"] == printed["actors"]
    assert [(a["name"], a["models"]) for a in learnt.report["actors"]] == [("car-1", 1)]
    assert (learnt.marked.flags == underbrush.read_log(tmp_path / "c.ply").flags).all()
    same_models(tmp_path / "program/models/0000", tmp_path / "python/models/0000")
    replayed = underbrush.simulate(model, like=log, actors=tmp_path / "python")
    near = np.isclose(replayed.range_m, log.range_m, atol=0.3)
    assert near[is_box].mean() > 0.8 and near[~is_box & np.isfinite(log.range_m)].mean() > 0.5
    again = underbrush.movers(marked.log, look_s=[1e-9], least_empty=2)
    assert not (again.log.flags & underbrush.MOVER).any()
    with pytest.raises(underbrush.FormatError, match="fewer than two scans"):
        underbrush.movers(underbrush.BeamLog(10))
    with pytest.raises(TypeError, match="no option 'looks'"):
        underbrush.movers(log_file, looks=1.0)


def test_movers(run: Callable[..., str], log_file: pathlib.Path, model: underbrush.Model,
                tmp_path: pathlib.Path) -> None:
    underbrush.write_model(tmp_path / "model", model)
    mesh, poses = tmp_path / "box.obj", tmp_path / "poses.txt"
    mesh.write_text("v 0 -2 -2\nv 0 2 -2\nv 0 2 2\nv 0 -2 2\nf 1 2 3\nf 1 3 4\n")
    poses.write_text("0 6 0 1.8 0 0 0 1\n1 9 3 1.8 0 0 0 1\n")
    run("simulate", tmp_path / "model", "--like", log_file, "-o", tmp_path / "a.ply", "--mover", f"{mesh}:{poses}")
    underbrush.simulate(model, like=log_file, output=tmp_path / "b.ply", movers=[(mesh, poses, "")])
    assert without_provenance(tmp_path / "a.ply") == without_provenance(tmp_path / "b.ply")
    lidar = underbrush.Lidar(model, "velodyne-vlp16", movers=[(mesh, poses, "")], element_ids=True)
    scan = lidar.scan(np.eye(4) + 1.8 * np.eye(4, k=1)[:, ::1] * np.array([[0], [0], [1], [0]]), time=0.0)
    assert (scan.extra["instance"] == 1).any()


def test_optimize(run: Callable[..., str], log_file: pathlib.Path, tmp_path: pathlib.Path) -> None:
    printed = json.loads(run("optimize", log_file, "-o", tmp_path / "p.yaml", "--tune", "tau", "--budget", "3",
                             "--slice", "0", "0.2", "--validate", "2", "--json", "-"))
    tuning = underbrush.optimize(log_file, tune=["tau"], budget=3, slice=(0, 0.2), validate=2)
    assert tuning.objective == min(e["objective"] for e in printed["evaluations"])
    assert [v["tau"] for v, _ in tuning.history] == [e["value"][0] for e in printed["evaluations"]]


def test_optimize_goes_on(run: Callable[..., str], log_file: pathlib.Path, tmp_path: pathlib.Path) -> None:
    """A search that was interrupted has the result of one that was not, whichever face goes on with it."""
    options: dict[str, Any] = {"tune": ["tau"], "budget": 4, "slice": (0, 0.2), "validate": 2}
    whole = underbrush.optimize(log_file, checkpoint=tmp_path / "whole", **options)

    def interrupt(stage: str, done: int, most: int) -> None:
        if done >= 2:
            raise KeyboardInterrupt

    file = tmp_path / "search"
    with pytest.raises(KeyboardInterrupt):
        underbrush.optimize(log_file, checkpoint=file, progress=interrupt, **options)
    kept = file.read_bytes()
    with pytest.raises(ValueError, match="holds [23] evaluations of a search that did not end"):
        underbrush.optimize(log_file, checkpoint=file, **options)
    with pytest.raises(underbrush.FormatError, match="of another search"):
        underbrush.optimize(log_file, checkpoint=file, resume=True, seed=2, **options)
    assert file.read_bytes() == kept
    again = underbrush.optimize(log_file, checkpoint=file, resume=True, **options)
    assert again.history == whole.history
    assert file.read_bytes() == (tmp_path / "whole").read_bytes()
    file.write_bytes(kept)
    printed = json.loads(run("optimize", log_file, "-o", tmp_path / "p.yaml", "--tune", "tau", "--budget", 4, "--slice",
                             0, 0.2, "--validate", 2, "--checkpoint", file, "--resume", "--json", "-"))
    assert printed["resumed_from"] in (2, 3)
    assert [v["tau"] for v, _ in whole.history] == [e["value"][0] for e in printed["evaluations"]]
    with pytest.raises(ValueError, match="a log that is in a file"):
        underbrush.optimize(underbrush.read_log(log_file), checkpoint=tmp_path / "new", **options)
    with pytest.raises(ValueError, match="needs a checkpoint"):
        underbrush.optimize(log_file, resume=True, **options)
