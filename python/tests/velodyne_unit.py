"""Velodyne units whose packets the tests write, with what their beams measured."""
from __future__ import annotations

import dataclasses
import json
import math
import pathlib
import struct
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

import packet_files as pf
from packet_files import T0, Beam, Floats
from underbrush.formats.scans import Scan


@dataclasses.dataclass
class Unit:
    """A sensor as its manual describes it."""

    sensor: str
    layout: str
    product: int
    elevation: list[float]  #: Degrees, in the order of the packet.
    clockwise: list[float]
    laser_us: list[float]
    period_us: float
    step_m: float
    stamp_us: float = 0.0
    range_m: float = 0.0  #: What is to be added to its ranges.

    @property
    def highest_first(self) -> bool:
        return self.layout == "hdl64"

    def rings(self) -> list[int]:
        order = sorted(range(len(self.elevation)), key=lambda laser: self.elevation[laser], reverse=self.highest_first)
        return [order.index(laser) for laser in range(len(order))]


def vls128() -> Unit:
    """Elevations of the lasers that the test does not list are the catalogue's, in its order."""
    from underbrush.formats import catalogue
    file = catalogue.load("velodyne-vls128")
    order = np.lexsort((file.azimuth_deg, file.time_s))
    elevation = file.elevation_deg[order].tolist()
    for laser, known in pf.VLS128.items():
        assert elevation[laser] == pytest.approx(known, abs=5e-3)
    groups = [laser // 8 for laser in range(128)]
    return Unit("velodyne-vls128", "vls128", 0xA1, elevation, list(pf.VLS128_AZIMUTH) * 16,
                [2.665 * (group + (group > 7)) for group in groups], 53.3, 0.004, 8.7)


UNITS = {
    "vlp16": Unit("velodyne-vlp16", "vlp16", 0x22, list(pf.VLP16), [0] * 16, [2.304 * k for k in range(16)], 55.296,
                  0.002),
    "hires": Unit("", "vlp16", 0x24, [angle * 10 / 15 for angle in pf.VLP16], [0] * 16, [2.304 * k for k in range(16)],
                  55.296, 0.002),
    "hdl32e": Unit("velodyne-hdl32e", "hdl32", 0x21, list(pf.HDL32E), [0] * 32, [1.152 * k for k in range(32)], 46.08,
                   0.002),
    "vlp32c": Unit("velodyne-vlp32c", "hdl32", 0x28, list(pf.VLP32C), list(pf.VLP32C_AZIMUTH),
                   [2.304 * (k // 2) for k in range(32)], 55.296, 0.004),
    "vls128": vls128(),
    "hdl64e": Unit("velodyne-hdl64e", "hdl64", 0,
                   [2.0 - 0.34 * pf.HDL64E_FROM_ABOVE.index(k % 32) - (k // 32) * (0.6 + 0.34 * 31)
                    - (k // 32) * 0.17 * pf.HDL64E_FROM_ABOVE.index(k % 32) for k in range(64)],
                   [4.0 - 0.1 * k for k in range(64)],
                   [6.0 * (k % 32 // 4) + (0, 1.26, 2.46, 3.66)[k % 4] for k in range(64)], 48.0, 0.002, 0, 1.4),
}
MODES = {"strongest": 0x37, "last": 0x38, "dual": 0x39}


def counts(unit: Unit, range_m: Floats) -> npt.NDArray[np.int64]:
    return np.round((range_m - unit.range_m) / unit.step_m).astype(np.int64)


@dataclasses.dataclass
class Truth:
    """What a sensor in the room sees, a row for each beam in order of the packets."""

    direction: Floats
    time_s: Floats
    ring: npt.NDArray[np.int64]
    strongest: npt.NDArray[np.int64]  #: Counts; 0 is a miss.
    last: npt.NDArray[np.int64]


def observe(unit: Unit, firings: int, rate_deg_s: float = 3600.0, start_deg: float = 170.0,
            start_s: float = T0) -> Truth:
    """Beams above 8 degrees are misses; those of every third laser have a last return behind the strongest one."""
    lasers = len(unit.elevation)
    time_us = np.arange(firings)[:, None] * unit.period_us + np.array(unit.laser_us)
    azimuth = -np.radians(start_deg + rate_deg_s * time_us * 1e-6 + np.array(unit.clockwise))
    elevation = np.radians(np.broadcast_to(unit.elevation, azimuth.shape))
    flat = np.cos(elevation)
    direction = np.stack([np.cos(azimuth) * flat, np.sin(azimuth) * flat, np.sin(elevation)], -1).reshape(-1, 3)
    laser = np.tile(np.arange(lasers), firings)
    strongest = counts(unit, pf.room_range(direction))
    strongest[np.degrees(elevation.ravel()) > 8] = 0
    last = np.where((laser % 3 == 0) & (strongest > 0), strongest + 500, strongest)
    last[laser % 7 == 6], strongest[laser % 7 == 5] = 0, 0  # Either may be absent.
    return Truth(direction, start_s + time_us.ravel() * 1e-6 - unit.stamp_us * 1e-6, np.array(unit.rings())[laser],
                 strongest, last)


def packets_of(unit: Unit, truth: Truth, mode: int, rate_deg_s: float = 3600.0, start_deg: float = 170.0,
               start_s: float = T0, status: bytes = b"") -> list[tuple[float, bytes]]:
    """Times (s) and data of the packets."""
    lasers, dual = len(unit.elevation), mode == 0x39
    if unit.layout == "hdl64":
        mode = -1 if dual else 0
    per_packet = {"vlp16": 24, "hdl32": 12, "hdl64": 6, "vls128": 3}[unit.layout] // (2 if dual else 1)
    beams = np.stack([truth.strongest, truth.strongest % 200, truth.last, truth.last % 199], axis=-1)
    firings: list[list[Beam]] = [[tuple(beam) for beam in firing] for firing in beams.reshape(-1, lasers, 4).tolist()]
    out: list[tuple[float, bytes]] = []
    for begin in range(0, len(firings) // per_packet * per_packet, per_packet):
        time_us = begin * unit.period_us
        azimuths = [start_deg + rate_deg_s * (time_us + k * unit.period_us) * 1e-6 for k in range(per_packet)]
        data = pf.velodyne_packet(firings[begin:begin + per_packet], azimuths,
                                  round((start_s % 3600) * 1e6 + time_us), mode, unit.product, unit.layout)
        if status:
            place = len(out)
            data = data[:-2] + status[2 * place % len(status):][:2]
        out.append((start_s + (time_us + per_packet * unit.period_us) * 1e-6, data))
    return out


def save(path: pathlib.Path, packets: list[tuple[float, bytes]], **options: Any) -> pathlib.Path:
    path.write_bytes(pf.pcap([(time_s, pf.udp(data)[0]) for time_s, data in packets], **options))
    return path


def joined(scans: list[Scan], name: str) -> npt.NDArray[Any]:
    return np.concatenate([getattr(scan, name) for scan in scans])


def hdl64e_status(unit: Unit) -> bytes:
    """Kinds and values of the status bytes of a whole cycle, of which the packets have a pair each."""
    text = b"UNIT#\x18\x18"
    for laser in range(64):
        row = struct.pack("<B9hBB", laser, round(unit.elevation[laser] * 100), round(-unit.clockwise[laser] * 100),
                          round(unit.range_m * 1000), 0, 0, 0, 0, 0, 0, 40, 255)
        text += row + bytes(7)
    text += bytes(21)
    assert len(text) == 1820
    return b"".join(bytes([kind, 0]) if kind else bytes([ord("1") + k % 16 - 9, text[k // 16 * 7 + k % 16 - 9]])
                    for k in range(4160) for kind in [b"HMSDNYGTV"[k % 16] if k % 16 < 9 else 0])


def calibration_file(path: pathlib.Path, unit: Unit, **more: float) -> pathlib.Path:
    """A calibration in the driver's YAML (JSON is YAML)."""
    path.write_text(json.dumps({"num_lasers": len(unit.elevation), "distance_resolution": unit.step_m, "lasers": [
        {"laser_id": laser, "vert_correction": math.radians(elevation), "rot_correction": -math.radians(clockwise),
         "dist_correction": unit.range_m, **more}
        for laser, (elevation, clockwise) in enumerate(zip(unit.elevation, unit.clockwise))]}))
    return path
