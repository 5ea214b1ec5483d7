"""Logs of recordings, which are imported once and kept in the user's cache, for verbs and functions that read logs."""
from __future__ import annotations

import contextlib
import hashlib
import json
import os
import pathlib
import shutil
import warnings
import zipfile
from collections.abc import Callable, Sequence

from underbrush._core import BeamLog, version

#: Most bytes of logs that the cache keeps; those used least recently are removed.
MOST_BYTES = 32 << 30
#: Ends of names of recordings that the program does not read by itself.
RECORDINGS = (".bag", ".mcap", ".db3", ".las", ".laz", ".pcap", ".pcapng", ".e57", ".xyz")


def is_recording(name: str | os.PathLike[str]) -> bool:
    """Whether the package's readers, and not the program, read the file or folder (a ROS 2 bag is a folder)."""
    path = pathlib.Path(name)
    is_folder = (path / "metadata.yaml").is_file() or bag_in(path) != path
    return path.name.lower().endswith(RECORDINGS) or is_folder or _is_numpy_log(path)


def bag_in(path: pathlib.Path) -> pathlib.Path:
    """The one bag file of a folder whose metadata.yaml is missing, as when the recorder dies; else the path."""
    if not path.is_dir() or (path / "metadata.yaml").exists():
        return path
    files = [file for file in path.iterdir() if file.suffix in (".mcap", ".db3") and not file.name.startswith(".")]
    return files[0] if len(files) == 1 else path


def _is_numpy_log(path: pathlib.Path) -> bool:
    """Whether the file is a log of the package's `NumpyLogWriter`: the program reads files of one array alone."""
    if path.suffix.lower() != ".npz":
        return False
    try:
        with zipfile.ZipFile(path) as file:
            return "range_m.npy" in file.namelist()
    except (OSError, zipfile.BadZipFile):
        return False


def cache_folder() -> pathlib.Path:
    """The folder of logs in the user's cache, where `serve` keeps its octrees, too."""
    given = os.environ.get("XDG_CACHE_HOME", "")
    base = pathlib.Path(given) if os.path.isabs(given) else pathlib.Path.home() / ".cache"
    return base / "underbrush" / "logs"


def given_log(log: BeamLog | str | os.PathLike[str]) -> BeamLog | str | os.PathLike[str]:
    """The log, or that of a recording, whose notes become warnings for the caller's caller."""
    if isinstance(log, BeamLog) or not is_recording(log) or not os.path.exists(log):
        return log
    return log_of(log, lambda note: warnings.warn(note, stacklevel=5))


def log_of(recording: str | os.PathLike[str], say: Callable[[str], object],
           options: Sequence[str] = ()) -> pathlib.Path:
    """Returns the log of a recording, made by `underbrush import` with these options unless the cache has it.

    A recording that changed, or whose metadata beside it did, is imported anew, and so it is by another version. `say`
    receives the notes of the import, such as how positions were estimated. Raises what the readers raise.
    """
    source = pathlib.Path(recording).resolve()
    place = cache_folder() / _hash(json.dumps([str(source), *options]))
    log = place / _hash(_state(source, options)) / (source.stem + ".ply")
    counts = log.with_suffix(".json")
    if not (log.exists() and counts.exists()):
        _import([str(source), "-o", str(log), *options], counts)
        for other in place.iterdir():
            if other != log.parent:
                shutil.rmtree(other, ignore_errors=True)
        with contextlib.suppress(OSError):  # Another process may remove the same.
            _remove_old(place)
    with contextlib.suppress(OSError):
        os.utime(place)
    found = json.loads(counts.read_text(encoding="utf-8"))
    left_out = [f"{n} records left out: {why}" for why, n in found["skipped"].items()]
    for note in [*left_out, *found["notes"], *(f"warning: {text}" for text in found["warnings"])]:
        say(f"{recording}: {note}")
    return log


def _remove_old(kept: pathlib.Path) -> None:
    """Removes the logs used least recently where all logs have more than `MOST_BYTES`, but not that of `kept`."""
    def bytes_of(place: pathlib.Path) -> int:
        return sum(file.stat().st_size for file in place.rglob("*") if file.is_file())

    places = sorted((place for place in kept.parent.iterdir() if place.is_dir()), key=lambda p: p.stat().st_mtime)
    total = sum(map(bytes_of, places))
    for place in places:
        if total <= MOST_BYTES:
            break
        if place != kept:
            total -= bytes_of(place)
            shutil.rmtree(place, ignore_errors=True)


def _import(words: Sequence[str], counts: pathlib.Path) -> None:
    from underbrush.formats._files import OptionMissing, written_whole
    from underbrush.formats.import_options import parsed
    from underbrush.import_recording import command_of_result, opened, write
    options = parsed(words)
    provenance = json.dumps({"program": f"underbrush {version()}", "command": command_of_result(words), "seed": 1,
                             "inputs": {}})
    counts.parent.mkdir(parents=True, exist_ok=True)
    try:
        found = write(options, opened(options), provenance)
        with written_whole(counts) as target:
            target.write_text(json.dumps(found), encoding="utf-8")
    except OptionMissing as missing:
        raise OptionMissing(f"{missing} (options of 'underbrush import', which the command's other verbs take, too)"
                            ) from missing
    finally:
        with contextlib.suppress(OSError):
            counts.parent.rmdir()  # Where nothing was written.


def _state(source: pathlib.Path, options: Sequence[str]) -> str:
    """Names, sizes and times of the files of the recording, its metadata and the options, and the version."""
    files = sorted(source.iterdir()) if source.is_dir() else [source]
    files += [source.with_suffix(ending) for ending in (".json", ".yaml", ".xml")]
    files += [pathlib.Path(option.partition("=")[2]) for option in options]
    facts = [(path.name, path.stat().st_size, path.stat().st_mtime_ns) for path in files if path.is_file()]
    return json.dumps([version(), facts])


def _hash(text: str) -> str:
    return hashlib.sha256(text.encode("utf-8", "surrogateescape")).hexdigest()[:16]
