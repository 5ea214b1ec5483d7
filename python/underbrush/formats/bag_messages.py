"""The messages of ROS recordings, also of damaged ones and of those that were not closed."""
from __future__ import annotations

import collections
import contextlib
import datetime
import pathlib
import tempfile
from collections.abc import Callable, Iterator
from typing import Any

from ..errors import FormatError
from ._files import guarded
from .bag_packets import is_packets
from .ros_files import is_cut_mcap, kind_of_bag, opened, recover_mcap

_MOST_BREAKS = 1000


class BagMessages:
    """The topics of a recording and their messages."""

    def __init__(self, path: pathlib.Path) -> None:
        self.path, self.kind, self.recovered = path, kind_of_bag(path), 0
        self._source = path
        if self.kind == "mcap" and is_cut_mcap(path):
            self._scratch = tempfile.TemporaryDirectory(prefix="underbrush-")
            self._source = pathlib.Path(self._scratch.name) / "recovered.mcap"
            self.recovered = recover_mcap(path, self._source)
        with self.opened() as reader, guarded(path, "index"):
            #: Name, type and number of messages of each topic.
            self.topics = sorted(
                ((str(c.topic), str(c.msgtype), int(c.msgcount)) for c in reader.connections), key=lambda c: c[0])
            self.duration_s = max(0.0, float(reader.duration) * 1e-9)
            self.start = _date(int(reader.start_time))

    @property
    def is_ros1(self) -> bool:
        return self.kind == "ros1"

    def opened(self) -> contextlib.AbstractContextManager[Any]:
        """The reader that `of` takes."""
        return opened(self._source, self.kind)

    def kind_of(self, topic: str) -> str:
        """The type of a topic's messages."""
        return next(kind for name, kind, _ in self.topics if name == topic)

    def of(self, reader: Any, topic: str, skipped: collections.Counter[str]) -> Iterator[tuple[str, int, bytes]]:
        """Type, time (ns) and bytes of a topic's messages. A part of the file that cannot be read is left out."""
        for connection in [c for c in reader.connections if c.topic == topic]:
            start, step = None, 1_000_000
            end = int(reader.end_time)
            for _ in range(_MOST_BREAKS):
                try:
                    with guarded(self.path, "messages"):
                        for found, time_ns, raw in reader.messages([connection], start=start):
                            yield str(found.msgtype), int(time_ns), raw
                            start, step = int(time_ns), 1_000_000
                    break
                except FormatError:
                    skipped["breaks in the file"] += 1
                    start = (int(reader.start_time) if start is None else start) + step
                    step *= 2
                    if start >= end:
                        break

    def all_of(self, topic: str, skipped: collections.Counter[str], report: Callable[[float], None]
               ) -> Iterator[tuple[str, int, bytes]]:
        """Does so for a whole topic, reports the share that is read, and counts what the file lacks."""
        total, seen = sum(n for name, _, n in self.topics if name == topic), 0
        with self.opened() as reader:
            for message in self.of(reader, topic, skipped):
                seen += 1
                report(min(1.0, seen / max(1, total)))
                yield message
        if seen < total:
            skipped["messages in parts of the file that cannot be read"] += total - seen

    def no_packets(self) -> str:
        """What a recording without a readable topic has of packets."""
        decoded = [f"{topic} ({kind})" for topic, kind, n in self.topics if n and is_packets(kind)]
        if decoded:
            return f", and no packet of a lidar in {', '.join(decoded)}"
        others = [f"{topic} ({kind})" for topic, kind, n in self.topics
                  if n and ("packet" in kind.lower() or kind.endswith(("/PandarScan", "/UdpFrame")))]
        return (f", but packets of a kind that is not decoded, in {', '.join(others)}: have the driver write its point "
                "clouds" if others else self.only({"LaserScan"}))

    def only(self, kinds: set[str]) -> str:
        """Names the topics of these kinds of messages, which are not read; "" where there are none."""
        found = [f"{topic} ({kind})" for topic, kind, n in self.topics if n and kind.rpartition("/")[2] in kinds]
        return f", and {', '.join(found[:6])} {'is' if len(found) == 1 else 'are'} not read" if found else ""


def _date(time_ns: int) -> str:
    """" from DATE" of a recording's beginning; empty where the clock counts from something else."""
    if not 10**18 < time_ns < 4 * 10**18:
        return ""
    date = datetime.datetime.fromtimestamp(time_ns // 10**9, datetime.timezone.utc)
    return date.strftime(" from %Y-%m-%d %H:%M:%S UTC")
