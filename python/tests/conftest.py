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
def run() -> Callable[..., str]:
    """Runs the program of the package and returns what it printed."""
    def run_program(*words: object) -> str:
        done = subprocess.run([str(program()), *map(str, words)], capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        return done.stdout
    return run_program
