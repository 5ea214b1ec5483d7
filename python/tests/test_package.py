"""The package as such: its types, its command, its table of parameters."""
from __future__ import annotations

import pathlib
import subprocess
import sys

import pytest

import underbrush
from underbrush import cli

HERE = pathlib.Path(__file__).resolve().parent


def test_parameters_are_those_of_the_library() -> None:
    subprocess.run([sys.executable, str(HERE / "make_parameters.py"), "--check"], check=True)


def test_types_of_examples_notebooks_and_the_stub() -> None:
    mypy = pytest.importorskip("mypy.api")
    files = sorted(str(path) for name in ("examples", "notebooks") for path in (HERE.parent / name).glob("*.py"))
    assert len(files) > 4
    stub = pathlib.Path(underbrush.__file__).parent / "_core.pyi"
    out, errors, code = mypy.run(["--config-file", str(HERE.parents[1] / "pyproject.toml"), "--cache-dir", "/dev/null",
                                  *files, str(stub)])
    assert code == 0, out + errors


def test_everything_public_is_documented() -> None:
    for name in underbrush.__all__:
        if name != "__version__":
            assert getattr(underbrush, name).__doc__, name


def test_no_warnings_of_leaks() -> None:
    done = subprocess.run([sys.executable, "-c", "import underbrush; underbrush.BeamLog(3).range_m"], check=True,
                          capture_output=True, text=True, env={"UNDERBRUSH_LEAK_WARNINGS": "1",
                                                               "PYTHONPATH": ":".join(sys.path)})
    assert done.stderr == ""


def test_command_is_the_program() -> None:
    ours = subprocess.run([sys.executable, "-m", "underbrush.cli", "--version"], check=True, capture_output=True,
                          text=True, env={"PYTHONPATH": ":".join(sys.path)})
    assert ours.stdout.split() == ["underbrush", underbrush.__version__]
    wrong = subprocess.run([sys.executable, "-m", "underbrush.cli", "fit"], check=False, capture_output=True, text=True,
                           env={"PYTHONPATH": ":".join(sys.path)})
    assert wrong.returncode == 2 and wrong.stderr.startswith("underbrush: ")


def test_recordings_are_the_packages() -> None:
    assert cli.recording_of(["import", "drive.BAG", "-o", "x.ply"]) == "drive.BAG"
    assert cli.recording_of(["import", "-o", "x.ply", "a.mcap"]) == "a.mcap"
    assert cli.recording_of(["import", "scan.pcd", "-o", "x.ply"]) is None
    assert cli.recording_of(["info", "drive.bag"]) == "drive.bag"
    assert cli.recording_of(["fit", "drive.bag"]) is None
