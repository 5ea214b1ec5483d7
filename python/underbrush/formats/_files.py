"""Helpers of the readers and writers: optional libraries, damaged files, outputs that appear whole."""
from __future__ import annotations

import contextlib
import importlib
import os
import pathlib
import shutil
import tempfile
from collections.abc import Callable, Iterator
from typing import Any

import numpy.typing as npt

from ..errors import FormatError

PathLike = str | os.PathLike[str]
Array = npt.NDArray[Any]


class OptionMissing(ValueError):
    """A file does not say all that is needed; the text is one line that names the option to add."""


def need(module: str) -> Any:
    """Imports an optional library. Raises `ImportError` with the command that installs it."""
    try:
        return importlib.import_module(module)
    except ImportError as error:
        name = module.partition(".")[0]
        raise ImportError(f"{name} is not installed: pip install 'underbrush[formats]'") from error


@contextlib.contextmanager
def guarded(path: PathLike, place: str | Callable[[], str]) -> Iterator[None]:
    """Turns whatever a library raises on a damaged file into `FormatError`.

    The operating system's own errors (no such file, no permission, full disk) pass.
    """
    try:
        yield
    except (FormatError, OptionMissing, ImportError, KeyboardInterrupt, SystemExit, GeneratorExit):
        raise
    except BaseException as error:  # noqa: BLE001  A Rust panic is not an Exception.
        if isinstance(error, OSError) and error.filename is not None:
            raise
        reason = " ".join(str(error).split())[:200] or type(error).__name__
        if isinstance(error, MemoryError):
            reason = "asks for more memory than there is"
        raise FormatError(path, place() if callable(place) else place, reason) from error


@contextlib.contextmanager
def written_whole(path: PathLike) -> Iterator[pathlib.Path]:
    """Yields a path of the same name in a private folder beside `path` and renames it to `path` at the end.

    If the block raises, nothing stands at `path` but what stood there before. A folder that exists
    is not replaced (`FileExistsError`).
    """
    target = pathlib.Path(path)
    if target.is_dir():
        raise FileExistsError(17, "exists; remove it or name another", str(target))
    private = pathlib.Path(tempfile.mkdtemp(prefix=".underbrush-", dir=target.parent))
    try:
        yield private / target.name
        os.replace(private / target.name, target)
    finally:
        shutil.rmtree(private, ignore_errors=True)


def size_of(path: PathLike) -> int:
    """Size of a file, or of all files in a folder, bytes."""
    root = pathlib.Path(path)
    files = [p for p in root.iterdir() if p.is_file()] if root.is_dir() else [root]
    return sum(p.stat().st_size for p in files)


def with_thousands(count: int) -> str:
    return f"{count:,}".replace(",", " ")
