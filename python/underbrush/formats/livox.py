"""Decoder of the point cloud packets of Livox's sensors, in Cartesian and in spherical coordinates.

A point without a return is a miss where its direction is known: spherical coordinates have it, Cartesian ones are
(0, 0, 0). Sources: those of `livox_packets`, and the maker's manual of the HAP.
"""
from __future__ import annotations

import collections
import itertools
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from underbrush.formats import catalogue
from underbrush.formats.clock import Clock
from underbrush.formats.livox_packets import (INERTIAL, NEW_VERSION, OLD_PULSE, OLD_VERSION, Layout, Packets,
                                              is_inertial, layout_of, seconds_of)
from underbrush.formats.returns import rows_of
from underbrush.formats.scans import Scan

Floats = npt.NDArray[np.float64]

_SCAN_S = 0.1  #: The sensors have no revolutions; a scan is as long as those of the maker's drivers.
_LATE = 5  #: A packet that comes so many scans late belongs to a clock that was set back.
_MOST_POINTS = 200_000  #: In a scan, where stamps stand still; the fastest sensor has 45 200 in 0.1 s.
_TRIPLE = (7, 8)  #: Kinds of version 5 that only the Avia sends.
_NO_DIRECTION = "points without a return, whose direction is not in the packets"


class Model(NamedTuple):
    """Facts about a sensor that its packets lack."""

    title: str
    sensor: str  #: Name in the catalogue; empty where it has none.
    points_per_s: float
    lines: int  #: Lasers, which take turns.
    version: int = OLD_VERSION  #: Of its packets.


_MID = Model("Livox sensor of 100 000 points/s (Mid-40, Mid-70)", "", 1e5, 1)
_PRISM = Model("Livox sensor of 240 000 points/s (Avia, Horizon, Tele-15)", "", 2.4e5, 6)
_AVIA = Model("Livox Avia", "livox-avia", 2.4e5, 6)
_MID360 = Model("Livox Mid-360", "livox-mid360", 2e5, 4, NEW_VERSION)
_HAP = Model("Livox HAP", "", 4.52e5, 6, NEW_VERSION)


def recognise(data: bytes) -> bool:
    """Whether a datagram is a point cloud packet of Livox."""
    return layout_of(data) is not None


def model_of(layout: Layout, points_per_s: float, sensor: str | None = None) -> Model:
    """The model with that rate of points, or the one named `sensor`. Raises ValueError where that is no Livox."""
    def fits(model: Model) -> bool:
        return model.version == layout.version and abs(points_per_s / model.points_per_s - 1) < 0.1

    found = next(filter(fits, (_MID, _PRISM, _MID360, _HAP)), Model("Livox sensor", "", points_per_s, 1))
    if layout.version == OLD_VERSION and layout.kind in _TRIPLE:
        found = _AVIA
    if sensor is None or sensor not in catalogue.names() or sensor == found.sensor:
        return found
    if sensor == _AVIA.sensor and fits(_AVIA):
        return _AVIA
    raise ValueError(f"sensor '{sensor}' does not send these packets, which are those of a {found.title}")


class Decoder:
    """Turns packets into scans of 0.1 s. Rows are in order of time, then of range."""

    def __init__(self, probe: list[bytes], captured_s: Floats, skipped: collections.Counter[str],
                 sensor: str | None = None, clock: str = "auto") -> None:
        """`probe` and `captured_s` are the first packets, from which the model follows, and their times of capture."""
        layouts = collections.Counter(layout_of(data) for data in probe)
        layouts.pop(None, None)
        layout = layouts.most_common(1)[0][0]
        assert layout is not None
        packets = _packets_of(layout, [data for data in probe if layout_of(data) == layout])
        self.model = model_of(layout, _points_per_s(layout, packets), sensor)
        self.sensor, self.title = self.model.sensor, self.model.title
        self.skipped, self.modes = skipped, set[str]()
        self.organised = not layout.is_cartesian
        self.packet_bytes = len(packets[0].tobytes())
        pulses = layout.version == OLD_VERSION and (packets["stamp_kind"] == OLD_PULSE).mean() > 0.5
        self.clock = Clock(1.0 if pulses else None, believed=clock)
        self._pending: list[_Points] = []
        self._begin_s: float | None = None
        self._window = 0.0  # The latest one; late packets belong to it.
        self._scans = 0

    def unfit(self, data: bytes) -> str:
        """Why a packet is not decoded; empty where it is."""
        layout = layout_of(data)
        if layout is not None and layout.is_cartesian != self.organised:
            return ""
        if layout is not None:
            return "packets of the other kind of coordinates"
        return INERTIAL if is_inertial(data) else "packets of another length"

    def decode(self, data: list[bytes], captured_s: Floats) -> Iterator[Scan]:
        """Yields the scans that end in n packets, which were captured at (n,) `captured_s`."""
        begin = 0
        for layout, group in itertools.groupby(data, layout_of):
            part = list(group)
            if layout is not None and layout.is_cartesian != self.organised:
                yield from self._cut(self._points(layout, part, captured_s[begin:begin + len(part)]))
            begin += len(part)

    def finish(self) -> Iterator[Scan]:
        """Yields the last scan."""
        if self._pending:
            yield self._scan()

    def found(self) -> list[str]:
        """Lines about clock and misses."""
        return [self.clock.found(), *([] if self.organised else [
            "misses: none, because the points have Cartesian coordinates, which are 0 where there is no return"])]

    def _points(self, layout: Layout, data: list[bytes], captured_s: Floats) -> _Points:
        """The points of packets of one layout."""
        packets = _packets_of(layout, data)
        self.modes.add(("single return", "dual return", "triple return")[layout.returns - 1])
        stamp_s = seconds_of(packets, layout.version)
        first_s = stamp_s + self.clock.shift(stamp_s, captured_s)
        step_s = np.full(len(packets), 1 / self.model.points_per_s)
        if layout.version == NEW_VERSION:
            step_s = packets["span"] * (1e-7 / layout.points)
        time_s = (first_s[:, None] + np.arange(layout.points) * step_s[:, None]).ravel()
        points = packets["points"].ravel()
        line = np.tile(np.arange(layout.points) % self.model.lines, len(packets))
        returns = points["returns"]
        if layout.is_cartesian:
            where = returns["xyz"].astype(np.float64)
            length = np.linalg.norm(where, axis=-1)
            with np.errstate(invalid="ignore"):
                direction = where / length[..., None]
        else:
            length = returns["depth"].astype(np.float64)
            zenith, azimuth = np.radians(points["zenith"] * 0.01), np.radians(points["azimuth"] * 0.01)
            one = np.stack([np.sin(zenith) * np.cos(azimuth), np.sin(zenith) * np.sin(azimuth), np.cos(zenith)], -1)
            one[(points["zenith"] == 0) & (points["azimuth"] == 0) & ~length.any(axis=1)] = np.nan
            direction = np.broadcast_to(one[:, None], (*length.shape, 3))
        tag = returns["tag"] if "tag" in (returns.dtype.names or ()) else np.zeros(length.shape, np.uint8)
        # A beam's directions of all returns; the one of a return that is absent is that of another one, or none.
        has_direction = np.isfinite(direction[..., 0])
        known = has_direction.any(axis=1)
        self.skipped[_NO_DIRECTION] += int((~known).sum())
        lacking = np.where(has_direction, np.arange(layout.returns), np.argmax(has_direction, axis=1)[:, None])
        direction = np.take_along_axis(direction, lacking[..., None], axis=1)
        return _Points(time_s[known], line[known].astype(np.uint16), direction[known], length[known] * layout.unit_m,
                       returns["reflectivity"][known], tag[known])

    def _cut(self, points: _Points) -> Iterator[Scan]:
        """Yields the scans that end before or in `points`; keeps the rest."""
        time_s = points.time_s
        if not len(time_s):
            return
        if self._begin_s is None:
            self._begin_s = float(time_s[0])
        latest = self._window
        window = np.floor((time_s - self._begin_s) / _SCAN_S)
        highest = np.maximum(np.maximum.accumulate(window), latest)
        back = np.flatnonzero(window < highest - _LATE)
        if len(back):  # The clock has gone back.
            yield from self._cut(_Points(*(column[:back[0]] for column in points)))
            yield from self.finish()
            self._window = float(window[back[0]])
            yield from self._cut(_Points(*(column[back[0]:] for column in points)))
            return
        window = highest
        self._window = float(window[-1])
        edges = [0, *(np.flatnonzero(np.diff(window)) + 1), len(time_s)]
        for begin, end in zip(edges[:-1], edges[1:]):
            part = _Points(*(column[begin:end] for column in points))
            if self._pending:
                last = self._pending[-1]
                held = sum(len(pending.time_s) for pending in self._pending)
                if (latest != window[begin]
                        or last.length_m.shape[1] != part.length_m.shape[1] or held > _MOST_POINTS):
                    yield self._scan()
            self._pending.append(part)
            latest = float(window[begin])

    def _scan(self) -> Scan:
        """The pending points as a scan."""
        joined = _Points(*map(np.concatenate, zip(*self._pending)))
        self._pending = []
        rows = rows_of(np.round(joined.length_m.T * 1e6).astype(np.uint64))
        beam = np.arange(len(joined.time_s))[rows.beam]
        hit = rows.echo > 0
        range_m = np.where(hit, joined.length_m[beam, rows.which], np.inf).astype(np.float32)
        intensity = np.where(hit, joined.reflectivity[beam, rows.which], 0).astype(np.float32)
        self._scans += 1
        return Scan(number=self._scans - 1, time_s=float(joined.time_s[0]),
                    direction=joined.direction[beam, rows.which], range_m=range_m,
                    beam_time_s=joined.time_s[beam], intensity=intensity, ring=joined.line[beam],
                    echo=rows.echo, echoes=rows.echoes, extra={"tag": joined.tag[beam, rows.which]})


class _Points(NamedTuple):
    """Beams in order of time, with all their returns."""

    time_s: Floats  #: (n,)
    line: npt.NDArray[np.uint16]  #: (n,)
    direction: Floats  #: (n, returns, 3)
    length_m: Floats  #: (n, returns); 0 is none.
    reflectivity: npt.NDArray[np.uint8]  #: (n, returns)
    tag: npt.NDArray[np.uint8]  #: (n, returns)


def _packets_of(layout: Layout, data: list[bytes]) -> npt.NDArray[Any]:
    packets: Packets = np.frombuffer(b"".join(data), dtype=layout.packet)
    return packets


def _points_per_s(layout: Layout, packets: Packets) -> float:
    """Points a second: of the header, or of the time between stamps; the usual ones if both are missing."""
    if layout.version == NEW_VERSION:
        span_s = float(np.median(packets["span"])) * 1e-7
        return layout.points / span_s if span_s > 0 else 2e5
    usual = 1e5 if layout.kind in (0, 1) else 2.4e5
    steps = np.diff(seconds_of(packets, layout.version))
    steps = steps[(steps > 0) & (steps < 0.01)]
    return layout.points / float(np.median(steps)) if len(steps) >= 8 else usual
