"""Helpers of the readers and writers: damaged files, sizes, numbers."""
from __future__ import annotations

import contextlib
import pathlib
from collections.abc import Callable, Iterator
from typing import Any

import numpy.typing as npt

from ..errors import FormatError
from ..files import PathLike, need, written_whole

Array = npt.NDArray[Any]

__all__ = ["Array", "OptionMissing", "PathLike", "guarded", "need", "size_of", "with_thousands", "written_whole"]


class OptionMissing(ValueError):
    """A file lacks data that are needed; the text is one line that names the option to add."""


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
            reason = "needs more memory than there is"
        raise FormatError(path, place() if callable(place) else place, reason) from error


def size_of(path: PathLike) -> int:
    """Size of a file, or of all files in a folder, bytes."""
    root = pathlib.Path(path)
    files = [p for p in root.iterdir() if p.is_file()] if root.is_dir() else [root]
    return sum(p.stat().st_size for p in files)


def with_thousands(count: int) -> str:
    return f"{count:,}".replace(",", " ")
