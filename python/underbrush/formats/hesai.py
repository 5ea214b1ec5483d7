"""Decoder of Hesai's point cloud packets: Pandar40P, Pandar64, PandarQT, PandarXT-16, PandarXT-32, XT32M2X.

Angles, times and the start of a revolution are those of the sensor catalogue where it has the model; what only packets
know stands in `MODELS`. A block's azimuth is that of the rotor at the time that firing times count from, and a laser's
is the rotor's at its own time. Sources: those of `hesai_packets`.
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
from underbrush.formats.hesai_calibration import read_angles
from underbrush.formats.hesai_packets import MODES, PANDAR40, PANDAR64, Layout, layout_of, seconds_of
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
    stamp_us: float  #: Time of the packet's last firing, which begins with its first laser, after the packet's stamp.
    azimuth_us: float  #: Time of a firing after the time at which the rotor has the block's azimuth.
    sensor: str = ""  #: Name in the catalogue; empty where it has none.
    like: tuple[str, int] = ("", 1)  #: Sensor of the catalogue of whose channels every nth is one of this model.
    period_us: float = 50.0
    laser_us: tuple[float, ...] = ()  #: Times of the channels after the first laser, where the catalogue has none.


MODELS = (
    Model("Hesai Pandar40P", PANDAR40, 40, (10,), -28.58 - 54.67, -54.67, period_us=55.56,
          laser_us=tuple(54.67 - time for time in _PANDAR40_US)),
    Model("Hesai Pandar64", PANDAR64, 64, (6, 7), -42.58 - 54.668, -54.668, "hesai-pandar64", ("hesai-pandar64", 1)),
    Model("Hesai PandarXT-32", (6, 1), 32, (8,), 6.0, 0.368, "hesai-xt32", ("hesai-xt32", 1)),
    Model("Hesai PandarXT-16", (6, 1), 16, (8,), 6.0, 0.368, like=("hesai-xt32", 2)),
    Model("Hesai XT32M2X", (6, 1), 32, (6,), 6.0, 0.368, laser_us=tuple(2.888 * (k % 16) for k in range(32))),
)


def recognise(data: bytes) -> bool:
    """Whether a datagram is a point cloud packet of Hesai."""
    return layout_of(data) is not None


def model_of(layout: Layout, sensor: str | None = None) -> Model:
    """The model that sends such packets. Raises ValueError where it is not known, or not `sensor`."""
    found = next((model for model in MODELS if model.protocol == layout.protocol and model.lasers == layout.lasers
                  and layout.blocks in model.blocks), None)
    if found is None:
        raise ValueError(f"packets of Hesai's protocol {layout.protocol[0]}.{layout.protocol[1]} with {layout.lasers} "
                         f"channels and {layout.blocks} blocks are not decoded; have the driver write its point clouds")
    if sensor is not None and sensor != found.sensor and (found.sensor or sensor in catalogue.names()):
        raise ValueError(f"sensor '{sensor}' does not send these packets, which are those of a {found.title}")
    return found


class Decoder:
    """Turns packets into scans, one a revolution. Partial revolutions at the ends and at gaps are scans, too.

    Rows are in order of firing. Raises ValueError where the model is not known or its angles are missing.
    """

    organised = True

    def __init__(self, probe: list[bytes], captured_s: Floats, skipped: collections.Counter[str],
                 sensor: str | None = None, correction: pathlib.Path | None = None, clock: str = "auto") -> None:
        """`probe` and `captured_s` are the first packets, which tell the model, and their times of capture.

        `correction` is the unit's file of angles.
        """
        layouts = collections.Counter(layout_of(data) for data in probe)
        layouts.pop(None, None)
        layout = layouts.most_common(1)[0][0]
        assert layout is not None
        self.layout, self.model = layout, model_of(layout, sensor)
        self.sensor, self.title = self.model.sensor, self.model.title
        self.skipped, self.modes = skipped, set[str]()
        self.clock = Clock(believed=clock)
        first = [k for k, data in enumerate(probe) if layout_of(data) == layout]
        self._lengths = collections.Counter(len(probe[k]) for k in first)
        self.packet_bytes = self._lengths.most_common(1)[0][0]
        packets = self._packets([probe[k] for k in first])

        self.source = "" if correction is None else str(correction)
        elevation, azimuth, laser_s, period_s = self._channels(correction)
        order = np.argsort(laser_s, kind="stable")
        calibration = Calibration.nominal(elevation[order], azimuth[order], np.zeros(len(order)))
        self._order: npt.NDArray[np.intp] = order
        steps = np.diff(self._stamps(packets))
        returns = MODES.get(collections.Counter(packets["tail"]["mode"].tolist()).most_common(1)[0][0], (1, ""))[0]
        self._period_s, self.stamped = firing_period(steps, captured_s[first], layout.blocks // returns, period_s)
        self._rotation = Rotation(_START_DEG, self._period_s)
        self._revolutions = Revolutions(calibration, order, laser_s[order] * (self._period_s / period_s),
                                        self._period_s, layout.unit_mm * 0.001)

    def unfit(self, data: bytes) -> str:
        """Why a packet is not decoded; empty where it is."""
        return "" if len(data) in self.layout.sizes else "packets of another length"

    def decode(self, packets: list[bytes], captured_s: Floats) -> Iterator[Scan]:
        """Yields the scans that end in the n `packets`, which were captured at (n,) `captured_s`."""
        same = [layout_of(data) == self.layout for data in packets]
        whole = self._packets([data for data, keep in zip(packets, same) if keep])
        returns = np.array([MODES.get(mode, (0, ""))[0] for mode in range(256)])[whole["tail"]["mode"]]
        keep = (returns > 0) & (self.layout.blocks % np.maximum(returns, 1) == 0)
        self.skipped["packets of another model or with an unknown return mode"] += len(packets) - int(keep.sum())
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

    def _channels(self, correction: pathlib.Path | None) -> tuple[Floats, Floats, Floats, float]:
        """Elevations and azimuth offsets (counter-clockwise), rad, and times, s, of the channels; period, s."""
        model = self.model
        name, step = model.like
        elevation = azimuth = None
        laser_s, period_s = np.array(model.laser_us) * 1e-6, model.period_us * 1e-6
        if name:
            file = catalogue.load(name)
            elevation, azimuth = np.radians(file.elevation_deg[::step]), np.radians(file.azimuth_deg[::step])
            laser_s, period_s = file.time_s[::step], file.period_s
        if correction is not None:
            elevation, clockwise = read_angles(correction)
            azimuth = -clockwise
        if elevation is None or azimuth is None:
            raise ValueError(f"a {model.title} needs the angles of its channels, which packets do not contain; give its "
                             "angle correction file with --metadata CORRECTION.csv")
        if len(elevation) != model.lasers:
            raise ValueError(f"{correction} has {len(elevation)} channels, but a {model.title} has {model.lasers}")
        return elevation, azimuth, laser_s, period_s

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
        if self.stamped:
            stamp_s = self._stamps(packets)
            last_s = stamp_s + self.clock.shift(stamp_s, captured_s) + model.stamp_us * 1e-6
        else:
            last_s = captured_s - self._period_s
        time_s = (last_s[:, None] + np.arange(1 - groups, 1) * self._period_s)[sound]
        azimuth = centi[sound].astype(np.float64) * 0.01 + _START_DEG
        rate, turn = self._rotation.advance(azimuth, time_s)
        lasers = blocks["lasers"][sound][:, :, self._order]
        return Firings(azimuth + rate * (model.azimuth_us * 1e-6), rate, time_s, turn,
                       lasers["range"].astype(np.uint16), lasers["intensity"].astype(np.uint8))
