"""The files of ROS recordings, as rosbags opens them."""
from __future__ import annotations

import bz2
import contextlib
import pathlib
import re
import tempfile
from collections.abc import Callable, Iterator
from typing import Any

from ..errors import FormatError
from ._files import guarded, need

_MOST_CHUNK = 256 << 20  # bytes of a chunk of a bag of ROS 1, of which recorders make less than 1 MiB
_MCAP = b"\x89MCAP0\r\n"
_READERS = {"ros1": ("rosbag1", "Reader"), "mcap": ("rosbag2.storage_mcap", "McapReader"),
            "sqlite3": ("rosbag2.storage_sqlite3", "Sqlite3Reader"), "folder": ("rosbag2.reader", "DirectoryReader")}


def kind_of_bag(path: pathlib.Path) -> str:
    """"ros1", "mcap", "sqlite3", "folder" or "" by the content."""
    if path.is_dir():
        return "folder" if (path / "metadata.yaml").is_file() else ""
    with path.open("rb") as file:
        head = file.read(16)
    for kind, magic in (("ros1", b"#ROSBAG V"), ("mcap", _MCAP), ("sqlite3", b"SQLite format 3\0")):
        if head.startswith(magic):
            return kind
    return ""


def is_cut_mcap(path: pathlib.Path) -> bool:
    """Whether an MCAP file has no end, as when the recorder dies."""
    with path.open("rb") as file:
        file.seek(max(0, path.stat().st_size - len(_MCAP)))
        return file.read() != _MCAP


def recover_mcap(path: pathlib.Path, target: pathlib.Path) -> int:
    """Writes the whole messages of an MCAP file without an end to another one, and returns their number.

    Raises `FormatError` where there is none.
    """
    records, reading, writing = need("mcap.records"), need("mcap.stream_reader"), need("mcap.writer")
    schemas: dict[int, int] = {}
    channels: dict[int, int] = {}
    count = 0
    with path.open("rb") as source, target.open("wb") as stream:
        writer = writing.Writer(stream)
        started = False
        with contextlib.suppress(FormatError), guarded(path, "records"):  # What is behind the cut is lost.
            for record in reading.StreamReader(source).records:
                if isinstance(record, records.Header):
                    writer.start(profile=record.profile, library=record.library)
                    started = True
                elif isinstance(record, records.Schema):
                    schemas[record.id] = writer.register_schema(record.name, record.encoding, record.data)
                elif isinstance(record, records.Channel):
                    channels[record.id] = writer.register_channel(
                        record.topic, record.message_encoding, schemas.get(record.schema_id, 0), record.metadata)
                elif isinstance(record, records.Message) and record.channel_id in channels:
                    writer.add_message(channels[record.channel_id], record.log_time, record.data, record.publish_time,
                                       record.sequence)
                    count += 1
        if started:
            writer.finish()
    if not count:
        raise FormatError(path, "end", "no footer and no whole message: the recording was not closed")
    return count


def _unpacked(packed: bytes, new: Callable[[], Any]) -> bytes:
    """The content of a chunk, a frame or stream after the other. Raises `ValueError` beyond `_MOST_CHUNK`."""
    out = bytearray()
    while packed:
        one = new()
        out += one.decompress(packed, max_length=_MOST_CHUNK + 1 - len(out))
        if len(out) > _MOST_CHUNK:
            raise ValueError(f"a chunk of {len(packed)} bytes unpacks to more than {_MOST_CHUNK >> 20} MiB")
        if not one.eof:
            raise ValueError("a chunk ends within its compressed data")
        packed = one.unused_data or b""
    return bytes(out)


def _bounded(unpack: Callable[[bytes], bytes]) -> Callable[[bytes], bytes]:
    """Bounds how much a chunk unpacks to; one that failed is not tried again for each of its messages."""
    new: Callable[[], Any]
    if unpack is bz2.decompress:
        new = bz2.BZ2Decompressor
    elif unpack is need("lz4.frame").decompress:
        new = need("lz4.frame").LZ4FrameDecompressor
    else:
        return unpack
    failure: Exception | None = None

    def bounded(packed: bytes) -> bytes:
        nonlocal failure
        if failure is None:
            try:
                return _unpacked(packed, new)
            except Exception as error:  # noqa: BLE001  Whatever a library raises on damage.
                failure = error
        raise failure

    return bounded


@contextlib.contextmanager
def _with_formats(path: pathlib.Path, kind: str) -> Iterator[pathlib.Path]:
    """Yields the path, or a folder with links to its files whose metadata name the formats.

    A recorder may leave both names empty. ROS then tries its plug-ins, but rosbags refuses the folder.
    """
    if kind != "folder":
        yield path
        return
    metadata = (path / "metadata.yaml").read_text(encoding="utf-8", errors="replace")
    storage = "mcap" if re.search(r"\.mcap(\.zstd)?[\"']? *$", metadata, re.MULTILINE) else "sqlite3"
    named = metadata
    for key, name in (("storage_identifier", storage), ("serialization_format", "cdr")):
        named = re.sub(rf"""^([ -]*{key}:) *(?:""|'')? *$""", rf"\1 {name}", named, flags=re.MULTILINE)
    if named == metadata:
        yield path
        return
    with tempfile.TemporaryDirectory() as folder:
        for file in path.iterdir():
            (pathlib.Path(folder) / file.name).symlink_to(file.absolute())
        (pathlib.Path(folder) / "metadata.yaml").unlink()
        (pathlib.Path(folder) / "metadata.yaml").write_text(named, encoding="utf-8")
        yield pathlib.Path(folder)


@contextlib.contextmanager
def opened(path: pathlib.Path, kind: str) -> Iterator[Any]:
    """Yields rosbags' reader of a file of that kind, open, with `duration`, `start_time` and `end_time` (ns)."""
    if kind not in _READERS:
        raise FormatError(path, "", "is no ROS bag")
    module, name = _READERS[kind]
    with contextlib.ExitStack() as stack:
        with guarded(path, "open"):
            place = stack.enter_context(_with_formats(path, kind))
            reader = getattr(need("rosbags." + module), name)(place)
            try:
                reader.open()
            except Exception as error:  # noqa: BLE001  Whatever a library raises may name the folder of links.
                if place == path:
                    raise
                raise FormatError(path, "open", " ".join(str(error).replace(str(place), str(path)).split())) from error
            stack.callback(reader.close)
            if kind == "folder":  # The files themselves may not name the format of the messages.
                facts = {(c.topic, c.msgtype): c.ext for c in reader.connections}
                for storage in reader.storages:
                    storage.connections = [c._replace(ext=facts.get((c.topic, c.msgtype), c.ext))
                                           for c in storage.connections]
            if kind == "ros1":
                reader.chunks = {at: chunk._replace(decompressor=_bounded(chunk.decompressor))
                                 for at, chunk in reader.chunks.items()}
        for fact in ("duration", "start_time", "end_time"):
            if not hasattr(reader, fact):
                setattr(reader, fact, getattr(reader.metadata, fact))
        yield reader
