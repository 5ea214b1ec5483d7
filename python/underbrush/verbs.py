"""The verbs of the command line as functions."""
from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, TypeGuard, overload

from underbrush import _core
from underbrush._core import BeamLog, Model, ObjectLists, Primitives, Scene, Score, Sensor, Trajectory, Tuning
from underbrush.progress import Progress
from underbrush.progress import shown as _shown
from underbrush.recorded import given_log as _log
from underbrush.results import Imported, LearntActors, Marked, Segmentation, Split

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from underbrush._parameters import (ActorsParameters, ComposeParameters, ExtractParameters, FitParameters,
                                        ImportParameters, MoversParameters, OptimizeParameters, PerceiveParameters,
                                        ScoreParameters, SegmentParameters, SimulateParameters, SplitParameters)

Path = str | os.PathLike[str]
#: A log, or the path of one (.ply or .ublog, as `underbrush import` writes it) or of a recording (bag, LAS, pcap, E57).
Log = BeamLog | Path
World = Model | Scene | Path  #: A model or scene, or the path of its folder.
#: An object that moves: a model, or the path of a model's folder or a mesh (OBJ, PLY); its poses over time, world from
#: object; and a material, "" for that of its class.
Mover = tuple[Model | Path, Trajectory | Path, str]


def _provenance(verb: str, seed: int, **options: object) -> str:
    words = [f"{name}={value}" for name, value in options.items() if isinstance(value, (str, int, float))]
    return json.dumps({"program": f"underbrush {_core.version()}", "command": ["underbrush." + verb, *words],
                       "seed": seed, "inputs": {}})


def _set(core: Any, options: Mapping[str, Any]) -> Any:
    """Sets the options of a verb by name; paths become text."""
    for name, value in options.items():
        core.set(name, os.fspath(value) if isinstance(value, os.PathLike) else value)
    return core


def _divided(table: Sequence[tuple[str, ...]], options: Mapping[str, Any]) -> tuple[dict[str, Any], dict[str, Any]]:
    """Divides options into those of the table of a verb and all others."""
    names = {row[0].replace("-", "_") for row in table}
    return ({name: value for name, value in options.items() if name in names},
            {name: value for name, value in options.items() if name not in names})


def _are_several(log: Log | Sequence[Path]) -> TypeGuard[Sequence[Path]]:
    return isinstance(log, Sequence) and not isinstance(log, str)


def _sensor(sensor: Sensor | str | None) -> Sensor | None:
    return Sensor(sensor) if isinstance(sensor, str) else sensor


def report_of(value: Model | Scene | Primitives | ObjectLists) -> dict[str, Any]:
    """Returns counts, warnings and times of the `fit`, `compose`, `extract` or `perceive` that made the value.

    The keys are those of the command's `--json`. The dict is empty for a value that was read from a file.
    """
    report: dict[str, Any] = json.loads(value.report_json)
    return report


def fit(log: Log | Sequence[Path], output: Path | None = None, *, seed: int = 1, sensor: Sensor | str | None = None,
        update: Model | Path | None = None, progress: Progress | None = None,
        **options: Unpack[FitParameters]) -> Model:
    """Learns a model from a log: ground mesh, ellipsoids, hit probabilities.

    `options` are those of `underbrush fit` with `_` for `-`, such as `fitter`, `tau` and `clusters_per_point`.
    The footprint of the beam of `sensor` is removed from the ellipsoids. With `echoes` "all", each echo is treated as a
    beam, and hit probabilities are shares of the light. With `output`, the model's folder is written too. The log is
    read in chunks, so a path may be that of a log larger than memory. `report_of` has the counts. A sequence of paths
    is that of logs of one sensor in one world frame, which are read one after another.

    With `update`, the log is added to that model, with its parameters, and the grown model is returned. The model must
    have been fitted to the file of a log; `logs` is the folder that now holds its earlier logs, if they were moved. A
    tile is fitted anew when the number of its returns has grown by the share `growth` since its last fit.

    Raises `ValueError` for a parameter out of range or a log without returns, `TypeError` for an unknown parameter,
    `FormatError`, `OSError`.
    """
    of_log, given = _divided(_core.fit_log_options(), options)
    core = _set(_core.FitLogOptions(), of_log)
    if update is not None and (given or sensor is not None or "echoes" in of_log or seed != 1):
        raise ValueError("fit: the parameters of a model hold, so update excludes parameters, sensor, echoes and seed")
    with _shown(progress) as shown:
        if update is None:
            logs = [_log(path) for path in log] if _are_several(log) else _log(log)
            model = _core.fit(logs, given, seed, _sensor(sensor), core, _provenance("fit", seed, **given), shown)
        else:
            if _are_several(log):
                raise ValueError("fit: update adds one log")
            model = _core.update(_log(log), update, core, _provenance("fit", seed), shown)
    if output is not None:
        _core.write_model(output, model)
    return model


def _options(seed: int, movers: Sequence[Mover], keywords: Mapping[str, Any]) -> _core.SimulateOptions:
    options = _core.SimulateOptions()
    options.seed = seed
    options.movers = list(movers)
    _set(options, keywords)
    return options


@overload
def simulate(model: World, *, like: Log | None = ..., sensor: Sensor | str | None = ...,
             rig: Path | None = ..., trajectory: Trajectory | Path | None = ..., output: None = ..., seed: int = ...,
             movers: Sequence[Mover] = ..., progress: Progress | None = ...,
             **options: Unpack[SimulateParameters]) -> BeamLog: ...


@overload
def simulate(model: World, *, like: Log | None = ..., sensor: Sensor | str | None = ...,
             rig: Path | None = ..., trajectory: Trajectory | Path | None = ..., output: Path, seed: int = ...,
             movers: Sequence[Mover] = ..., progress: Progress | None = ...,
             **options: Unpack[SimulateParameters]) -> dict[str, int]: ...


def simulate(model: World, *, like: Log | None = None, sensor: Sensor | str | None = None,
             rig: Path | None = None, trajectory: Trajectory | Path | None = None, output: Path | None = None,
             seed: int = 1, movers: Sequence[Mover] = (), progress: Progress | None = None,
             **options: Unpack[SimulateParameters]) -> BeamLog | dict[str, int]:
    """Simulates the beams of a log (`like`), or of a sensor or a rig (YAML) on a trajectory, in a model or scene.

    The path of a mesh, of a scene of HELIOS++ or of voxels of AMAPVox is a world, too, and with one pose a sensor makes
    one turn or frame. Returns the simulated log. With `output` (.ply, .ublog, .pcd, .csv, a KITTI folder; with
    `profile` a folder of PCD files), it is written there in chunks instead, and the
    result has the numbers of beams, rows and hits. `movers` are objects that move. If `actors`, `tau`, `grain` or
    `movers` are given, the model or scene is copied.

    Raises `ValueError` for options out of range or without effect, `FormatError`, `OSError`.
    """
    if like is not None and trajectory is not None:
        raise ValueError("simulate: give like or trajectory, not both")
    if rig is not None and sensor is not None:
        raise ValueError("simulate: give sensor or rig, not both")
    path = trajectory if trajectory is None or isinstance(trajectory, Trajectory) else _core.read_trajectory(trajectory)
    given: dict[str, Any] = dict(options)
    like = None if like is None else _log(like)
    core = _options(seed, movers, given)
    with _shown(progress) as shown:
        if output is None:
            return _core.simulate(model, core, like, _sensor(sensor), rig, path, shown)
        beams, rows, hits = _core.simulate_to(output, _provenance("simulate", seed, **given), model, core,
                                              like, _sensor(sensor), rig, path, shown)
    return {"beams": beams, "rows": rows, "hits": hits}


def _file_of(log: Log, folder: str, name: str) -> Path:
    """Returns the log's own file, or one in the folder into which a log in memory is written."""
    if not isinstance(log, BeamLog):
        return log
    file = os.path.join(folder, name + ".ply")
    _core.write_log(file, log, "", "{}")
    return file


def score(real: Log, simulated: Log, *, model: World | None = None, train: Log | None = None, cloud: bool = True,
          report: Path | None = None, progress: Progress | None = None, **options: Unpack[ScoreParameters]) -> Score:
    """Compares a simulated log with the real log of the same beams, beam by beam.

    With `model`, likelihood and CRPS under the ray model are computed, for a world of regions within `memory`. Without
    `cloud`, cloud error and density-aware Chamfer distance are left out. `Score.baselines` has the scores that a
    simulator must beat: those of "always hit", in which each beam returns at the median range of its ring, and with
    `train`, the log that the model was fitted to, those of "look-up", which takes the return of the nearest training
    point for each beam. Of `options`, `protocol="kitti360"` fills `Score.kitti360`, and `repeats=True` fills
    `Score.repeats`, as dicts of what `--json` writes; `compare_clouds` stands for the protocol "clouds". With `report`,
    a page of tables, plots and pictures is written into that folder. Raises `ValueError` (`FormatError` for files) where
    the beams differ in number, scan, ring or origin, and `OSError`.
    """
    real, simulated, train = _log(real), _log(simulated), None if train is None else _log(train)
    with _shown(progress) as shown:
        scores = _core.score(real, simulated, model, train, cloud, _set(_core.ScoreOptions(), dict(options)), shown)
    if report is not None:
        with tempfile.TemporaryDirectory() as folder:
            files = _file_of(real, folder, "real"), _file_of(simulated, folder, "simulated")
            _core.write_score_report(report, *files, scores, _provenance("score", 1))
    return scores


def compare_clouds(real: Log, simulated: Log, *, progress: Progress | None = None) -> dict[str, Any]:
    """Compares two logs that share no beams as point clouds, without beams that met an object marked as moving.

    Both logs are in one frame, m. Returns the values that `underbrush score --protocol clouds --json` writes, such as
    `cloud_error_m`, `density_aware_chamfer` in [0, 1], `occupied` in [0, 1], the histograms `range` and `height` with
    their Wasserstein distances (m), and `regions`, a list of the squares of 20 m; a score without data is None. Raises
    `ValueError` (`FormatError` for files) where a log has no return, and `OSError`.
    """
    with _shown(progress) as shown:
        scores: dict[str, Any] = json.loads(_core.compare_clouds(_log(real), _log(simulated), shown))
    return scores


def import_log(source: Path, output: Path | None = None, *, float_coordinates: bool = False,
               progress: Progress | None = None, **options: Unpack[ImportParameters]) -> Imported:
    """Reads a log of any supported format as beams, with misses kept or inferred.

    `options` are those of `underbrush import` with `_` for `-`, such as `poses`, `deskew` and `infer_misses`. With
    `output`, the log is written too while it is read, its coordinates as float with `float_coordinates`. Recordings
    (bags, LAS, packets, E57) have readers in `underbrush.formats`. Raises `ValueError`, `TypeError`, `FormatError`,
    `OSError`.
    """
    given: dict[str, Any] = dict(options)
    with _shown(progress) as shown:
        core = _set(_core.ImportOptions(), {**given, "float": float_coordinates})
        log, report = _core.import_log(source, core, output, _provenance("import_log", 1, **given), shown)
    return Imported(log, json.loads(report))


def split(log: Log, train: Path | None = None, test: Path | None = None, *, progress: Progress | None = None,
          **options: Unpack[SplitParameters]) -> Split:
    """Splits a log into a part for training and one for tests, which never share a beam.

    `options` are those of `underbrush split`: one of `every`, `columns`, `time` and `region`, and `offset`. With
    `train` and `test`, the parts are written too. Raises `ValueError`, `TypeError`, `FormatError`, `OSError`.
    """
    given: dict[str, Any] = dict(options)
    with _shown(progress) as shown:
        parts = Split(*_core.split(_log(log), _set(_core.SplitOptions(), given), shown))
    for path, part in ((train, parts.train), (test, parts.test)):
        if path is not None:
            _core.write_log(path, part, "", _provenance("split", 1, **given))
    return parts


def segment(log: Log, output: Path | None = None, *, progress: Progress | None = None,
            **options: Unpack[SegmentParameters]) -> Segmentation:
    """Labels the hits of a log as ground, trees, shrubs and patches, or takes labels from a file.

    `options` are those of `underbrush segment` with `_` for `-`, such as `ground_method`, `min_range`, `min_points` and
    `labels`. With `output`, the log is written too. Raises `ValueError`, `TypeError`, `FormatError`, `OSError`.
    """
    given: dict[str, Any] = dict(options)
    with _shown(progress) as shown:
        labelled, report = _core.segment(_log(log), _set(_core.SegmentOptions(), given), shown)
    if output is not None:
        _core.write_log(output, labelled, "", _provenance("segment", 1, **given))
    return Segmentation(labelled, json.loads(report))


def movers(log: Log, output: Path | None = None, *, progress: Progress | None = None,
           **options: Unpack[MoversParameters]) -> Marked:
    """Marks the returns of objects that moved during a log; `fit` and `score` leave them out.

    `options` are those of `underbrush movers` with `_` for `-`, such as `look_s` and `least_points`. With `output`, the
    log is written too. Raises `ValueError` (`FormatError` for a log of one scan), `TypeError`, `OSError`.
    """
    given: dict[str, Any] = dict(options)
    with _shown(progress) as shown:
        marked, report = _core.movers(_log(log), _set(_core.MoverOptions(), given), shown)
    if output is not None:
        _core.write_log(output, marked, "", _provenance("movers", 1, **given))
    return Marked(marked, json.loads(report))


def actors(log: Log, output: Path, *, boxes: Path | None = None, seed: int = 1, progress: Progress | None = None,
           **options: Unpack[ActorsParameters]) -> LearntActors:
    """Learns the objects that moved during a log as models with trajectories, and writes the folder `output`.

    `boxes` is a file of labelled boxes or of lists of objects; without it, moving objects are found. `options` are
    those of `underbrush actors` with `_` for `-`, such as `margin` (m). Give `marked` to `fit`, and the folder to
    `simulate` as `actors`. Raises `ValueError`, `TypeError`, `FormatError` (also where nothing moved), `OSError`.
    """
    given: dict[str, Any] = dict(options)
    with _shown(progress) as shown:
        marked, report = _core.actors(_log(log), boxes, output, _set(_core.ActorOptions(), given),
                                      seed, _provenance("actors", seed, **given), shown)
    return LearntActors(marked, json.loads(report))


def extract(model: Model | Path, labelled: Log, output: Path | None = None, *, progress: Progress | None = None,
            **options: Unpack[ExtractParameters]) -> Primitives:
    """Cuts primitives out of a model along the labelled log that it was fitted to.

    `options` are those of `underbrush extract` with `_` for `-`, such as `box_quantile` and `elements` ("own" or
    "box"). With `output`, the set's folder is written too. Raises `ValueError`, `TypeError`, `FormatError`, `OSError`.
    """
    given: dict[str, Any] = dict(options)
    with _shown(progress) as shown:
        primitives = _core.extract(model, _log(labelled), _set(_core.ExtractOptions(), given), shown)
    if output is not None:
        _core.write_primitives(output, primitives, _provenance("extract", 1, **given))
    return primitives


def compose(annotation: Path, primitives: Primitives | Path, output: Path | None = None, *,
            ground: Model | Path | None = None, class_density: Mapping[str, float] | Sequence[str] = (), seed: int = 1,
            progress: Progress | None = None, **options: Unpack[ComposeParameters]) -> Scene:
    """Composes a scene from primitives along an annotation.

    `primitives` is a set, the path of one, or "mesh_primitives" for generated plants. `ground` replaces the
    annotation's ground model. `class_density` is the number of objects for each annotated object, by class. `options`
    are those of `underbrush compose` with `_` for `-`, such as `nearest`, `scale` and `strict`. With `output`, the
    scene's folder is written too. Raises `ValueError`, `TypeError`, `FormatError`, `OSError`.
    """
    given: dict[str, Any] = dict(options)
    words = class_density
    if isinstance(words, Mapping):
        words = [f"{name}={factor!r}" for name, factor in words.items()]
    core = _set(_core.ComposeOptions(), {**given, "class_density": list(words)})
    core.seed = seed
    source = primitives if isinstance(primitives, Primitives) else os.fspath(primitives)
    with _shown(progress) as shown:
        scene = _core.compose(os.fspath(annotation), source, ground, core, _provenance("compose", seed, **given), shown)
    if output is not None:
        _core.write_scene(output, scene)
    return scene


def perceive(log: Log, output: Path | None = None, *, write_truth: Path | None = None, grid: Path | None = None,
             seed: int = 1, progress: Progress | None = None, **options: Unpack[PerceiveParameters]) -> ObjectLists:
    """Turns a log into lists of tracked objects.

    `options` are those of `underbrush perceive` with `_` for `-`, such as `pipeline` ("model" or "real"), `truth` and
    `min_range`. With `output` and `write_truth`, the lists and those of the true objects are written too (.csv, .json,
    .osi), and with `grid` a map of free, permeable and solid cells (the last cycle as .png, or else all as JSON).
    `report_of` has the counts and the scores. Raises `ValueError`, `TypeError`, `FormatError`, `OSError`.
    """
    given: dict[str, Any] = dict(options)
    if write_truth is not None and "truth" not in given:
        raise ValueError("perceive: write_truth needs truth")
    core = _set(_core.PerceiveOptions(), given)
    core.seed = seed
    origin = _provenance("perceive", seed, **given)
    with _shown(progress) as shown:
        lists = _core.perceive(_log(log), core, grid, origin, shown)
    if output is not None:
        _core.write_objects(output, lists, False, origin)
    if write_truth is not None:
        _core.write_objects(write_truth, lists, True, origin)
    return lists


def _facts_of(sensor: Sensor) -> str:
    """Tells sensors of one name apart."""
    return (f"{sensor.name}: {sensor.min_range_m} to {sensor.max_range_m} m, {sensor.range_sigma_m} m, "
            f"{sensor.beams_per_s} beams/s")


def optimize(log: Log, *, seed: int = 1, annotation: Path | None = None, primitives: Path | None = None,
             allow_outside: bool = False, sensor: Sensor | str | None = None, report: Path | None = None,
             checkpoint: Path | None = None, resume: bool = False, progress: Progress | None = None,
             **options: Unpack[OptimizeParameters]) -> Tuning:
    """Tunes the parameters of a fit on a slice of the training log.

    `slice` takes the scans that begin in [from, to), s after the log's start; one in `validate` of them is scored and
    not fitted. `tune` names the parameters (the usual ones if empty), and options of `fit` set the fixed ones. With
    `annotation` and `primitives`, the class densities of a composed scene are tuned instead. `Tuning.parameters` has
    the best values. With `report`, a folder, a page with the search's progress is written too. `checkpoint` is a file
    that is written after each evaluation; with `resume`, the search goes on from it, with the result of one that was
    not interrupted. Raises `ValueError`, `TypeError`, `FormatError`, `OSError`.
    """
    if (annotation is None) != (primitives is None):
        raise ValueError("optimize: annotation and primitives belong together")
    if resume and not checkpoint:
        raise ValueError("optimize: resume needs a checkpoint")
    given, parameters = _divided(_core.optimize_options(), options)
    if annotation is None and "tune" in given:
        given["tune"] = [name.replace("_", "-") for name in given["tune"]]
    core = _set(_core.TuneOptions(), given)
    core.seed = seed
    fixed = {name.replace("_", "-"): str(value) for name, value in parameters.items()}
    known = fixed if sensor is None else {**fixed, "sensor": sensor if isinstance(sensor, str) else _facts_of(sensor)}
    file = _core.SearchFile(checkpoint or "", resume, f"underbrush {_core.version()}", json.dumps(known))
    with _shown(progress) as shown:
        if annotation is not None and primitives is not None:
            tuning = _core.optimize_scene(_log(log), core, annotation, os.fspath(primitives), allow_outside, file, shown)
        else:
            tuning = _core.optimize_fit(_log(log), core, parameters, _sensor(sensor), file, shown)
    if report is not None:
        _core.write_tuning_report(report, tuning, json.dumps(fixed), _provenance("optimize", seed))
    return tuning
