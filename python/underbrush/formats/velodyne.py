"""Decoder of Velodyne's data packets: HDL-32E, VLP-16 (also Hi-Res), VLP-32C, HDL-64E S2 and S3, VLS-128.

Angles, times and range steps are those of the sensor catalogue; `MODELS` has what the catalogue lacks. Sources: the
makers' manuals, the public ROS driver (VLS-128: place of the stamp), VeloView and the manuals of the HDL-64E S2 and S3
(times of the lasers, calibration in the status bytes).
"""
from __future__ import annotations

import collections
import dataclasses
import datetime
from collections.abc import Iterator
from typing import Any

import numpy as np
import numpy.typing as npt

from underbrush.formats import catalogue
from underbrush.formats.clock import Clock
from underbrush.formats.rotation import Rotation, firing_period
from underbrush.formats.scans import Scan
from underbrush.formats.spinning import Firings, Revolutions
from underbrush.formats.velodyne_calibration import Calibration

Floats = npt.NDArray[np.float64]
Packets = npt.NDArray[Any]  #: Of `PACKET`.

PACKET = np.dtype([
    ("blocks", [("flag", "<u2"), ("azimuth", "<u2"),
                ("lasers", [("range", "<u2"), ("intensity", "u1")], (32,))], (12,)),
    ("stamp_us", "<u4"), ("mode", "u1"), ("product", "u1")])
MODES = {0x37: "strongest return", 0x38: "last return", 0x39: "dual return"}
POSITION_BYTES = 512  #: Size of a position packet, which may have GPS's time.
_DUAL, _HOUR_S = 0x39, 3600.0
_UPPER, _LOWER = 0xEEFF, 0xDDFF


@dataclasses.dataclass(frozen=True)
class Model:
    """What the packets of a model have besides its sensor file."""

    sensor: str  #: Name in the catalogue.
    product: int | None  #: Last byte of the packet; None where it is a status byte.
    flags: tuple[int, ...] = (_UPPER,)  #: Flags of the blocks of one firing, in order.
    stamp_s: float = 0.0  #: Time of the packet's stamp after the start of its first firing.
    elevation_scale: float = 1.0  #: Elevations are those of the sensor file times this.
    name: str = ""  #: Name for people, where it is not the sensor file's title.

    @property
    def is_hdl64e(self) -> bool:
        return self.product is None


MODELS = (
    Model("velodyne-hdl32e", 0x21),
    Model("velodyne-vlp16", 0x22),
    Model("velodyne-vlp16", 0x24, elevation_scale=2 / 3, name="Velodyne Puck Hi-Res"),
    Model("velodyne-vlp32c", 0x28),
    Model("velodyne-vls128", 0xA1, (_UPPER, _LOWER, 0xCCFF, 0xBBFF), stamp_s=8.7e-6),
    Model("velodyne-hdl64e", None, (_UPPER, _LOWER)),
)

#: HDL-64E: rings of the lasers 0, 2, 4, … of the upper block. The next laser has the ring above; the lower block's
#: rings are 32 more.
_HDL64E_RINGS = (27, 5, 25, 31, 23, 29, 15, 21, 13, 19, 11, 17, 3, 9, 1, 7)
#: HDL-64E: times in a firing of 48 µs at which four lasers of a block fire, one group of them every 6 µs.
_HDL64E_TIMES_US = (0.0, 1.26, 2.46, 3.66)


def recognise(data: bytes) -> bool:
    """Whether a datagram is a data packet of Velodyne."""
    return len(data) == PACKET.itemsize and data[0] == 0xFF and data[1] in (0xEE, 0xDD)


def model_of(packets: Packets, sensor: str | None = None) -> Model:
    """The model that sent most of `packets`, or the one named `sensor`. Raises ValueError where it is not known, and
    where nearly all packets have the number of another one."""
    product, count = collections.Counter(packets["product"].tolist()).most_common(1)[0]
    if sensor is not None:
        named = [model for model in MODELS if model.sensor == sensor]
        if not named:
            raise ValueError(f"sensor '{sensor}' is no Velodyne whose packets are known")
        sent = [model for model in MODELS if model.product == product and count > 0.9 * len(packets)]
        if sent and sent[0].sensor != sensor:
            raise ValueError(f"its packets are by their product number those of a {sent[0].sensor}, not of --sensor {sensor}")
        return next((model for model in named if model.product in packets["product"]), named[0])
    flags = packets["blocks"]["flag"]
    if ((flags[:, ::2] == _UPPER) & (flags[:, 1::2] == _LOWER)).all(axis=1).mean() > 0.5:
        return MODELS[-1]
    for model in MODELS:
        if model.product == product:
            return model
    raise ValueError(f"Velodyne packets with the unknown product number 0x{product:02x}; name the sensor with "
                     f"--sensor {MODELS[0].sensor} or another of {', '.join(sorted({m.sensor for m in MODELS}))}")


def rings_of_lasers(model: Model, file: catalogue.SpinningSensor) -> npt.NDArray[np.int64]:
    """(lasers,) ring of each laser in the order of the packet, which is that of firing.

    The packet begins each group of lasers that fire together with the one that is offset most clockwise.
    """
    if model.is_hdl64e:
        upper = [ring - odd for ring in _HDL64E_RINGS for odd in (0, 1)]
        return np.array(upper + [ring + 32 for ring in upper])
    return np.lexsort((file.azimuth_deg, file.time_s))


def utc_of(position: bytes) -> float | None:
    """Time (s since 1970) at which a position packet was sent, if it is known from GPS (a valid $GPRMC); None
    otherwise."""
    try:
        fields = position[206:].split(b"\0")[0].decode("ascii").split(",")
        if not fields[0].endswith("RMC") or fields[2] != "A":
            return None
        when = datetime.datetime.strptime(fields[9] + fields[1][:6] + "+0000", "%d%m%y%H%M%S%z")
    except (ValueError, IndexError):
        return None
    after_hour = int.from_bytes(position[198:202], "little") * 1e-6
    sentence = when.timestamp()
    return float(after_hour + np.round((sentence - after_hour) / _HOUR_S) * _HOUR_S)


class Decoder:
    """Turns packets into scans, one a revolution. Partial revolutions at the ends and at gaps are scans, too.

    Rows are in order of firing. Raises ValueError where model or calibration are missing.
    """

    packet_bytes = PACKET.itemsize
    organised = True

    def __init__(self, probe: list[bytes], captured_s: Floats, skipped: collections.Counter[str],
                 sensor: str | None = None, calibration: Calibration | None = None, reference_s: float = 0.0,
                 clock: str = "auto") -> None:
        """`probe` and `captured_s` are the first packets, from which the model follows, and their times of capture."""
        first = np.frombuffer(b"".join(probe), dtype=PACKET)
        self.model = model_of(first, sensor)
        file = catalogue.load(self.model.sensor)
        self.sensor = self.model.sensor if self.model.elevation_scale == 1 else ""
        self.title = self.model.name or file.title
        self.skipped = skipped
        self.clock = Clock(_HOUR_S, reference_s, clock)
        self.modes: set[str] = set()
        order = rings_of_lasers(self.model, file)
        self._lasers = len(order)
        self._has_modes = bool((first["product"] == (self.model.product or -1)).mean() > 0.5)
        if self.model.is_hdl64e and calibration is None:
            calibration = Calibration.from_status(first["mode"], first["product"])
            if calibration is None:
                raise ValueError("an HDL-64E needs its calibration, which the packets do not contain in full; give it "
                                 "with --metadata db.xml (VeloView) or --metadata calibration.yaml (ROS driver)")
        self.calibration = calibration or Calibration.nominal(
            np.radians(file.elevation_deg[order] * self.model.elevation_scale),
            np.radians(file.azimuth_deg[order]), file.z_m[order])
        if len(self.calibration.elevation) != self._lasers:
            raise ValueError(f"the calibration has {len(self.calibration.elevation)} lasers, but a {self.title} has "
                             f"{self._lasers}")
        steps = np.diff(first["stamp_us"].astype(np.float64) * 1e-6) % _HOUR_S
        self._period_s, self.stamped = firing_period(
            steps, captured_s, self._firings_per_packet(self._is_dual(first)), file.period_s)
        laser_s = file.time_s[order]
        if self.model.is_hdl64e:
            laser_s = np.array([6.0 * group + time for group in range(8) for time in _HDL64E_TIMES_US] * 2) * 1e-6
        self._rotation = Rotation(360.0 - file.start_azimuth_deg, self._period_s * (2 if self._lasers == 16 else 1))
        self._revolutions = Revolutions(self.calibration, order, laser_s * (self._period_s / file.period_s),
                                        self._period_s, self.calibration.resolution_m or file.resolution_m)

    def _firings_per_packet(self, dual: bool) -> int:
        return (12 if not dual else 6 if self._lasers < 128 else 4) * 32 // self._lasers

    def _is_dual(self, packets: Packets) -> bool:
        """Whether most packets have both returns. If no byte states it, two firings of the same azimuth show it."""
        if self._has_modes:
            return bool((packets["mode"] == _DUAL).mean() > 0.5)
        azimuth, banks = packets["blocks"]["azimuth"], len(self.model.flags)
        return bool(((azimuth[:, 0] == azimuth[:, banks]) & (azimuth[:, 0] != azimuth[:, 2 * banks])).mean() > 0.5)

    def unfit(self, data: bytes) -> str:
        """Why a packet is not decoded; empty where it is."""
        return "" if len(data) == PACKET.itemsize else "packets of another length"

    def decode(self, data: list[bytes], captured_s: Floats) -> Iterator[Scan]:
        """Yields the scans that end in n packets, which were captured at (n,) `captured_s`."""
        packets: Packets = np.frombuffer(b"".join(data), dtype=PACKET)
        if not len(packets):
            return
        dual = np.full(len(packets), self._is_dual(packets))
        if self._has_modes:
            of_model, known = packets["product"] == self.model.product, np.isin(packets["mode"], list(MODES))
            self.skipped["packets of another model"] += int((~of_model).sum())
            self.skipped["packets with an unknown return mode"] += int((of_model & ~known).sum())
            keep = of_model & known
            packets, captured_s = packets[keep], captured_s[keep]
            dual = packets["mode"] == _DUAL
            self.modes |= {MODES[mode] for mode in np.unique(packets["mode"]).tolist()}
        elif dual[0]:
            self.modes.add(MODES[_DUAL])
        edges = [0, *(np.flatnonzero(np.diff(dual)) + 1), len(packets)]
        for begin, end in zip(edges[:-1], edges[1:]):
            if end > begin:
                part = self._firings(packets[begin:end], captured_s[begin:end], bool(dual[begin]))
                yield from self._revolutions.cut(part)

    def finish(self) -> Iterator[Scan]:
        """Yields the last scan."""
        yield from self._revolutions.finish()

    def found(self) -> list[str]:
        """Lines about clock and calibration."""
        lines = [self.clock.found() if self.stamped else "clock: the capture's, because the packets have no stamps"]
        if self.calibration.source:
            lines.append(f"calibration: {self.calibration.source}")
        return lines

    def _firings(self, packets: Packets, captured_s: Floats, dual: bool) -> Firings:
        n, lasers, flags = len(packets), self._lasers, self.model.flags
        banks, firings = len(flags), self._firings_per_packet(dual)
        blocks: Packets = packets["blocks"]
        if dual and banks == 4:
            blocks = blocks[:, :8]  # The last four blocks are empty.
        returns = 2 if dual else 1
        # Blocks as (n, groups, returns, banks), the strongest return first. The HDL-64E has all banks of a return
        # together, others both returns of a bank, and the last return first.
        blocks = blocks.reshape((n, -1, returns, banks) if self.model.is_hdl64e else (n, -1, banks, returns))
        if not self.model.is_hdl64e:
            blocks = blocks.swapaxes(2, 3)[:, :, ::-1]
        groups = blocks.shape[1]
        azimuth = blocks["azimuth"][:, :, 0, 0].astype(np.float64) * 0.01
        sound = (blocks["flag"] == np.array(flags, dtype=np.uint16)).all(axis=(2, 3)) & (azimuth < 360)
        self.skipped["blocks with a wrong flag or azimuth"] += int((~sound).sum()) * returns * banks

        halves = firings // groups  # 2 for the VLP-16, whose blocks have two firings.
        group_s = np.arange(groups) * halves * self._period_s
        if self.stamped:
            stamp_s = packets["stamp_us"] * 1e-6
            start_s = stamp_s + self.clock.shift(stamp_s, captured_s) - self.model.stamp_s
        else:
            start_s = captured_s - firings * self._period_s
        time_s = (start_s[:, None] + group_s)[sound]
        rate, turn = self._rotation.advance(azimuth[sound], time_s)

        def values(name: str) -> npt.NDArray[Any]:
            column: npt.NDArray[Any] = blocks["lasers"][name][sound]  # (groups, returns, banks, 32)
            column = column.reshape(-1, returns, halves, lasers).swapaxes(1, 2)
            return column.reshape(-1, returns, lasers)

        half_s = np.arange(halves) * self._period_s
        n = len(turn) * halves
        return Firings(
            (azimuth[sound][:, None] + rate[:, None] * half_s).ravel(), np.repeat(rate, halves),
            (time_s[:, None] + half_s).ravel(), np.repeat(turn, halves), np.zeros(n, dtype=np.intp),
            np.zeros((n, lasers), dtype=bool), values("range").astype(np.uint16), values("intensity").astype(np.uint8))
