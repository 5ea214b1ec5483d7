"""What the tests share."""
from __future__ import annotations

import gc
import pathlib
import subprocess
from collections.abc import Callable

import numpy as np
import pytest
from small_log import small_log

import underbrush
from underbrush.cli import program

# With Python's own thresholds, a tenth of the time is spent collecting the objects of modules, which stay.
gc.set_threshold(50_000, 20, 50)


@pytest.fixture(scope="session")
def log() -> underbrush.BeamLog:
    """A log of 0.2 s."""
    return small_log()


@pytest.fixture(scope="session")
def log_file(log: underbrush.BeamLog, tmp_path_factory: pytest.TempPathFactory) -> pathlib.Path:
    """The log on disk."""
    path = tmp_path_factory.mktemp("log") / "log.ply"
    underbrush.write_log(path, log)
    return path


@pytest.fixture(scope="session")
def model(log_file: pathlib.Path) -> underbrush.Model:
    """A model fitted to the log."""
    return underbrush.fit(log_file)


@pytest.fixture(scope="session")
def box_mesh(tmp_path_factory: pytest.TempPathFactory) -> pathlib.Path:
    """A box of 4 m x 2 m x 2 m."""
    path = tmp_path_factory.mktemp("box") / "box.obj"
    corners = [(x, y, z) for x in (-2, 2) for y in (-1, 1) for z in (-1, 1)]
    sides = [(1, 2, 4, 3), (5, 6, 8, 7), (1, 2, 6, 5), (3, 4, 8, 7), (1, 3, 7, 5), (2, 4, 8, 6)]
    path.write_text("".join(f"v {x} {y} {z}\n" for x, y, z in corners) +
                    "".join(f"f {a} {b} {c}\nf {a} {c} {d}\n" for a, b, c, d in sides), encoding="utf-8")
    return path


@pytest.fixture(scope="session")
def learnt_actors(model: underbrush.Model, box_mesh: pathlib.Path,
                  tmp_path_factory: pytest.TempPathFactory) -> pathlib.Path:
    """The folder of the actor `car-1`, learnt from a log in which the box passes."""
    folder = tmp_path_factory.mktemp("actors")
    times = np.array([0.0, 2.0])
    level = np.tile([0.0, 0, 0, 1], (2, 1))
    log = underbrush.simulate(model, sensor="velodyne-vlp16", trajectory=underbrush.Trajectory(
        times, np.array([[0, 0, 1.8], [0, 0, 1.8]]), level), movers=[
            (box_mesh, underbrush.Trajectory(times, np.array([[-6.0, 8, 1.2], [6, 8, 1.2]]), level), "")])
    (folder / "boxes.csv").write_text("time,id,class,x,y,z,yaw,length,width,height\n" + "".join(
        f"{0.1 * k:.1f},1,car,{0.6 * k - 6:.1f},8,1.2,0,4,2,2\n" for k in range(21)), encoding="utf-8")
    underbrush.actors(log, folder / "actors", boxes=folder / "boxes.csv")
    return folder / "actors"


@pytest.fixture(scope="session")
def run() -> Callable[..., str]:
    """Runs the program of the package and returns what it printed."""
    def run_program(*words: object) -> str:
        done = subprocess.run([str(program()), *map(str, words)], capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        return done.stdout
    return run_program
