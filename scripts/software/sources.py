"""The logs of the study, halved, and the sources that answer the beams of the half that was held out."""
import dataclasses
import pathlib
import subprocess
import sys
import typing

import numpy as np
import real_logs

from . import logs
from .logs import Floats, Log

# Drives whose frames lie in several folders of the data: the texts are those of the last.
FOLDERS = {"kitti_0005_tracks": ("kitti_0005_city", "kitti_0005_tracks")}
OPTIONS = {**real_logs.LOGS, "kitti_0005_tracks": ("kitti_0005_tracks", *real_logs.LOGS["kitti_0005_city"][1:])}
MOVING = ("kitti_0027_forest", "kitti_0005_tracks")
STANDING = "kitti_0052_static"
NAMES = (*MOVING, STANDING, "rellis_000104", "marv_forest")

# name: (model of scripts/real_logs.py, options of `simulate`)
MODELS = {"default": ("default", []), "default, anew": ("default", ["--matter", "anew"]), "surface": ("surface", []),
          "surface_carved": ("surface_carved", [])}
BASELINES = ("look-up, raw", "look-up, 2 scans", "always hit")  # as the study look-up names them
OURS, DISTANT_M, OFF_M = "default", 30.0, 0.2
MIXTURES = ("default, where off as the log", "default, distant and off as the log", "log, where off as the default")


@dataclasses.dataclass(frozen=True)
class Work:
    """Where the data is and the results go, and the program that makes them."""
    data: pathlib.Path
    folder: pathlib.Path
    program: pathlib.Path
    seeds: int
    reuse: bool


def absent(data: pathlib.Path, name: str) -> list[str]:
    """What of the data this log needs and is not there."""
    return [path for path in (*FOLDERS.get(name, ()), OPTIONS[name][0]) if not (data / path).exists()]


def unpacked(work: Work, name: str) -> pathlib.Path:
    """The drive or scan as `import` takes it."""
    source = work.data / OPTIONS[name][0]
    archives = [path for part in FOLDERS.get(name, (OPTIONS[name][0],)) for path in (work.data / part).glob("*.kfx")]
    if not archives:
        return source
    folder = work.folder / name / "raw"
    for archive in archives:
        subprocess.run([sys.executable, work.data / "frames.py", "unpack", archive, folder / "velodyne"], check=True)
    for text in source.glob("*.txt"):
        (folder / text.name).write_bytes(text.read_bytes())
    return folder


def halves(work: Work, name: str) -> Log:
    """Imports a log, with the times of its scans straightened, splits it, and returns the half that is held out."""
    folder = work.folder / name
    folder.mkdir(parents=True, exist_ok=True)
    train, test = folder / "train.ply", folder / "test.ply"
    if not (work.reuse and train.exists() and test.exists()):
        _, options, split, _ = OPTIONS[name]
        source = unpacked(work, name)
        words: list[typing.Any] = []
        if (source / "poses_velo.txt").exists():
            words += ["--poses", source / "poses_velo.txt"]
        if (source / "times.txt").exists():
            rounded = [float(line) for line in (source / "times.txt").read_text().split()]
            straight = folder / "times.txt"
            straight.write_text("".join(f"{t:.6f}\n" for t in logs.straight_times(rounded)))
            words += ["--times", straight]
        real_logs.run(work.program, "import", source, *words, *options, "-o", folder / "log.ply")
        real_logs.run(work.program, "split", folder / "log.ply", *split, "--train", train, "--test", test)
        (folder / "log.ply").unlink()
    return logs.read(test)


def simulated(work: Work, name: str, source: str, test: Log) -> typing.Iterator[Log]:
    """The test beams as a model answers them. The model is fitted once, when the source with its name is made. The
    default, of which the verdict is, is simulated with every seed where there is odometry, all else with one."""
    model, simulate = MODELS[source]
    folder = work.folder / name
    fitted = folder / model
    if source == model and not (work.reuse and fitted.exists()):
        real_logs.run(work.program, "fit", folder / "train.ply", *(real_logs.FITTERS[model] or []),
                      *OPTIONS[name][3], "-o", fitted)
    for seed in range(1, (work.seeds if name in MOVING and source == OURS else 1) + 1):
        kept = folder / f"{source}.{seed}.npy"
        if not (work.reuse and kept.exists()):
            answers = folder / "simulated.ply"
            real_logs.run(work.program, "simulate", fitted, "--like", folder / "test.ply", *simulate, "--seed", seed,
                          "-o", answers)
            np.save(kept, logs.ranges(answers, test))
            answers.unlink()
        yield test.answered(np.load(kept))


def baselines(work: Work, name: str, test: Log) -> typing.Iterator[tuple[str, Log]]:
    """The test beams as the baselines answer them, which the program of studies beside `underbrush` makes."""
    folder = work.folder / name
    kept = {source: folder / "look-up" / name / f"{source}.ply" for source in BASELINES}
    if not (work.reuse and all(path.exists() for path in kept.values())):
        alone = folder / "halves"
        alone.mkdir(exist_ok=True)
        (alone / name).unlink(missing_ok=True)
        (alone / name).symlink_to(folder.resolve())
        study = [work.program.with_name("underbrush-study"), "look-up", "--quick", "--data", alone,
                 "--keep", folder / "look-up"]
        done = subprocess.run(study, stdout=subprocess.DEVNULL)
        if done.returncode not in (0, 1):  # 1: the verdict falls short, which is not asked here
            raise subprocess.CalledProcessError(done.returncode, study)
    for source, path in kept.items():
        yield source, test.answered(logs.ranges(path, test))


def mixed(test: Log, ours: Log) -> dict[str, Log]:
    """What of the default makes the difference: the log and the default with each other's ranges on the beams on which
    they are OFF_M or more apart, or only one of them returns; and only on those that are DISTANT_M or longer."""
    real, sim = test.range_m, ours.range_m
    off = ~(np.abs(real - sim) < OFF_M)
    distant = off & (np.fmax(real, sim) >= DISTANT_M)
    ranges = (np.where(off, real, sim), np.where(distant, real, sim), np.where(off, sim, real))
    return {mixture: test.answered(range_m) for mixture, range_m in zip(MIXTURES, ranges)}


def answers(work: Work, name: str, test: Log) -> typing.Iterator[tuple[str, list[Log]]]:
    """The name of each source and what it answers: a log for each seed, or one where nothing is drawn."""
    for source in MODELS:
        logs_of_seeds = list(simulated(work, name, source, test))
        yield source, logs_of_seeds
        if source == OURS and name in MOVING:
            yield from ((mix, [log]) for mix, log in mixed(test, logs_of_seeds[0]).items())
    yield from ((source, [log]) for source, log in baselines(work, name, test))


def half_of_beams(log: Log) -> list[Floats]:
    """Twice the ranges of a log, (n), m, with every other beam of each scan left out: NaN."""
    out = []
    for left_out in (0, 1):
        range_m = log.range_m.copy()
        for _, rows in log.scans():
            range_m[rows.start + left_out:rows.stop:2] = np.nan
        out.append(range_m)
    return out
