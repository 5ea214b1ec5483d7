"""What the tests share."""
from __future__ import annotations

import pathlib
import subprocess
from collections.abc import Callable

import pytest
from small_log import small_log

import underbrush
from underbrush.cli import program


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
def run() -> Callable[..., str]:
    """Runs the program of the package and returns what it printed."""
    def run_program(*words: object) -> str:
        done = subprocess.run([str(program()), *map(str, words)], capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        return done.stdout
    return run_program
