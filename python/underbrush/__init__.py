"""Underbrush: a lidar simulator learnt from logs of off-road terrain.

It has functions for twelve verbs of the command `underbrush`: `import_log`, `split`, `movers`, `actors`, `fit`,
`optimize`, `segment`, `extract`, `compose`, `simulate`, `perceive` and `score`. They take most options of the verbs as
keyword arguments. Their inputs and results are values (`BeamLog`, `Model`, `Scene`, `Sensor`) or the paths of files:

    model = underbrush.fit("train.ply")
    simulated = underbrush.simulate(model, like="test.ply")
    print(underbrush.score("test.ply", simulated, model=model).all.f1)

Frames are right-handed with z up; lengths are m, times s, angles rad. Arrays are views of the library's memory: nothing
is copied, and a view keeps its owner alive. Other Python threads run during long calls, which end on Ctrl-C and report
to `progress(stage, done, total)`. The same seed gives the same bits as the command, for any number of threads.

Functions that write replace a file that exists, as those of NumPy and pandas do, and no folder of something else.

Errors: `ValueError` for a caller's mistake, `FormatError` for bad data in a file, `OSError` from the file system.
"""
from __future__ import annotations

from underbrush._core import (BeamLog, EllipsoidTable, LogInfo, LogReader, LogWriter, Model, ObjectLists, PointCloud,
                              Pose, Primitives, ScanInfo, Scene, Score, Sensor, Summary, Trajectory, TriangleMesh,
                              Tuning, beams, class_names, fitters, read_log, read_model, read_scene, read_trajectory,
                              sensors, set_threads, threads, version, write_log, write_model, write_primitives,
                              write_scene)
from underbrush.arrow import log_from_arrow, write_parquet
from underbrush.errors import FormatError
from underbrush.live import Lidar
from underbrush.logs import ellipsoid_axes, log_from_columns
from underbrush.results import MOVER, Imported, LearntActors, Marked, Segmentation, Split
from underbrush.scenes import scene_from_models
from underbrush.verbs import (actors, compare_clouds, compose, extract, fit, import_log, movers, optimize,
                              perceive, report_of, score, segment, simulate, split)

__version__ = version()

__all__ = [
    "BeamLog", "EllipsoidTable", "FormatError", "Imported", "LearntActors", "Lidar", "LogInfo", "LogReader",
    "LogWriter", "MOVER", "Marked", "Model", "ObjectLists", "PointCloud", "Pose", "Primitives", "ScanInfo", "Scene",
    "Score", "Segmentation", "Sensor", "Split", "Summary", "Trajectory", "TriangleMesh", "Tuning", "__version__",
    "actors", "beams", "class_names", "compare_clouds", "compose", "ellipsoid_axes", "extract", "fit", "fitters",
    "import_log", "log_from_arrow", "log_from_columns", "movers", "optimize", "perceive", "read_log", "read_model",
    "read_scene", "read_trajectory", "report_of", "scene_from_models", "score", "segment", "sensors", "set_threads",
    "simulate", "split", "threads", "write_log", "write_model", "write_parquet", "write_primitives", "write_scene",
]
