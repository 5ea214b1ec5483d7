"""Decoder of Hesai's point cloud packets, of the models in `MODELS`.

Angles, times and the start of a revolution are those of the sensor catalogue where it has the model; `MODELS` has what
the catalogue lacks. A block's azimuth is that of the rotor at the time that firing times count from, and a laser's is
the rotor's at its own time. Those of an AT128, whose mirror spins, follow from its correction file. In each firing, a
QT128, a Pandar128 or an OT128 fires only some of its channels; a file of firing times has these and their times. Those
of an OT128 are those of the maker's driver; Nebula's are 43 µs later. Sources: those of `hesai_packets`.
"""
from __future__ import annotations

import collections
import dataclasses
import pathlib
from collections.abc import Iterator
from typing import Any

import numpy as np
import numpy.typing as npt

from underbrush.formats import catalogue
from underbrush.formats.clock import Clock
from underbrush.formats.hesai_calibration import FiringTimes, read_angles, read_unit
from underbrush.formats.hesai_mirror import MirrorAngles, Sweeps
from underbrush.formats.hesai_packets import (AT128, MODES, PANDAR40, PANDAR64, PANDAR128, QT64, QT128, SELF_DEFINED, XT,
                                              Layout, layout_of, seconds_of)
from underbrush.formats.rotation import Rotation, firing_period
from underbrush.formats.scans import Scan
from underbrush.formats.spinning import Firings, Revolutions
from underbrush.formats.velodyne_calibration import Calibration

Floats = npt.NDArray[np.float64]
Packets = npt.NDArray[Any]  #: Of `Layout.packet`.

_START_DEG = 270.0  #: Revolutions begin at the maker's y axis, from which azimuths count; here they count from x.
#: Pandar40P: times of the lasers before the end of a firing, µs.
_PANDAR40_US = (42.22, 28.47, 16.04, 3.62, 45.49, 31.74, 47.46, 54.67, 20.62, 33.71, 40.91, 8.19, 20.62, 27.16, 50.73,
                8.19, 14.74, 36.98, 45.49, 52.70, 23.89, 31.74, 38.95, 11.47, 18.65, 25.19, 48.76, 6.23, 12.77, 35.01,
                21.92, 9.50, 43.52, 29.77, 17.35, 4.92, 42.22, 28.47, 16.04, 3.62)


@dataclasses.dataclass(frozen=True)
class Model:
    """What the packets of a model have besides its sensor file. Channels fire in another order than they are sent."""

    title: str
    protocol: tuple[int, int]
    lasers: int
    blocks: tuple[int, ...]  #: Numbers of blocks in a packet.
    stamp_us: float  #: Time of the packet's last firing, or its first one (`stamps_first`), after the packet's stamp.
    azimuth_us: float  #: Time of a firing after the time at which the rotor has the block's azimuth.
    sensor: str = ""  #: Name in the catalogue; empty where it has none.
    like: tuple[str, int] = ("", 1)  #: Sensor of the catalogue of whose channels every nth is one of this model.
    period_us: float = 50.0  #: Time of a firing; a Pandar128 takes twice as long in all modes but the first.
    laser_us: tuple[float, ...] = ()  #: Times of the channels after the first laser, where the catalogue has none.
    stamps_first: bool = False  #: Whether the stamp counts from the packet's first firing.
    has_codes: bool = False  #: Whether ranges of 1 to 3 steps are codes: too close twice, and no return.
    times: str = ""  #: Kind of the file that has the times of the channels (`FiringTimes.kind`), where one is needed.


MODELS = (
    Model("Hesai Pandar40P", PANDAR40, 40, (10,), -28.58 - 54.67, -54.67, period_us=55.56,
          laser_us=tuple(54.67 - time for time in _PANDAR40_US)),
    Model("Hesai Pandar64", PANDAR64, 64, (6, 7), -42.58 - 54.668, -54.668, "hesai-pandar64", ("hesai-pandar64", 1),
          55.56),
    Model("Hesai PandarXT-32", XT, 32, (8,), 6.0, 0.368, "hesai-xt32", ("hesai-xt32", 1)),
    Model("Hesai PandarXT-16", XT, 16, (8,), 6.0, 0.368, like=("hesai-xt32", 2)),
    Model("Hesai XT32M2X", XT, 32, (6,), 6.0, 0.368, laser_us=tuple(2.888 * (k % 16) for k in range(32))),
    Model("Hesai QT64", QT64, 64, (4,), 25.71, 0.0, period_us=500 / 3, stamps_first=True,
          laser_us=tuple(2.31 + 34.297 * (k // 16) + 16.85 * (k // 8 % 2) + 2.057 * (k % 8) for k in range(64))),
    Model("Hesai QT128", QT128, 128, (2,), 9.0, 0.0, period_us=111.11, stamps_first=True, times="loops"),
    Model("Hesai Pandar128", PANDAR128, 128, (2,), 3.148, 0.0, period_us=27.778, times="states"),
    Model("Hesai OT128", PANDAR128, 128, (2,), 0.0, 0.0, period_us=27.778, times="states, OT128",
          has_codes=True),
    Model("Hesai AT128", AT128, 128, (2,), -9.249 - 41.666, 0.0, "hesai-at128", ("hesai-at128", 1), 41.666),
)


def recognise(data: bytes) -> bool:
    """Whether a datagram is a point cloud packet of Hesai."""
    return layout_of(data) is not None


def model_of(layout: Layout, sensor: str | None = None, times: str = "") -> Model:
    """The model that sends such packets. Raises ValueError where it is not known, or not `sensor`.

    Models whose packets are alike are distinguished by the kind of their firing times.
    """
    alike = [model for model in MODELS if model.protocol == layout.protocol and model.lasers == layout.lasers
             and layout.blocks in model.blocks]
    found = next((model for model in alike if model.times == times), alike[0] if alike else None)
    if found is not None and not times and len(alike) > 1:
        found = dataclasses.replace(found, title=alike[0].title + "".join(
            f" or {model.title.removeprefix('Hesai ')}" for model in alike[1:]))
    if found is None:
        raise ValueError(f"packets of Hesai's protocol {layout.protocol[0]}.{layout.protocol[1]} with {layout.lasers} "
                         f"channels and {layout.blocks} blocks are not decoded; have the driver write its point clouds")
    if sensor is not None and sensor != found.sensor and sensor in catalogue.names():
        raise ValueError(f"sensor '{sensor}' does not send these packets, which are those of a {found.title}")
    return found


class Decoder:
    """Turns packets into scans, one a revolution. Partial revolutions at the ends and at gaps are scans, too.

    Rows are in order of firing. A Pandar128's packets in another mode of firing than the first ones are left out and
    counted. Raises ValueError where the model is not known or its angles or firing times are missing, and FormatError
    and OSError for its files.
    """

    organised = True

    def __init__(self, probe: list[bytes], captured_s: Floats, skipped: collections.Counter[str],
                 sensor: str | None = None, correction: pathlib.Path | None = None, clock: str = "auto") -> None:
        """`probe` and `captured_s` are the first packets, from which the model follows, and their times of capture.

        `correction` is the unit's file of angles, or a folder with it and the file of firing times.
        """
        layouts = collections.Counter(layout_of(data) for data in probe)
        layouts.pop(None, None)
        layout = layouts.most_common(1)[0][0]
        assert layout is not None
        angle_file, times = (None, None) if correction is None else read_unit(correction)
        self.layout, self.model = layout, model_of(layout, sensor, times.kind if times else "")
        self.sensor, self.title = self.model.sensor, self.model.title
        self.skipped, self.modes = skipped, set[str]()
        self.clock = Clock(believed=clock)
        first = [k for k, data in enumerate(probe) if layout_of(data) == layout]
        self.packet_bytes = len(probe[first[0]])
        packets = self._packets([probe[k] for k in first])

        self.source = "" if correction is None else str(correction)
        self._slow = self._is_slow(packets)
        laser_s = self._times(times)
        period_s = self.model.period_us * 1e-6 * (2 if self._slow else 1)
        order = np.argsort(laser_s[0], kind="stable")
        self._order: npt.NDArray[np.intp] = order
        steps = np.diff(self._stamps(packets))
        returns = MODES.get(collections.Counter(packets["tail"]["mode"].tolist()).most_common(1)[0][0], (1, ""))[0]
        self._period_s, self.stamped = firing_period(
            steps, captured_s[first], max(1, layout.blocks // returns), period_s)
        angles: Calibration | MirrorAngles
        if layout.protocol == AT128:
            angles = MirrorAngles.read(self._needed(angle_file), order)
            self._rotation: Rotation | Sweeps = Sweeps(angles.start_deg)
        else:
            elevation, azimuth = self._angles(angle_file)
            angles = Calibration.nominal(elevation[order], azimuth[order], np.zeros(len(order)))
            self._rotation = Rotation(_START_DEG, self._period_s)
        self._fires = np.isfinite(laser_s[:, order])
        self._revolutions = Revolutions(angles, order, laser_s[:, order] * (self._period_s / period_s), self._period_s,
                                        layout.unit_mm * 0.001)

    def unfit(self, data: bytes) -> str:
        """Why a packet is not decoded; empty where it is."""
        return "" if len(data) in self.layout.sizes else "packets of another length"

    def decode(self, packets: list[bytes], captured_s: Floats) -> Iterator[Scan]:
        """Yields the scans that end in the n `packets`, which were captured at (n,) `captured_s`."""
        differences = [self.layout.difference(layout_of(data)) for data in packets]
        self.skipped.update(filter(None, differences))
        same = [not difference for difference in differences]
        whole = self._packets([data for data, keep in zip(packets, same) if keep])
        returns = np.array([MODES.get(mode, (0, ""))[0] for mode in range(256)])[whole["tail"]["mode"]]
        keep = (returns > 0) & (self.layout.blocks % np.maximum(returns, 1) == 0)
        self.skipped["packets with an unknown return mode"] += int((returns == 0).sum())
        self.skipped["packets whose number of blocks does not fit their return mode"] += int((returns[~keep] > 0).sum())
        whole, returns, captured_s = whole[keep], returns[keep], captured_s[same][keep]
        self.modes |= {MODES[mode][1] for mode in np.unique(whole["tail"]["mode"]).tolist()}
        edges = [0, *(np.flatnonzero(np.diff(returns)) + 1), len(whole)]
        for begin, end in zip(edges[:-1], edges[1:]):
            if end > begin:
                part = self._firings(whole[begin:end], captured_s[begin:end], int(returns[begin]))
                yield from self._revolutions.cut(part)

    def finish(self) -> Iterator[Scan]:
        """Yields the last scan."""
        yield from self._revolutions.finish()

    def found(self) -> list[str]:
        """Lines about clock and angles."""
        lines = [self.clock.found() if self.stamped else "clock: the capture's, because the packets have no stamps"]
        usual = "those of the design; --metadata CORRECTION.csv gives those of the unit"
        return [*lines, f"angles: {self.source or usual}"]

    def _packets(self, packets: list[bytes]) -> Packets:
        size = self.layout.packet.itemsize
        return np.frombuffer(b"".join(data[:size] for data in packets), dtype=self.layout.packet)

    def _times(self, times: FiringTimes | None) -> Floats:
        """(states, channels) times, s, of the channels in a firing; NaN where one does not fire."""
        if self.model.times:
            if times is None:
                raise ValueError(f"a {self.title} fires some of its channels at a time, and its packets do not name "
                                 "them; put its angle correction file and its file of firing times into a folder, and "
                                 "give that with --metadata FOLDER")
            if times.kind != self.model.times or times.us.shape[1] != self.model.lasers:
                raise ValueError(f"the firing times in {self.source} are not those of a {self.title}")
            if self.model.times == "loops" and (self.layout.flags & SELF_DEFINED or len(times.us) != 2):
                raise ValueError(f"packets of a {self.title} whose channels the user has chosen are not decoded")
            return times.us * 1e-6
        name, step = self.model.like
        return (catalogue.load(name).time_s[::step] if name else np.array(self.model.laser_us) * 1e-6)[None]

    def _is_slow(self, packets: Packets) -> bool:
        """Whether a Pandar128 is in a mode in which a firing of all channels takes twice as long."""
        return self.layout.protocol == PANDAR128 and bool(np.median(packets["tail"]["operation"]) > 0)

    def _states(self, packets: Packets, groups: int) -> npt.NDArray[np.intp]:
        """(n, groups), in which state of the firing times a firing is; -1: an unknown one, -2: of another mode."""
        n, block = len(packets), np.arange(groups) * (self.layout.blocks // groups)
        count = len(self._fires)
        if self.model.times == "loops":
            return (packets["tail"]["loop"][:, None].astype(np.intp) + np.arange(groups) + 1) % count
        if not self.model.times:
            return np.zeros((n, groups), dtype=np.intp)
        state = packets["tail"]["states"][:, None].astype(np.intp) >> (2 * (7 - block)) & 3
        first = np.array([0, -1, 4, 6])[np.minimum(packets["tail"]["operation"], 3)]
        first[packets["tail"]["operation"] > 3] = -1
        state += first[:, None]
        # Modes but the first have two states.
        known = (first >= 0)[:, None] & (state < np.where(first > 0, first + 2, 4)[:, None]) & (state < count)
        return np.where(known, np.where((first > 0)[:, None] == self._slow, state, -2), -1)

    def _angles(self, correction: pathlib.Path | None) -> tuple[Floats, Floats]:
        """Elevations and azimuth offsets (counter-clockwise), rad, of the channels."""
        name, step = self.model.like
        if name and correction is None:
            file = catalogue.load(name)
            return np.radians(file.elevation_deg[::step]), np.radians(file.azimuth_deg[::step])
        elevation, clockwise = read_angles(self._needed(correction))
        if len(elevation) != self.model.lasers:
            raise ValueError(f"{correction} has {len(elevation)} channels, but a {self.title} has {self.model.lasers}")
        return elevation, -clockwise

    def _needed(self, correction: pathlib.Path | None) -> pathlib.Path:
        if correction is None:
            form = "dat" if self.layout.protocol == AT128 else "csv"
            raise ValueError(f"a {self.title} needs the angles of its channels, which packets do not contain; give its "
                             f"angle correction file with --metadata CORRECTION.{form}")
        return correction

    def _stamps(self, packets: Packets) -> Floats:
        """(n,) s since 1970, as the sensor counts them."""
        tail = packets["tail"]
        return seconds_of(tail["date"]) + tail["stamp_us"] * 1e-6

    def _firings(self, packets: Packets, captured_s: Floats, returns: int) -> Firings:
        n, model = len(packets), self.model
        blocks = packets["blocks"].reshape(n, -1, returns)
        groups = blocks.shape[1]
        centi = blocks["azimuth"][:, :, 0]
        sound = centi < 36000
        if self.layout.protocol == PANDAR40:
            sound &= (blocks["flag"] == 0xEEFF).all(axis=2)
        self.skipped["blocks with a wrong flag or azimuth"] += int((~sound).sum()) * returns
        states = self._states(packets, groups)
        self.skipped["blocks in an unknown mode of firing"] += int((sound & (states == -1)).sum()) * returns
        self.skipped["blocks in another mode of firing than the first ones"] += int((sound & (states == -2)).sum()) * returns
        sound &= states >= 0
        if self.stamped:
            stamp_s = self._stamps(packets)
            last_s = stamp_s + self.clock.shift(stamp_s, captured_s) + model.stamp_us * 1e-6
            if model.stamps_first:
                last_s += (groups - 1) * self._period_s
        else:
            last_s = captured_s - self._period_s
        time_s = (last_s[:, None] + np.arange(1 - groups, 1) * self._period_s)[sound]
        azimuth = centi[sound].astype(np.float64) * 0.01
        if self.layout.protocol == AT128:
            azimuth += blocks["fine"][:, :, 0][sound] * (0.01 / 256)
        else:
            azimuth += _START_DEG
        rate, turn = self._rotation.advance(azimuth, time_s)
        lasers, state = blocks["lasers"][sound][:, :, self._order], states[sound]
        counts = lasers["range"].astype(np.uint16)
        unknown = np.zeros((len(counts), counts.shape[2]), dtype=bool)
        if model.has_codes:
            unknown = ((counts == 1) | (counts == 2)).any(axis=1) & self._fires[state]
            self.skipped["beams that end too close to be measured"] += int(unknown.sum())
            counts[counts <= 3] = 0
        if model.times:
            idle = (counts > 0) & ~self._fires[state][:, None, :]
            self.skipped["returns of channels that do not fire then"] += int(idle.sum())
        return Firings(azimuth + rate * (model.azimuth_us * 1e-6), rate, time_s, turn, state, unknown, counts,
                       lasers["intensity"].astype(np.uint8))
