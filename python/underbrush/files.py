"""Optional libraries, and outputs that appear whole."""
from __future__ import annotations

import contextlib
import importlib
import os
import pathlib
import shutil
import tempfile
from collections.abc import Iterator
from typing import Any

PathLike = str | os.PathLike[str]


def need(module: str, extra: str = "formats") -> Any:
    """Imports a library of an extra. Raises `ImportError` with the command that installs it."""
    try:
        return importlib.import_module(module)
    except ImportError as error:
        name = module.partition(".")[0]
        raise ImportError(f"{name} is not installed: pip install 'underbrush[{extra}]'") from error


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
