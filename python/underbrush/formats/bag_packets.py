"""Packets of sensors inside ROS recordings.

Their messages are VelodyneScan, PacketMsg of Ouster's drivers, PandarScan and UdpFrame of Hesai's, and NebulaPackets.
"""
from __future__ import annotations

import collections
import pathlib
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from ._files import PathLike, guarded
from .ouster_metadata import SIZES, Metadata
from .packets import PacketRecording
from .pcap import Datagram
from .velodyne import PACKET

STRING = "std_msgs/msg/String"
_LONGEST = 1500  #: Bytes of a packet of Hesai; Tier IV's PandarScan has as many for each packet.
_OUSTER_FRAME = "os_sensor"  # PacketMsg has no header; its driver calls the sensor's frame so.

#: Yields type, time (ns) and bytes of a topic's messages, and counts what it leaves out.
Messages = Callable[[str, "collections.Counter[str]"], Iterator[tuple[str, int, bytes]]]


def is_packets(msgtype: str) -> bool:
    """Whether messages of that type have packets that are decoded here."""
    package, _, name = msgtype.partition("/")
    name = name.rpartition("/")[2]
    return package == "velodyne_msgs" and name == "VelodyneScan" or name in ("PandarScan", "NebulaPackets") or (
        package.startswith("hesai") and name == "UdpFrame") or (
        name == "PacketMsg" and package.startswith(("ouster", "os1", "os_ros")))


class _Reader:
    """Reads the fields of a message one after the other. Raises `ValueError` where it is too short."""

    def __init__(self, raw: bytes, ros1: bool) -> None:
        self._raw, self._ros1 = raw, ros1
        self._at = 0 if ros1 else 4  # Four bytes of CDR give the byte order: little endian on all machines that record.

    def number(self) -> int:
        return int.from_bytes(self.part(4, 4), "little")

    def peek(self) -> int:
        """The next number, which is read again."""
        at = self._at
        value, self._at = self.number(), at
        return value

    def part(self, size: int, step: int = 1) -> bytes:
        """The next bytes; the field after them begins at a multiple of `step` in ROS 2."""
        begin, self._at = self._at, self._at + size
        if self._at > len(self._raw):
            raise ValueError("too short for its packets")
        if not self._ros1 and step > 1:
            self._at = 4 + (self._at - 4 + step - 1) // step * step
        return bytes(self._raw[begin:begin + size])


def packets_in(msgtype: str, raw: bytes, bag_s: float, ros1: bool, own_clock: bool) -> tuple[list[Datagram], str]:
    """The packets of a message with the times (s) at which they came, and the sensor's frame.

    `bag_s` is the time of the recording: that of an Ouster's packet, and with `own_clock` of a message of several
    packets, which keep their intervals. Raises `ValueError` where the message is too short.
    """
    message, name = _Reader(raw, ros1), msgtype.rpartition("/")[2]
    if name == "PacketMsg":
        data = message.part(message.number())
        # The first drivers gave a byte more than the packet has.
        return [Datagram(bag_s, b"", 0, data[:-1] if len(data) - 1 in SIZES else data)], _OUSTER_FRAME
    message.part(12 if ros1 else 8)  # Number and stamp of the scan.
    frame = message.part(message.number(), 4).rstrip(b"\0").decode(errors="replace")
    packets = []
    for _ in range(message.number()):
        stamp_s = message.number() + message.number() * 1e-9
        packets.append(Datagram(stamp_s, b"", 0, _data_of(message, name)))
    if own_clock and packets:
        packets = [packet._replace(time_s=bag_s + packet.time_s - packets[-1].time_s) for packet in packets]
    return packets, frame


def _data_of(message: _Reader, name: str) -> bytes:
    """The next packet of a message of that type."""
    if name == "VelodyneScan":
        return message.part(PACKET.itemsize, 4)
    # Tier IV's PandarScan has a fixed length instead of a number before the data, whose first bytes are no small one.
    if name == "PandarScan" and message.peek() > _LONGEST:
        data = message.part(_LONGEST, 4)
    else:
        data = message.part(message.number(), 4)
    return data if name == "NebulaPackets" else data[:message.number()]


class _Packets:
    """The packets of a topic, as a capture gives them."""

    def __init__(self, recording: BagPackets) -> None:
        self._of = recording
        self.skipped: collections.Counter[str] = collections.Counter()
        self.bytes_done = 0

    def datagrams(self) -> Iterator[Datagram]:
        """Yields the packets in order."""
        source, ros1, own = self._of.topic.encode(), self._of.ros1, self._of.own_clock
        for kind, time_ns, raw in self._of.messages(self._of.topic, self.skipped):
            try:
                packets, _ = packets_in(kind, raw, time_ns * 1e-9, ros1, own)
            except ValueError:
                self.skipped["messages that cannot be read"] += 1
                continue
            for packet in packets:
                yield packet._replace(source=source, port=-1)


class BagPackets(PacketRecording):
    """The packets of a topic of a ROS recording, decoded as those of a capture are.

    An Ouster's metadata are those given, those beside the recording, or those of its topic with the metadata: the one
    of the packets' namespace, or the only one.
    """

    def __init__(self, path: PathLike, topic: str, messages: Messages, ros1: bool, texts: list[str],
                 metadata: PathLike | None = None, sensor: str | None = None, own_clock: bool = False) -> None:
        self.topic, self.messages, self.ros1, self.own_clock = topic, messages, ros1, own_clock
        places = [text for text in texts if text.rpartition("/")[2] == "metadata"]
        beside = [text for text in places if text.rpartition("/")[0] == topic.rpartition("/")[0]]
        self._text = (beside or places)[0] if beside or len(places) == 1 else ""
        super().__init__(pathlib.Path(path), metadata=None if metadata is None else pathlib.Path(metadata),
                         sensor=sensor, clock="capture" if own_clock else "auto")

    def _captured(self) -> Any:
        return _Packets(self)

    def _metadata_inside(self) -> tuple[Metadata | None, str]:
        for _, _, raw in self.messages(self._text, collections.Counter()) if self._text else ():
            at = 0 if self.ros1 else 4
            size = int(np.frombuffer(raw, "<u4", 1, at)[0]) if len(raw) >= at + 4 else 0
            with guarded(self.path, self._text):
                text = raw[at + 4:at + 4 + size].rstrip(b"\0").decode()
            return Metadata.of_text(text, f"{self.path}: {self._text}"), self._text
        return None, ""
