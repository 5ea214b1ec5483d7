"""OSI traces: `.osi` files (messages behind their lengths) and MCAP files, in both directions.

A trace of one kind of messages in MCAP has one channel with the schema of that kind, whose topic is the name of the
kind, and the metadata record `net.asam.osi.trace`. Messages stay as they are, byte for byte.
"""
from __future__ import annotations

import datetime
import pathlib
import re
import struct
from collections.abc import Iterator
from typing import Any, BinaryIO

from ..errors import FormatError
from ._files import OptionMissing, PathLike, guarded, need, written_whole

#: Kinds of messages by the code in the name of an `.osi` file, with their modules in `osi3`.
KINDS = {"sv": ("SensorView", "sensorview"), "sd": ("SensorData", "sensordata"), "gt": ("GroundTruth", "groundtruth"),
         "svc": ("SensorViewConfiguration", "sensorviewconfiguration"), "tc": ("TrafficCommand", "trafficcommand"),
         "tu": ("TrafficUpdate", "trafficupdate"), "hvd": ("HostVehicleData", "hostvehicledata"),
         "mr": ("MotionRequest", "motionrequest"), "su": ("StreamingUpdate", "streamingupdate")}
METADATA = "net.asam.osi.trace"
_MOST_BYTES = 1 << 30  # Of a message; the writers of protobuf stop at 2 GiB.


def read_osi(path: PathLike) -> Iterator[bytes]:
    """Yields the messages of an `.osi` file. Raises `FormatError` where it is cut off, and `OSError`."""
    with pathlib.Path(path).open("rb") as stream:
        number = 0
        while head := stream.read(4):
            size = struct.unpack("<I", head)[0] if len(head) == 4 else _MOST_BYTES + 1
            if size > _MOST_BYTES:
                raise FormatError(path, f"message {number + 1}", "truncated, or an absurd length")
            data = stream.read(size)
            if len(data) != size:
                raise FormatError(path, f"message {number + 1}", "truncated")
            yield data
            number += 1


def read_mcap(path: PathLike, topic: str | None = None) -> Iterator[bytes]:
    """Yields the OSI messages of a channel of an MCAP file, in the order of the file.

    Without `topic` there must be one channel of OSI messages (`OptionMissing` where there are several). Raises
    `FormatError` for damaged files and those without such a channel, `ImportError` without mcap, and `OSError`.
    """
    reading = need("mcap.reader")
    with pathlib.Path(path).open("rb") as stream:
        with guarded(path, "header"):
            reader = reading.make_reader(stream, validate_crcs=True)
            topics = _osi_topics(reader, stream, reading)
        if not topics:
            raise FormatError(path, "", "has no channel of OSI messages")
        if topic is None and len(topics) > 1:
            raise OptionMissing(f"{path}: several channels of OSI messages ({', '.join(topics)}): name one as topic")
        if topic is not None and topic not in topics:
            raise FormatError(path, "", f"has no channel of OSI messages '{topic}'; it has {', '.join(topics)}")
        number, wanted = 0, topic or topics[0]
        with guarded(path, lambda: f"message {number + 1}"):
            for schema, channel, message in reader.iter_messages(log_time_order=False):
                if channel.topic == wanted and schema is not None and schema.name.startswith("osi3."):
                    yield bytes(message.data)
                    number += 1


def _osi_topics(reader: Any, stream: BinaryIO, reading: Any) -> list[str]:
    """The topics with schemas of OSI; a file without a summary is read once for them."""
    summary = reader.get_summary()
    pairs: Any
    if summary is not None and summary.channels:
        pairs = [(summary.schemas.get(c.schema_id), c) for c in summary.channels.values()]
    else:
        stream.seek(0)
        pairs = [(schema, channel) for schema, channel, _ in
                 reading.make_reader(stream).iter_messages(log_time_order=False)]
        stream.seek(0)
    found = [channel.topic for schema, channel in pairs if schema is not None and schema.name.startswith("osi3.")]
    return list(dict.fromkeys(found))


def kind_of_trace(path: PathLike) -> str:
    """The kind of messages in the name of an `.osi` file, such as "SensorView", or "" if the name has none."""
    codes = [code for code in re.split(r"[_.]", pathlib.Path(path).name.lower())[:-1] if code in KINDS]
    return KINDS[codes[0]][0] if codes else ""


def _fields(data: bytes) -> Iterator[tuple[int, int | bytes]]:
    """Yields the first fields of a message: tags with whole numbers or bytes."""
    at = 0

    def varint() -> int:
        nonlocal at
        value = shift = 0
        while shift < 70:
            byte = data[at]
            at += 1
            value |= (byte & 0x7F) << shift
            if byte < 0x80:
                return value
            shift += 7
        raise ValueError("a number that is too long")

    while at < len(data):
        key = varint()
        if key & 7 == 0:
            yield key >> 3, varint()
        elif key & 7 == 2:
            size = varint()
            if size > len(data) - at:
                raise ValueError("truncated")
            at += size
            yield key >> 3, data[at - size:at]
        elif key & 7 in (1, 5):
            at += 8 if key & 7 == 1 else 4
        else:
            raise ValueError("a field of an unknown type")


def _head(data: bytes) -> tuple[str, int]:
    """The version ("" if it is absent) and the time (ns) of a message; all kinds have them in the fields 1 and 2."""
    parts: dict[int, dict[int, int]] = {1: {}, 2: {}}
    for tag, value in _fields(data):
        if tag in parts and isinstance(value, bytes):
            parts[tag].update((t, v) for t, v in _fields(value) if isinstance(v, int))
        if tag > 2:
            break  # Fields stand in the order of their numbers.
    version = ".".join(str(parts[1].get(t, 0)) for t in (1, 2, 3)) if parts[1] else ""
    return version, parts[2].get(1, 0) * 1_000_000_000 + parts[2].get(2, 0)


def _schema(kind: str) -> bytes:
    """The encoded FileDescriptorSet of a kind of messages."""
    module = {name: module for name, module in KINDS.values()}[kind]
    message = getattr(need(f"osi3.osi_{module}_pb2"), kind)
    files: dict[str, Any] = {}

    def add(file: Any) -> None:
        for other in file.dependencies:
            add(other)
        files.setdefault(file.name, file)

    add(message.DESCRIPTOR.file)
    out = need("google.protobuf.descriptor_pb2").FileDescriptorSet()
    for file in files.values():
        file.CopyToProto(out.file.add())
    return bytes(out.SerializeToString(deterministic=True))


def osi_to_mcap(source: PathLike, target: PathLike, *, kind: str = "", description: str = "") -> int:
    """Writes an `.osi` trace as MCAP and returns the number of messages.

    `kind` names the messages ("SensorView"); without it, the kind is that in the name of `source` (`OptionMissing` if
    the name has none). `description` goes to the metadata. The target appears whole or not at all. Raises `FormatError`
    for damaged traces, `ImportError` without mcap and osi-python, and `OSError`.
    """
    kind = kind or kind_of_trace(source)
    if kind not in {name for name, _ in KINDS.values()}:
        raise OptionMissing(f"{source}: the kind of messages is not in its name: give kind, such as SensorView")
    writing, protobuf = need("mcap.writer"), need("google.protobuf")
    count = 0
    with written_whole(target) as path, path.open("wb") as stream:
        writer = writing.Writer(stream)
        writer.start(profile="", library="underbrush")
        channel = 0
        for data in read_osi(source):
            with guarded(source, f"message {count + 1}"):
                version, time_ns = _head(data)
            if count == 0:
                metadata = {"version": "1.0.0", "min_osi_version": version, "max_osi_version": version,
                            "min_protobuf_version": protobuf.__version__, "max_protobuf_version": protobuf.__version__,
                            "zero_time": datetime.datetime.fromtimestamp(0, datetime.timezone.utc).isoformat(),
                            "description": description}
                writer.add_metadata(METADATA, metadata)
                schema = writer.register_schema(f"osi3.{kind}", "protobuf", _schema(kind))
                channel = writer.register_channel(kind, "protobuf", schema, {
                    f"{METADATA}.channel.osi_version": version,
                    f"{METADATA}.channel.protobuf_version": protobuf.__version__})
            writer.add_message(channel, log_time=time_ns, publish_time=time_ns, sequence=count, data=data)
            count += 1
        writer.finish()
        if count == 0:
            raise FormatError(source, "", "holds no message")
    return count


def mcap_to_osi(source: PathLike, target: PathLike, *, topic: str | None = None) -> int:
    """Writes a channel of OSI messages of an MCAP file as `.osi` trace and returns the number of messages.

    `topic` and errors are those of `read_mcap`. The target appears whole or not at all.
    """
    count = 0
    with written_whole(target) as path, path.open("wb") as stream:
        for data in read_mcap(source, topic):
            stream.write(struct.pack("<I", len(data)) + data)
            count += 1
        if count == 0:
            raise FormatError(source, "", "holds no message")
    return count
