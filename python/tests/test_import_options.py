"""Options of `underbrush import` for recordings: those that all verbs have, and those of the program's import."""
from __future__ import annotations

import json
import pathlib
import subprocess

import numpy as np
import numpy.lib.recfunctions as fields
import pytest

pytest.importorskip("rosbags", reason="rosbags is not installed: pip install 'underbrush[formats]'")
pytest.importorskip("laspy", reason="laspy is not installed: pip install 'underbrush[formats]'")

import underbrush  # noqa: E402
from bag_messages import bag, some_points  # noqa: E402
from underbrush.cli import program  # noqa: E402
from underbrush.import_recording import run  # noqa: E402

SCAN = pathlib.Path(__file__).resolve().parents[2] / "tests/cases/common_options/scan.las"
PLACE = ["--position", "532100,5412300,311.8"]


@pytest.fixture
def drive(tmp_path: pathlib.Path) -> pathlib.Path:
    """Ten scans of 64 points, whose rings are 0 to 3, on a way along x at 10 m/s."""
    with bag(tmp_path / "drive") as out:
        for k in range(10):
            points = fields.append_fields(some_points(), "class", np.full(64, 70, np.uint16), usemask=False)
            out.cloud("/points", 100 + 0.1 * k, points)
            out.transform("/tf", 100 + 0.1 * k, "map", "lidar", [k, 0, 0], [0, 0, 0, 1])
    return tmp_path / "drive"


def imported(source: pathlib.Path, *words: str) -> underbrush.BeamLog:
    log = source.with_name("log.ply")
    assert run([str(source), *words, "-o", str(log)]) == 0
    return underbrush.read_log(log)


@pytest.mark.parametrize(("words", "numbers"), [("2:5", [2, 3, 4]), (":3", [0, 1, 2]), ("7:", [7, 8, 9]),
                                                ("1:9:3", [1, 4, 7])])
def test_frames_are_scans_by_number(drive: pathlib.Path, words: str, numbers: list[int]) -> None:
    log = imported(drive, "--frames", words)
    assert np.unique(log.scan).tolist() == numbers == [scan.scan for scan in log.info.scans]
    np.testing.assert_allclose(np.unique(log.origin[:, 0]), numbers)
    assert len(log) == 64 * len(numbers)


def test_frames_are_of_scans_only(capsys: pytest.CaptureFixture[str], tmp_path: pathlib.Path) -> None:
    assert run([str(SCAN), *PLACE, "--frames", "0:1", "-o", str(tmp_path / "log.ply")]) == 2
    assert "--frames is for recordings of scans" in capsys.readouterr().err


def test_keep_takes_the_points_of_a_value(drive: pathlib.Path, capsys: pytest.CaptureFixture[str]) -> None:
    log = imported(drive, "--keep", "ring=2")
    assert set(log.ring) == {2} and len(log) == 160
    assert "skipped     480 records: ring is not 2 (--keep)" in capsys.readouterr().out
    assert run([str(drive), "--keep", "echos=1", "-o", str(drive.with_name("x.ply"))]) == 3
    assert "no column echos (--keep): class, flags, intensity, packet, range_m, ring, scan" in capsys.readouterr().err
    assert not drive.with_name("x.ply").exists()


def test_numbers_of_float_and_label_set(drive: pathlib.Path) -> None:
    whole, half = imported(drive), imported(drive, "--float", "--label-set", "semantickitti")
    assert half.info.classes == "semantickitti" and whole.info.classes == ""
    assert drive.with_name("log.ply").read_bytes().count(b"property double") == 1  # The time.
    np.testing.assert_allclose(half.range_m, whole.range_m, atol=1e-5)


def test_threads_seed_and_place_of_the_output_do_not_change_the_log(drive: pathlib.Path) -> None:
    imported(drive, "--threads", "1")
    first = drive.with_name("log.ply").read_bytes()
    imported(drive, "--threads=2", "--json", str(drive.with_name("counts.json")), "--force")
    assert drive.with_name("log.ply").read_bytes() == first
    assert run([str(drive), "-o", str(drive.with_name("other.ply"))]) == 0
    assert drive.with_name("other.ply").read_bytes() == first
    counts = json.loads(drive.with_name("counts.json").read_text())
    assert counts["rows"] == 640 and counts["program"] == f"underbrush {underbrush.__version__}"


def test_config_gives_options_and_flags_override_it(drive: pathlib.Path, capsys: pytest.CaptureFixture[str]) -> None:
    config = drive.with_name("import.yaml")
    config.write_text("frames: 2:5\nmax-range: 77\nfloat: true\nseed: 4\n")
    log = imported(drive, "--config", str(config))
    assert np.unique(log.scan).tolist() == [2, 3, 4] and log.info.max_range_m == 77
    assert np.unique(imported(drive, "--config", str(config), "--frames", "0:1").scan).tolist() == [0]
    for text, reason in (("deskew: velodyne-vlp16\n", "deskew: is not for recordings"),
                         ("fraems: 2:5\n", "fraems: no such option of 'import'"), ("a: b: c\n", "line 1: "),
                         ("- a\n", "expected lines of NAME: VALUE"), ("float: maybe\n", "expected true or false")):
        config.write_text(text)
        assert run([str(drive), "--config", str(config), "-o", str(drive.with_name("log.ply"))]) == 3
        said = capsys.readouterr().err
        assert said.count("\n") == 1 and reason in said
    assert run([str(drive), "--config", str(drive / "none.yaml")]) == 3


def test_the_programs_own_configuration_is_read(drive: pathlib.Path) -> None:
    dumped = subprocess.run([str(program()), "dump-config", "import"], check=True, capture_output=True, text=True)
    config = drive.with_name("import.yaml")
    config.write_text(dumped.stdout.replace("# frames: ", "frames: 3:4"))
    assert np.unique(imported(drive, "--config", str(config)).scan).tolist() == [3]


@pytest.mark.parametrize(("words", "reason"), [
    (["--threads", "-1"], "--threads: expected a whole number"), (["--threads", "2000"], "from 0 to 1024"),
    (["--seed", "x"], "--seed: expected a whole number"), (["--frames", "3"], "expected A:B or A:B:STEP"),
    (["--frames", "5:2"], "no frame lies in"), (["--keep", "ring"], "expected COLUMN=NUMBER"),
    (["--position", "1,2"], "expected X,Y,Z"), (["--max-range", "nan"], "must be from 0"),
    (["--clock", "wall"], "invalid choice: 'wall'"),
    (["--label-set", "kitti"], "invalid choice: 'kitti'"), (["--deskew", "velodyne-vlp16"], "--deskew")])
def test_wrong_usage_is_one_line(drive: pathlib.Path, capsys: pytest.CaptureFixture[str], words: list[str],
                                 reason: str) -> None:
    with pytest.raises(SystemExit) as ended:
        run([str(drive), *words, "-o", str(drive.with_name("log.ply"))])
    said = capsys.readouterr().err
    assert ended.value.code == 2 and said.count("\n") == 1 and said.startswith("underbrush: ") and reason in said


def test_a_place_may_begin_with_a_minus(tmp_path: pathlib.Path) -> None:
    with bag(tmp_path / "still") as out:
        out.cloud("/points", 100, some_points())
    log = imported(tmp_path / "still", "--position", "-5,2,-0.5")
    np.testing.assert_array_equal(np.unique(log.origin, axis=0), [[-5, 2, -0.5]])


def test_an_own_sensor_goes_into_the_log(drive: pathlib.Path) -> None:
    own = drive.with_name("own.yaml")
    text = (pathlib.Path(underbrush.__file__).parent / "share/underbrush/sensors/velodyne-vlp16.yaml").read_text()
    own.write_text(text)
    info = imported(drive, "--sensor", str(own)).info
    assert info.sensor == underbrush.Sensor(str(own)).name and info.sensor_file == text and info.max_range_m == 100
