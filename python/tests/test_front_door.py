"""Verbs of the command that are given recordings: `info` describes them, and the others name the import to run."""
from __future__ import annotations

import json
import pathlib
import shlex
import subprocess
import sys

import numpy as np
import pytest

pytest.importorskip("rosbags", reason="rosbags is not installed: pip install 'underbrush[formats]'")
pytest.importorskip("laspy", reason="laspy is not installed: pip install 'underbrush[formats]'")

from bag_messages import bag, some_points  # noqa: E402
from underbrush import cli  # noqa: E402

CASES = pathlib.Path(__file__).resolve().parents[2] / "tests/cases"
LAS, PCAP = CASES / "common_options/scan.las", CASES / "pcap_two_sensors/pc_two.pcap"


def command(*words: object) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, "-m", "underbrush.cli", *map(str, words)], check=False, capture_output=True,
                          text=True, env={"PYTHONPATH": ":".join(sys.path)})


@pytest.fixture
def drive(tmp_path: pathlib.Path) -> pathlib.Path:
    """Five scans on a way of 4 m, in a folder whose name needs quotes."""
    with bag(tmp_path / "my drive") as out:
        for k in range(5):
            out.cloud("/points", 100 + 0.1 * k, some_points())
            out.transform("/tf", 100 + 0.1 * k, "map", "lidar", [k, 0, 0], [0, 0, 0, 1])
    return tmp_path / "my drive"


def test_info_describes_bags(drive: pathlib.Path) -> None:
    done = command("info", drive, "--json", drive / "facts.json")
    assert done.returncode == 0 and done.stderr == ""
    lines = done.stdout.splitlines()
    assert lines[0].startswith("ROS 2 bag, 0.4 s")
    assert lines[1].startswith("/points: sensor_msgs/msg/PointCloud2, 5 messages, 10.0 Hz; layout ")
    assert lines[-1] == "poses from /tf: map -> lidar; 5 of them within 4.0 x 0.0 x 0.0 m"
    facts = json.loads((drive / "facts.json").read_text())
    assert facts["kind"] == "recording" and facts["found"] == lines
    assert facts["topics"] == [{"topic": "/points", "type": "sensor_msgs/msg/PointCloud2", "messages": 5},
                               {"topic": "/tf", "type": "tf2_msgs/msg/TFMessage", "messages": 5}]
    assert json.loads(command("info", drive, "--json", "-").stdout)["found"] == lines


def test_info_describes_surveys_and_captures(tmp_path: pathlib.Path) -> None:
    said = command("info", LAS).stdout
    assert "734 points" in said and "bounds 532088.0..532112.0 5412291.0..5412309.0" in said and "first point at" in said
    said = command("info", PCAP, "--topic", "192.168.1.201:2368").stdout
    assert "3072 beams: 2304 returns, 768 misses" in said
    two = command("info", PCAP)
    assert two.returncode == 3 and "add --topic 192.168.1.201:2368 or --topic 192.168.1.202:2368" in two.stderr
    writes = command("info", LAS, "-o", tmp_path / "log.ply")
    assert writes.returncode == 2 and "info writes no log" in writes.stderr and not (tmp_path / "log.ply").exists()


def test_info_gives_the_place_of_stations(tmp_path: pathlib.Path) -> None:
    pye57 = pytest.importorskip("pye57", reason="pye57 is not installed: pip install 'underbrush[formats]'")
    file = pye57.E57(str(tmp_path / "two.e57"), mode="w")
    for k in range(2):
        xyz = np.random.default_rng(k).normal(size=(50, 3))
        file.write_scan_raw({f"cartesian{axis}": xyz[:, n] for n, axis in enumerate("XYZ")}, name=f"S{k}",
                            translation=np.array([10.0 * k, 5, 1.5]))
    file.close()
    assert "station 1 S1: 50 points; at 10.00 5.00 1.50 m" in command("info", tmp_path / "two.e57").stdout


@pytest.mark.parametrize("words", [
    ("fit", "FILE", "-o", "model"), ("simulate", "model", "--like", "FILE", "-o", "out.ply"),
    ("simulate", "model", "--like=FILE", "-o", "out.ply"), ("score", "FILE", "other.ply"), ("score", "log.ply", "FILE"),
    ("serve", "FILE"), ("split", "FILE", "--train", "a.ply", "--test", "b.ply"), ("segment", "FILE", "-o", "x.ply"),
    ("optimize", "FILE")])
@pytest.mark.parametrize("kind", ["bag", "las", "pcap"])
def test_verbs_of_logs_name_the_import(drive: pathlib.Path, words: tuple[str, ...], kind: str) -> None:
    file = {"bag": drive, "las": LAS, "pcap": PCAP}[kind]
    done = command(*(word.replace("FILE", str(file)) for word in words))
    assert done.returncode == 3 and done.stdout == "" and done.stderr.count("\n") == 1
    assert done.stderr.startswith(f"underbrush: {file}: is a recording and no log: 'underbrush import ")


def test_the_command_that_is_named_makes_the_log(drive: pathlib.Path) -> None:
    said = command("fit", drive, "-o", "model").stderr
    words = shlex.split(said.partition(": is a recording and no log: '")[2].rpartition("'")[0])
    assert words == ["underbrush", "import", str(drive), "-o", "my drive.ply"]
    done = subprocess.run([sys.executable, "-m", "underbrush.cli", *words[1:]], cwd=drive.parent, check=False,
                          capture_output=True, text=True, env={"PYTHONPATH": ":".join(sys.path)})
    assert done.returncode == 0 and "320 rows" in done.stdout
    assert "320" in command("info", drive.parent / "my drive.ply").stdout


def test_outputs_and_absent_files_are_left_to_the_program() -> None:
    assert cli.advice(["fit", "absent.bag", "-o", "model"]) == ""
    assert cli.advice(["fit", "log.ply", "-o", str(LAS)]) == ""
    assert cli.advice(["perceive", "log.ply", "--truth", str(PCAP)]) == ""
    assert cli.advice(["osi", "convert", str(LAS)]) == cli.advice([]) == ""


def test_help_of_import_shows_every_option() -> None:
    said = command("import", "--help").stdout
    for word in ("--format NAME", "--topic NAME", "--metadata FILE", "--position X,Y,Z", "--infer-misses SENSOR",
                 "--frames A:B[:STEP]", "examples:", "underbrush import drive.bag"):
        assert word in said, word
