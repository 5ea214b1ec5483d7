"""Pictures of a cyclist and a van of a real drive: as ghosts in the world, and as learnt actors."""
from __future__ import annotations

import pathlib
import subprocess
import sys
import zlib
from collections.abc import Callable

import numpy as np
import numpy.typing as npt
import pytest
from format_data import data

import underbrush

ROOT = pathlib.Path(__file__).resolve().parents[2]
FRAMES = 10
PIXELS = 6  # of a beam, as in the script
TURNED = ("--boxes-elevation-deg", "0.205")


def panels_of(file: pathlib.Path) -> list[npt.NDArray[np.int16]]:
    """The range images of a picture, (rings, columns, 3) each: that of the real log, of ghosts, and of actors."""
    content = file.read_bytes()
    width, height = np.frombuffer(content[16:24], ">u4")
    start = content.index(b"IDAT")
    size = int.from_bytes(content[start - 4:start], "big")
    rows = np.frombuffer(zlib.decompress(content[start + 4:start + 4 + size]), np.uint8).reshape(height, 1 + 3 * width)
    picture = rows[::PIXELS, 1:].reshape(-1, width, 3)[:, ::PIXELS].astype(np.int16)
    rings = (len(picture) - 4) // 3  # two white rows between panels
    return [picture[k * (rings + 2):][:rings] for k in range(3)]


def places_of(log: underbrush.BeamLog) -> tuple[npt.NDArray[np.intp], npt.NDArray[np.intp], npt.NDArray[np.bool_]]:
    """Row and column of the beams of the scan that is drawn, and whether they end at the object."""
    scans, counts = np.unique(log.scan, return_counts=True)
    chosen = log.scan == scans[counts.argmax()]
    ring, packet = log.ring[chosen].astype(np.intp), log.packet[chosen]
    return (ring - ring.min(), np.searchsorted(np.unique(packet), packet),
            (log.flags[chosen] & underbrush.MOVER) != 0)


@pytest.fixture(scope="module")
def drive(run: Callable[..., str], tmp_path_factory: pytest.TempPathFactory) -> pathlib.Path:
    """A folder with the first frames of the drive: every other one is held out, actors and worlds are learnt."""
    source, folder = data("kitti_0005_city"), tmp_path_factory.mktemp("drive")
    subprocess.run([sys.executable, data("frames.py"), "unpack", source / "velodyne.kfx", folder / "all"], check=True)
    (folder / "frames" / "velodyne").mkdir(parents=True)
    for k in range(FRAMES):
        (folder / "all" / f"{k:06d}.bin").rename(folder / "frames" / "velodyne" / f"{k:06d}.bin")
    for name in ("poses_velo.txt", "times.txt"):
        lines = (source / name).read_text(encoding="utf-8").splitlines(keepends=True)
        (folder / name).write_text("".join(lines[:FRAMES]), encoding="utf-8")
    head, *rows = (source / "objects.csv").read_text(encoding="utf-8").splitlines(keepends=True)
    rows = [row for row in rows if int(row.partition(",")[0]) < FRAMES]
    for name in ("all", "Van", "Cyclist"):
        some = [row for row in rows if name == "all" or row.split(",")[2] == name]
        (folder / f"{name}.csv").write_text(head + "".join(some), encoding="utf-8")
    run("import", folder / "frames", "--poses", folder / "poses_velo.txt", "--times", folder / "times.txt", "--deskew",
        "velodyne-hdl64e", "--elevation-offset-deg", "0.205", "--infer-misses", "velodyne-hdl64e", "-o",
        folder / "log.ply")
    run("split", folder / "log.ply", "--every", 2, "--train", folder / "train.ply", "--test", folder / "test.ply")
    run("actors", folder / "train.ply", "--boxes", folder / "all.csv", *TURNED, "-o", folder / "actors", "--marked",
        folder / "static.ply")
    run("fit", folder / "train.ply", "--min-range", 2, "-o", folder / "ghosts")
    run("fit", folder / "static.ply", "--min-range", 2, "-o", folder / "world")
    return folder


@pytest.mark.parametrize("name", ["Van", "Cyclist"])
def test_an_actor_is_where_the_log_has_it(name: str, run: Callable[..., str], drive: pathlib.Path) -> None:
    """Most pixels of the object have the log's colour with actors, and fewer have it with ghosts; beside it, both do."""
    boxes, marked, met, picture = (drive / f"{name}{end}" for end in (".csv", "-marked.ply", ".ply", ".png"))
    run("actors", drive / "test.ply", "--boxes", boxes, *TURNED, "--marked", marked)
    run("actors", marked, "--boxes", boxes, *TURNED, "--met", met)
    run("simulate", drive / "ghosts", "--like", met, "-o", drive / "of_ghosts.ply", "--force")
    run("simulate", drive / "world", "--actors", drive / "actors", "--like", met, "-o", drive / "of_actors.ply",
        "--force")
    subprocess.run([sys.executable, ROOT / "scripts" / "actor_pictures.py", met, drive / "of_ghosts.ply",
                    drive / "of_actors.ply", "-o", picture], check=True)
    real, ghosts, actors = panels_of(picture)
    row, column, is_object = places_of(underbrush.read_log(met))
    assert real.shape[:2] == (row.max() + 1, column.max() + 1)
    alike = [(np.abs(panel - real) < 30).all(axis=2)[row, column] for panel in (ghosts, actors)]
    assert is_object.sum() > 200
    with_ghosts, with_actors = (float(same[is_object].mean()) for same in alike)
    beside = [float(same[~is_object].mean()) for same in alike]
    assert with_actors > 0.7
    assert with_ghosts < 0.8 * with_actors
    assert min(beside) > 0.7
