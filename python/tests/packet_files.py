"""Builders of capture files, packets and metadata for the tests, byte by byte, and of the room that they show."""
from __future__ import annotations

import json
import math
import os
import pathlib
import struct
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

Floats = npt.NDArray[np.float64]
T0 = 1_599_998_600.0  #: 200 s after a full hour.
ROOM = (6.0, 4.5, 2.0)  #: Half extents of a room around the sensor, m.


def data_folder() -> pathlib.Path:
    """The folder of real captures; skips the test where it is absent."""
    root = os.environ.get("UNDERBRUSH_DATA")
    here = pathlib.Path(__file__).resolve().parents[2]
    folder = (pathlib.Path(root) if root else here.parent / "shared" / "data") / "packets"
    if not folder.is_dir():
        pytest.skip(f"real captures are absent ({folder}; set UNDERBRUSH_DATA)")
    return folder


def room_range(direction: Floats, origin: Floats | None = None) -> Floats:
    """(n,) distances to the walls of the room along (n, 3) directions."""
    start = np.zeros(3) if origin is None else origin
    with np.errstate(divide="ignore"):
        walls: Floats = np.min((np.array(ROOM) - np.sign(direction) * start) / np.abs(direction), axis=-1)
    return walls


def off_walls(points: Floats) -> Floats:
    """(n,) distances of points from the nearest wall of the room."""
    distance: Floats = np.abs(np.abs(points) - np.array(ROOM)).min(axis=1)
    return distance


# Link layer and network.

def udp(payload: bytes, source: str = "192.168.1.201", port: int = 2368, identity: int = 1, mtu: int = 65535,
        version: int = 4) -> list[bytes]:
    """IP packets of one datagram, in fragments if it is longer than `mtu`."""
    segment = struct.pack(">HHHH", 2368, port, len(payload) + 8, 0) + payload
    step = (mtu - 40) // 8 * 8
    packets = []
    for begin in range(0, len(segment), step):
        part, more = segment[begin:begin + step], begin + step < len(segment)
        addresses = bytes(int(number) for number in source.split(".")) + b"\xff\xff\xff\xff"
        if version == 4:
            packets.append(struct.pack(">BBHHHBBH", 0x45, 0, 20 + len(part), identity, (more << 13) | (begin // 8), 64,
                                       17, 0) + addresses + part)
        else:
            long = addresses[:4] * 4 + addresses[4:] * 4
            extra = struct.pack(">BBHI", 17, 0, begin | more, identity) if len(segment) > step else b""
            packets.append(struct.pack(">IHBB", 0x6 << 28, len(extra) + len(part), 44 if extra else 17, 64) + long
                           + extra + part)
    return packets


LINKS: dict[str, tuple[int, Callable[[bytes], bytes]]] = {
    "ethernet": (1, lambda ip: b"\xff" * 12 + _kind(ip) + ip),
    "padded": (1, lambda ip: b"\xff" * 12 + _kind(ip) + ip + b"\0" * 6),
    "vlan": (1, lambda ip: b"\xff" * 12 + b"\x81\x00\x00\x05" + _kind(ip) + ip),
    "double vlan": (1, lambda ip: b"\xff" * 12 + b"\x88\xa8\x00\x05\x81\x00\x00\x06" + _kind(ip) + ip),
    "cooked": (113, lambda ip: b"\0" * 14 + _kind(ip) + ip),
    "cooked 2": (276, lambda ip: _kind(ip) + b"\0" * 18 + ip),
    "cooked vlan": (113, lambda ip: b"\0" * 14 + b"\x81\x00\x00\x05" + _kind(ip) + ip),
    "raw": (101, lambda ip: ip),
    "loopback": (0, lambda ip: b"\x02\0\0\0" + ip),
}


def _kind(ip: bytes) -> bytes:
    return b"\x08\x00" if ip[0] >> 4 == 4 else b"\x86\xdd"


def pcap(records: Iterable[tuple[float, bytes]], order: str = "<", nano: bool = False, link: str = "ethernet",
         cut: int = 1 << 18) -> bytes:
    """A classic capture of IP packets with their times (s)."""
    kind, frame_of = LINKS[link]
    ticks = 10**9 if nano else 10**6
    out = [struct.pack(order + "IHHiIII", 0xA1B23C4D if nano else 0xA1B2C3D4, 2, 4, 0, 0, cut, kind)]
    for time_s, ip in records:
        frame = frame_of(ip)
        seconds = math.floor(time_s)
        out.append(struct.pack(order + "IIII", seconds, min(round((time_s - seconds) * ticks), ticks - 1),
                               min(cut, len(frame)), len(frame)) + frame[:cut])
    return b"".join(out)


def pcapng(records: Iterable[tuple[float, bytes]], order: str = "<", resolution: int | None = 9, offset_s: int = 0,
           link: str = "ethernet", simple: bool = False) -> bytes:
    """A pcapng file of IP packets with their times (s), besides a block that readers have to pass over."""
    kind, frame_of = LINKS[link]

    def block(code: int, body: bytes) -> bytes:
        body += b"\0" * (-len(body) % 4)
        size = len(body) + 12
        return struct.pack(order + "II", code, size) + body + struct.pack(order + "I", size)

    options = b""
    if resolution is not None:
        options += struct.pack(order + "HHB3x", 9, 1, resolution)
    if offset_s:
        options += struct.pack(order + "HHq", 14, 8, offset_s)
    out = [block(0x0A0D0D0A, struct.pack(order + "IHHq", 0x1A2B3C4D, 1, 0, -1)),
           block(1, struct.pack(order + "HHI", kind, 0, 0) + options + b"\0\0\0\0"),
           block(5, b"statistics..")]
    ticks = 10**6 if resolution is None else 2**(resolution & 127) if resolution & 128 else 10**resolution
    for time_s, ip in records:
        frame = frame_of(ip)
        stamp = round((time_s - offset_s) * ticks)
        head = struct.pack(order + "IIIII", 0, stamp >> 32, stamp & 0xFFFFFFFF, len(frame), len(frame))
        out.append(block(3, struct.pack(order + "I", len(frame)) + frame) if simple else block(6, head + frame))
    return b"".join(out)


# Velodyne.

#: Elevations in degrees in the order of lasers in the packet, from the makers' manuals.
VLP16 = (-15, 1, -13, 3, -11, 5, -9, 7, -7, 9, -5, 11, -3, 13, -1, 15)
HDL32E = (-30.67, -9.33, -29.33, -8.00, -28.00, -6.66, -26.66, -5.33, -25.33, -4.00, -24.00, -2.67, -22.67, -1.33,
          -21.33, 0, -20.00, 1.33, -18.67, 2.67, -17.33, 4.00, -16.00, 5.33, -14.67, 6.67, -13.33, 8.00, -12.00, 9.33,
          -10.67, 10.67)
VLP32C = (-25, -1, -1.667, -15.639, -11.31, 0, -0.667, -8.843, -7.254, 0.333, -0.333, -6.148, -5.333, 1.333, 0.667, -4,
          -4.667, 1.667, 1, -3.667, -3.333, 3.333, 2.333, -2.667, -3, 7, 4.667, -2.333, -2, 15, 10.333, -1.333)
#: Azimuth offsets of the same lasers, degrees, clockwise.
VLP32C_AZIMUTH = (1.4, -4.2, 1.4, -1.4, 1.4, -1.4, 4.2, -1.4, 1.4, -4.2, 1.4, -1.4, 4.2, -1.4, 4.2, -1.4, 1.4, -4.2,
                  1.4, -4.2, 4.2, -1.4, 1.4, -1.4, 1.4, -1.4, 1.4, -4.2, 4.2, -1.4, 1.4, -1.4)
#: VLS-128: elevation of the first, fourth and last of each group of eight lasers.
VLS128 = {0: -11.742, 3: -5.29, 7: 1.31, 8: -6.5, 11: -4.41, 15: 2.19, 16: -3.86, 19: -1.77, 23: 4.83, 24: -2.98,
          27: -0.89, 31: 7.58, 32: -0.34, 36: -25.0, 39: -5.73, 40: 0.54, 43: 2.63, 47: -4.85, 59: 15.0, 64: -5.62,
          69: -19.582, 79: 3.95, 87: -13.565, 97: -10.346, 115: -8.352, 127: 0.43}
VLS128_AZIMUTH = (6.354, 4.548, 2.732, 0.911, -0.911, -2.732, -4.548, -6.354)  # Clockwise, of each group of eight.
#: HDL-64E: elevations of the lasers of a unit's calibration are in this order, seen from above: laser 29 the highest.
HDL64E_FROM_ABOVE = (29, 28, 25, 24, 3, 2, 31, 30, 27, 26, 21, 20, 17, 16, 13, 12, 23, 22, 19, 18, 15, 14, 9, 8, 5, 4,
                     1, 0, 11, 10, 7, 6)

Beam = tuple[int, int, int, int]  #: Counts and intensities of the strongest and the last return.


def velodyne_packet(firings: list[list[Beam]], azimuths: list[float], stamp_us: int, mode: int, product: int,
                    layout: str) -> bytes:
    """A data packet. `firings` have the beams of all lasers, `azimuths` are one a firing (deg, clockwise).

    `layout` is 'vlp16', 'hdl32', 'hdl64' or 'vls128'. In dual mode the last return stands before the strongest one,
    except that the HDL-64E has it after.
    """
    dual = mode == 0x39 or (layout == "hdl64" and mode == -1)
    blocks: list[tuple[int, float, list[tuple[int, int]]]] = []
    step = 2 if layout == "vlp16" else 1
    for k in range(0, len(firings), step):
        beams = [beam for firing in firings[k:k + step] for beam in firing]
        strongest, last = [beam[:2] for beam in beams], [beam[2:] for beam in beams]
        banks = [(flag, slice(32 * number, 32 * number + 32)) for number, flag in
                 enumerate((0xEEFF, 0xDDFF, 0xCCFF, 0xBBFF)[:max(1, len(beams) // 32)])]
        if dual and layout == "hdl64":
            order = [(flag, rows, returns) for returns in (strongest, last) for flag, rows in banks]
        elif dual:
            order = [(flag, rows, returns) for flag, rows in banks for returns in (last, strongest)]
        else:
            order = [(flag, rows, last if mode == 0x38 else strongest) for flag, rows in banks]
        blocks += [(flag, azimuths[k], returns[rows]) for flag, rows, returns in order]
    data = b"".join(struct.pack("<HH", flag, round(azimuth * 100) % 36000)
                    + b"".join(struct.pack("<HB", count, intensity) for count, intensity in lasers)
                    for flag, azimuth, lasers in blocks)
    data = data.ljust(1200, b"\0")
    assert len(data) == 1200
    return data + struct.pack("<IBB", stamp_us % 3_600_000_000, mode & 0xFF, product)


# Ouster.

def ouster_metadata(rows: int, columns: int, profile: str, nested: bool = False, **more: Any) -> str:
    """Metadata of an invented sensor, whose transform moves and turns the lidar in the sensor's frame."""
    elevation = np.linspace(20, -22, rows).round(3).tolist()
    azimuth = [(4.2, 1.4, -1.4, -4.2)[row % 4] for row in range(rows)]
    beams = {"beam_altitude_angles": elevation, "beam_azimuth_angles": azimuth, "lidar_origin_to_beam_origin_mm": 27.67}
    lidar = {"lidar_to_sensor_transform": [-1, 0, 0, 5, 0, -1, 0, -3, 0, 0, 1, 36.18, 0, 0, 0, 1]}
    layout = {"columns_per_frame": columns, "columns_per_packet": 16, "pixels_per_column": rows,
              "column_window": [0, columns - 1], "udp_profile_lidar": profile}
    info = {"prod_line": "OS-0-32", "prod_sn": "123"}
    layout.update({key: more.pop(key) for key in list(more) if key in layout})
    if nested:
        return json.dumps({"sensor_info": info, "beam_intrinsics": beams, "lidar_intrinsics": lidar,
                           "lidar_data_format": layout, "config_params": {"udp_port_lidar": 7502}, **more})
    return json.dumps({**info, **beams, **lidar, "data_format": layout, "udp_port_lidar": 7502, **more})


#: Pixel layouts: profile -> function of (range mm, second range mm, signals, reflectivities, near infrared) to bytes.
Pixel = tuple[int, int, tuple[int, int], tuple[int, int], int]
PIXELS: dict[str, Callable[[Pixel], bytes]] = {
    "LEGACY": lambda p: struct.pack("<IHHHH", p[0], p[3][0], p[2][0], p[4], 0),
    "RNG19_RFL8_SIG16_NIR16": lambda p: struct.pack("<IBBHHH", p[0] | 0x80000, p[3][0], 0, p[2][0], p[4], 0),
    "RNG19_RFL8_SIG16_NIR16_DUAL": lambda p: struct.pack(
        "<IIHHHH", p[0] | p[3][0] << 24, p[1] | p[3][1] << 24, *p[2], p[4], 0),
    "RNG15_RFL8_NIR8": lambda p: struct.pack("<HBB", p[0] // 8, p[3][0], p[4] // 16),
    "RNG15_RFL8_NIR8_DUAL": lambda p: struct.pack(
        "<HBBHBB", p[0] // 8 | 0x8000, p[3][0], p[4] // 16, p[1] // 8, p[3][1], 0),
    "RNG19_RFL8_SIG16_NIR16_RGB16_DUAL": lambda p: struct.pack(
        "<IIHHHHHH", p[0] | p[3][0] << 24, p[1] | p[3][1] << 24, *p[2], p[4], 1, 2, 3),
}


def ouster_packet(profile: str, frame: int, columns: list[tuple[int, int, list[Pixel], bool]], serial: int = 123,
                  fusa: bool = False) -> bytes:
    """A lidar packet of columns (time in ns, number, pixels, valid)."""
    body = b""
    for time_ns, number, pixels, valid in columns:
        data = b"".join(map(PIXELS[profile], pixels))
        if profile == "LEGACY":
            body += struct.pack("<QHHI", time_ns, number, frame & 0xFFFF, 0) + data + struct.pack(
                "<I", 0xFFFFFFFF if valid else 0)
        else:
            body += struct.pack("<QHH", time_ns, number, int(valid)) + data
    if profile == "LEGACY":
        return body
    if fusa:
        head = struct.pack("<BBHI", 1, 7, 0, frame) + b"\0" * 3 + serial.to_bytes(5, "little")
    else:
        head = struct.pack("<HH", 1, frame & 0xFFFF) + b"\7\0\0" + serial.to_bytes(5, "little")
    return head.ljust(32, b"\0") + body + b"\0" * 32
