"""Verbs of the command that are given recordings: `info` describes them, and the others read their logs."""
from __future__ import annotations

import json
import os
import pathlib
import shutil
import subprocess
import sys
import time
import urllib.request

import numpy as np
import pytest

pytest.importorskip("rosbags", reason="rosbags is not installed: pip install 'underbrush[formats]'")
pytest.importorskip("laspy", reason="laspy is not installed: pip install 'underbrush[formats]'")

import underbrush  # noqa: E402
from bag_messages import bag, some_points  # noqa: E402
from flights import straight, survey, write  # noqa: E402
from underbrush import cli  # noqa: E402
from underbrush.formats import OptionMissing  # noqa: E402
from underbrush.recorded import log_of  # noqa: E402

CASES = pathlib.Path(__file__).resolve().parents[2] / "tests/cases"
LAS, PCAP = CASES / "common_options/scan.las", CASES / "pcap_two_sensors/pc_two.pcap"


@pytest.fixture(autouse=True)
def cache(tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> pathlib.Path:
    """The user's cache."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    return tmp_path / "cache"


def command(*words: object) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, "-m", "underbrush.cli", *map(str, words)], check=False, capture_output=True,
                          text=True, env={**os.environ, "PYTHONPATH": ":".join(sys.path)})


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


PLACE = "--position=532100,5412300,311.8"


def logs_in(cache: pathlib.Path) -> list[pathlib.Path]:
    return sorted(cache.glob("underbrush/logs/*/*/*.ply"))


def test_verbs_of_logs_read_recordings(drive: pathlib.Path, cache: pathlib.Path, tmp_path: pathlib.Path) -> None:
    """The answers are those of the log that import makes, and it is made once."""
    log, model = tmp_path / "my drive.ply", tmp_path / "model"
    assert command("import", drive, "-o", log).returncode == 0
    done = command("fit", drive, "-o", model)
    (kept,) = logs_in(cache)
    assert done.returncode == 0 and done.stderr.splitlines()[-1] == f"underbrush: {drive}: its log is {kept}"
    assert f"underbrush: {drive}: the log has no misses" in done.stderr  # A note of the import.
    assert len(underbrush.read_log(kept)) == len(underbrush.read_log(log)) == 320
    made = kept.stat().st_mtime_ns
    for words in (("--like", drive), (f"--like={drive}",)):
        assert command("simulate", model, *words, "-o", tmp_path / "a.ply").returncode == 0
        assert command("simulate", model, "--like", log, "-o", tmp_path / "b.ply").returncode == 0
        a, b = (underbrush.read_log(tmp_path / name) for name in ("a.ply", "b.ply"))
        np.testing.assert_array_equal(a.range_m, b.range_m)
    done = command("score", drive, tmp_path / "a.ply", "--json", "-")
    assert done.returncode == 0 and json.loads(done.stdout)
    parts = ("--train", tmp_path / "t.ply", "--test", tmp_path / "u.ply")
    assert command("split", drive, "--every", 2, *parts).returncode == 0
    assert logs_in(cache) == [kept] and kept.stat().st_mtime_ns == made


def test_a_recording_that_changed_is_imported_anew(drive: pathlib.Path, cache: pathlib.Path) -> None:
    say: list[str] = []
    first = log_of(drive, say.append)
    notes = list(say)
    assert notes and log_of(drive, say.append) == first and say == 2 * notes
    first.unlink()
    assert log_of(drive, say.append) == first and first.exists()
    os.utime(next(drive.iterdir()), (1, 1))
    second = log_of(drive, say.append)
    assert second != first and logs_in(cache) == [second]


def test_logs_that_were_used_least_recently_leave_a_full_cache(tmp_path: pathlib.Path, cache: pathlib.Path,
                                                               monkeypatch: pytest.MonkeyPatch) -> None:
    logs = []
    for k in range(3):
        copy = tmp_path / f"scan{k}.las"
        shutil.copy(LAS, copy)
        logs.append(log_of(copy, [].append, [PLACE]))
        os.utime(logs[-1].parents[1], (k + 1, k + 1))
    bytes_of_one = sum(file.stat().st_size for file in logs[0].parent.iterdir())
    assert log_of(tmp_path / "scan0.las", [].append, [PLACE]) == logs[0]  # now used last
    monkeypatch.setattr("underbrush.recorded.MOST_BYTES", int(3.5 * bytes_of_one))
    shutil.copy(LAS, tmp_path / "scan3.las")
    logs.append(log_of(tmp_path / "scan3.las", [].append, [PLACE]))
    assert [log.exists() for log in logs] == [True, False, True, True]
    monkeypatch.setattr("underbrush.recorded.MOST_BYTES", 1)
    shutil.copy(LAS, tmp_path / "scan4.las")
    logs.append(log_of(tmp_path / "scan4.las", [].append, [PLACE]))
    assert logs_in(cache) == [logs[-1]]


def test_verbs_take_the_options_of_import_for_recordings(cache: pathlib.Path, tmp_path: pathlib.Path) -> None:
    done = command("fit", LAS, "-o", tmp_path / "model")
    assert done.returncode == 2 and done.stderr.count("\n") == 1 and "--position X,Y,Z" in done.stderr
    assert "options of 'underbrush import', which the command's other verbs take, too" in done.stderr
    assert not logs_in(cache)
    assert command("fit", LAS, PLACE, "-o", tmp_path / "model").returncode == 0
    done = command("segment", PCAP, "--topic", "192.168.1.201:2368", "--position", "0,0,2", "-o", tmp_path / "x.ply")
    assert done.returncode == 0 and len(underbrush.read_log(tmp_path / "x.ply")) == 3072
    assert len(logs_in(cache)) == 2
    broken = tmp_path / "broken.laz"
    broken.write_bytes(LAS.read_bytes()[:300])
    done = command("fit", broken, PLACE, "-o", tmp_path / "other")
    assert done.returncode == 3 and done.stderr.startswith(f"underbrush: {broken}: ") and done.stderr.count("\n") == 1


def test_serve_shows_recordings(tmp_path: pathlib.Path) -> None:
    words = [sys.executable, "-m", "underbrush.cli", "serve", str(LAS), PLACE, "--json", str(tmp_path / "serve.json")]
    with subprocess.Popen(words, env={**os.environ, "PYTHONPATH": ":".join(sys.path)}, text=True,
                          stdout=subprocess.PIPE) as server:
        try:
            ready = tmp_path / "serve.json"
            while not ready.exists() and server.poll() is None:
                time.sleep(0.05)
            address = json.loads(ready.read_text())["address"]
            with urllib.request.urlopen(address + "api/files") as answer:
                assert [(f["kind"], f["name"]) for f in json.load(answer)["files"]] == [("log", "scan.ply")]
        finally:
            server.terminate()


def test_functions_read_recordings(tmp_path: pathlib.Path) -> None:
    flight = write(tmp_path / "flight.las", survey(straight(400), 2, pulses_s=500))
    with pytest.warns(UserWarning, match="flight.las: the sensor's positions are estimated from"):
        model = underbrush.fit(flight)
    with pytest.warns(UserWarning, match="no misses") as warned:
        answer = underbrush.simulate(model, like=flight)
    assert len(answer) == 1000 and np.isfinite(answer.range_m).mean() > 0.9
    assert {w.filename for w in warned} == {__file__}
    with pytest.raises(OptionMissing, match="--position"):
        underbrush.fit(LAS)


def test_outputs_and_other_words_are_left_as_they_are() -> None:
    for words in (["fit", "absent.bag", "-o", "model"], ["fit", "log.ply", "-o", str(LAS)], [],
                  ["perceive", "log.ply", "--truth", str(PCAP)], ["osi", "convert", str(LAS)], ["fit", "--position"],
                  ["split", "log.ply", "--train", str(LAS), "--test", str(LAS)], ["fit", "log.ply", "--topic", "a"]):
        assert cli.with_logs(words) == words


def test_logs_are_written_in_the_format_of_the_name(drive: pathlib.Path, tmp_path: pathlib.Path) -> None:
    known = command("import", drive, "-o", tmp_path / "log.ply")
    assert known.returncode == 0, known.stderr
    rows = len(underbrush.read_log(tmp_path / "log.ply"))
    for name in ("log.npz", "log.laz", "log.mcap", "log.bag"):
        out = tmp_path / name
        for words in (("import", drive), ("import", tmp_path / "log.ply")):
            done = command(*words, "-o", out, "--force")
            assert done.returncode == 0 and ".underbrush-" not in done.stdout, done.stderr
            place = ("--position", "0,0,0") if name.endswith("laz") else ()
            again = command("import", out, "-o", tmp_path / "again.ply", *place)
            assert again.returncode == 0, again.stderr
            assert len(underbrush.read_log(tmp_path / "again.ply")) == rows
        assert [p for p in tmp_path.iterdir() if p.name.startswith(".underbrush-")] == []
    notes = tmp_path / "notes.laz"
    notes.write_text("mine")
    kept = command("import", drive, "-o", notes)
    assert (kept.returncode, notes.read_text()) == (4, "mine") and "--force" in kept.stderr
    absent = command("import", tmp_path / "absent.ply", "-o", tmp_path / "new.laz")
    assert absent.returncode == 3 and not (tmp_path / "new.laz").exists() and absent.stderr.count("\n") == 1


def test_bags_of_a_simulation_have_the_layout_of_the_sensor(tmp_path: pathlib.Path) -> None:
    (tmp_path / "ground.obj").write_text("v -99 -99 0\nv 99 -99 0\nv 99 99 0\nv -99 99 0\nf 1 2 3 4\n")
    (tmp_path / "poses.txt").write_text("".join(f"{0.05 * k} {k} 0 2 0 0 0 1\n" for k in range(5)))
    for sensor, profile, layout in (("velodyne-vlp16", (), "velodyne"), ("ouster-os1-64", (), "ouster"),
                                    ("velodyne-vlp16", ("--profile", "autoware"), "autoware")):
        out = tmp_path / f"{sensor}-{layout}.mcap"
        done = command("simulate", tmp_path / "ground.obj", "--sensor", sensor, "--trajectory", tmp_path / "poses.txt",
                       *profile, "-o", out)
        assert done.returncode == 0, done.stderr
        said = command("info", out).stdout
        assert f"layout {layout} " in said and "5 of them within 4.0 x 0.0 x 0.0 m" in said, said


def test_help_of_import_shows_every_option() -> None:
    said = command("import", "--help").stdout
    for word in ("--format NAME", "--topic NAME", "--metadata FILE", "--position X,Y,Z", "--infer-misses SENSOR",
                 "--frames A:B[:STEP]", "examples:", "underbrush import drive.bag"):
        assert word in said, word
