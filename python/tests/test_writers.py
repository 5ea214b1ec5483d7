"""Writers: outputs are whole or absent, what a format cannot hold is counted, and NumPy logs hold all."""
from __future__ import annotations

import contextlib
import pathlib
import sys
import tracemalloc
from typing import Any

import numpy as np
import pytest
from format_data import generated_log, joined, pieces

import underbrush
from underbrush.formats import FormatError, beams, open_recording
from underbrush.formats.numpy_log import NumpyLogWriter
from underbrush.formats.ros_messages import typestore


def writer(path: pathlib.Path, poses: Any) -> Any:
    if path.suffix == ".npz":
        return NumpyLogWriter(path)
    if path.suffix in (".las", ".laz"):
        pytest.importorskip("laspy", reason="laspy is not installed: pip install 'underbrush[formats]'")
        from underbrush.formats.write_las import LasWriter
        return LasWriter(path)
    pytest.importorskip("rosbags", reason="rosbags is not installed: pip install 'underbrush[formats]'")
    from underbrush.formats.write_bag import BagWriter
    return BagWriter(path, poses)


NAMES = ["log.npz", "log.las", "log.laz", "log.mcap", "log.db3", "log.bag", "log"]


@pytest.mark.parametrize("name", NAMES)
def test_an_output_is_whole_or_absent(tmp_path: pathlib.Path, name: str) -> None:
    log, poses = generated_log(scans=2)
    path = tmp_path / name
    with pytest.raises(KeyError), writer(path, poses) as out:
        out.write(log)
        raise KeyError("the caller's")
    assert list(tmp_path.iterdir()) == []
    with writer(path, poses) as out:
        for piece in pieces(log):
            out.write(piece)
        assert not path.exists()
    assert [p.name for p in tmp_path.iterdir()] == [name]
    before = open_recording(path).bytes_total
    broken = {key: column for key, column in log.items() if key != "direction"}
    with contextlib.suppress(FileExistsError, KeyError, ValueError), writer(path, poses) as out:
        out.write(log)
        out.write(broken)
    assert [p.name for p in tmp_path.iterdir()] == [name]
    assert open_recording(path).bytes_total == before


@pytest.mark.parametrize("name", NAMES)
def test_memory_does_not_follow_the_log(tmp_path: pathlib.Path, name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """More than three times the scans take the same memory, in writing as in reading."""
    monkeypatch.setattr("underbrush.formats.numpy_log._CHUNK", 2000)
    monkeypatch.setattr("underbrush.formats.las._CHUNK_BYTES", 100_000)
    log, poses = generated_log(scans=1)
    peaks = []
    for scans in (12, 40):
        with writer((tmp_path / f"{scans}{name}"), poses) as out:
            tracemalloc.start()
            for number in range(scans):
                out.write({**log, "time_s": log["time_s"] + 0.1 * number, "scan": log["scan"] + number})
            written = tracemalloc.get_traced_memory()[1]
        tracemalloc.reset_peak()
        recording = open_recording(tmp_path / f"{scans}{name}")
        rows = sum(len(scan) for scan in recording.scans())
        peaks.append((written, tracemalloc.get_traced_memory()[1]))
        tracemalloc.stop()
        assert rows == out.written
    for few, many in zip(*peaks):
        assert many < 1.6 * few + 200_000


@pytest.mark.parametrize("name", NAMES)
def test_an_empty_log_and_one_of_misses_only(tmp_path: pathlib.Path, name: str) -> None:
    log, poses = generated_log(scans=1)
    log["range_m"][:] = np.inf
    with writer(tmp_path / name, poses) as out:
        out.write({key: column[:0] for key, column in log.items()})
        out.write(log)
    if name.endswith((".las", ".laz")):
        assert out.lost == {"misses": len(log["range_m"])} and out.written == 0
    else:
        assert not out.lost and out.written == len(log["range_m"])
    with writer(tmp_path / ("empty-" + name), poses):
        pass


def test_functions_replace_files_whole_or_leave_them(tmp_path: pathlib.Path) -> None:
    log, poses = generated_log(scans=1)
    notes = tmp_path / "notes.npz"
    notes.write_text("mine")
    with pytest.raises(KeyError), writer(notes, poses) as out:
        out.write(log)
        raise KeyError("the caller's")
    assert notes.read_text() == "mine"
    with writer(notes, poses) as out:
        out.write(log)
    assert notes.read_bytes().startswith(b"PK")
    assert "replace a file that exists" in (underbrush.__doc__ or "")


def test_a_folder_is_not_replaced(tmp_path: pathlib.Path) -> None:
    log, poses = generated_log(scans=1)
    (tmp_path / "log").mkdir()
    (tmp_path / "log" / "precious").write_text("!")
    with pytest.raises(FileExistsError), writer(tmp_path / "log", poses) as out:
        out.write(log)
    assert (tmp_path / "log" / "precious").read_text() == "!"
    with pytest.raises(FileNotFoundError), writer(tmp_path / "absent" / "log.npz", poses):
        pass


@pytest.mark.parametrize("echoes", [1, 3])
def test_numpy_logs_hold_everything(tmp_path: pathlib.Path, echoes: int) -> None:
    log, _ = generated_log(echoes=echoes)
    log["class"] = (log["ring"] % 5).astype(np.uint8)
    with NumpyLogWriter(tmp_path / "log.npz") as out:
        for piece in pieces(log, 777):
            out.write(piece)
    assert out.written == len(log["range_m"]) and not out.lost
    with np.load(tmp_path / "log.npz") as arrays:
        assert set(arrays) == set(log)
        for name, column in log.items():
            assert arrays[name].dtype == column.dtype
            np.testing.assert_array_equal(arrays[name], column)
    recording = open_recording(tmp_path / "log.npz")
    back = joined(list(beams(recording)))
    assert not recording.skipped and recording.bytes_done == recording.bytes_total
    for name in set(log) - {"packet"}:
        np.testing.assert_array_equal(back[name], log[name])


def test_pieces_of_one_log_have_the_same_columns(tmp_path: pathlib.Path) -> None:
    log, _ = generated_log(scans=1)
    with pytest.raises(ValueError, match="other columns than before"), NumpyLogWriter(tmp_path / "log.npz") as out:
        out.write(log)
        out.write({**log, "class": log["ring"]})
    assert list(tmp_path.iterdir()) == []


def test_damaged_numpy_logs_are_refused(tmp_path: pathlib.Path) -> None:
    log, _ = generated_log(scans=1)
    path = tmp_path / "log.npz"
    with NumpyLogWriter(path) as out:
        out.write(log)
    good = path.read_bytes()
    bad = [good[:len(good) // 2], good.replace(b"'shape': (2880,", b"'shape': (9999,"), b"PK\x03\x04" + bytes(99)]
    np.savez(tmp_path / "other.npz", a=np.zeros(3))
    bad.append((tmp_path / "other.npz").read_bytes())
    np.savez(tmp_path / "objects.npz", origin=np.array([None]))
    bad.append((tmp_path / "objects.npz").read_bytes())
    for content in bad:
        path.write_bytes(content)
        with pytest.raises(FormatError):
            list(open_recording(path).scans())


@pytest.mark.parametrize(("name", "module"), [("log.mcap", "rosbags"), ("log.las", "laspy"), ("log.laz", "lazrs")])
def test_a_missing_library_is_named(tmp_path: pathlib.Path, name: str, module: str,
                                    monkeypatch: pytest.MonkeyPatch) -> None:
    log, poses = generated_log(scans=1)
    with writer(tmp_path / name, poses) as out:
        out.write(log)
    for loaded in [key for key in sys.modules if key.partition(".")[0] == module]:
        monkeypatch.setitem(sys.modules, loaded, None)
    typestore.cache_clear()
    with pytest.raises(ImportError, match=f"^{module} is not installed: pip install 'underbrush\\[formats\\]'$"):
        open_recording(tmp_path / name)


def test_values_that_a_field_cannot_hold_are_counted(tmp_path: pathlib.Path) -> None:
    log, poses = generated_log(scans=1, misses=False)
    log["intensity"][:10] = 1e6
    with writer(tmp_path / "log.las", poses) as las:
        las.write(log)
    assert las.lost == {"values of intensity beyond 65535 (clamped)": 10}
    pytest.importorskip("rosbags")
    from underbrush.formats.write_bag import BagWriter
    with BagWriter(tmp_path / "log.mcap", poses, layout="autoware") as bag:
        bag.write(log)
    assert bag.lost == {"values of intensity beyond 255 (clamped)": 10}
    with pytest.raises(ValueError, match="no layout 'x': velodyne, ouster"):
        BagWriter(tmp_path / "log.mcap", poses, layout="x")
