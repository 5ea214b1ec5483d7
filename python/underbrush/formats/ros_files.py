"""The files of ROS recordings, as rosbags opens them."""
from __future__ import annotations

import contextlib
import pathlib
from collections.abc import Iterator
from typing import Any

from ..errors import FormatError
from ._files import guarded, need

_READERS = {"ros1": ("rosbag1", "Reader"), "mcap": ("rosbag2.storage_mcap", "McapReader"),
            "sqlite3": ("rosbag2.storage_sqlite3", "Sqlite3Reader"), "folder": ("rosbag2.reader", "DirectoryReader")}


def kind_of_bag(path: pathlib.Path) -> str:
    """"ros1", "mcap", "sqlite3", "folder" or "" by the content."""
    if path.is_dir():
        return "folder" if (path / "metadata.yaml").is_file() else ""
    with path.open("rb") as file:
        head = file.read(16)
    for kind, magic in (("ros1", b"#ROSBAG V"), ("mcap", b"\x89MCAP0\r\n"), ("sqlite3", b"SQLite format 3\0")):
        if head.startswith(magic):
            return kind
    return ""


@contextlib.contextmanager
def opened(path: pathlib.Path, kind: str) -> Iterator[Any]:
    """Yields rosbags' reader of a file of that kind, open, with `duration`, `start_time` and `end_time` (ns)."""
    if kind not in _READERS:
        raise FormatError(path, "", "is no ROS bag")
    module, name = _READERS[kind]
    with guarded(path, "open"):
        reader = getattr(need("rosbags." + module), name)(path)
        reader.open()
    try:
        for fact in ("duration", "start_time", "end_time"):
            if not hasattr(reader, fact):
                setattr(reader, fact, getattr(reader.metadata, fact))
        yield reader
    finally:
        reader.close()
