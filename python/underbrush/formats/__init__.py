"""Readers of the recordings that the field uses, and writers of its formats.

`open_recording` reads LAS, LAZ, COPC, E57, HELIOS++ `.xyz`, ROS 1 and ROS 2 bags, packet captures and our `.npz`;
`beams` places what it yields in the world. The libraries behind them come with `pip install 'underbrush[formats]'`.
"""
from __future__ import annotations

import pathlib
from typing import Any

from ..errors import FormatError
from ._files import OptionMissing, PathLike
from .log import beams_of_recording, export_log
from .place import beams, place, read_poses_of
from .scans import Poses, Recording, Scan
from .trajectory import read_poses

__all__ = ["FormatError", "OptionMissing", "Poses", "Recording", "Scan", "beams", "beams_of_recording",
           "export_log", "open_recording", "place", "read_poses"]

_PCAP = (b"\xd4\xc3\xb2\xa1", b"\xa1\xb2\xc3\xd4", b"\x4d\x3c\xb2\xa1", b"\xa1\xb2\x3c\x4d", b"\x0a\x0d\x0d\x0a")


def kind_of(path: PathLike) -> str:
    """"las", "e57", "pcap", "npz", "bag" or "xyz", by the content. Raises `FormatError` where it is none of these."""
    from .helios_xyz import is_helios_xyz
    from .ros_files import kind_of_bag

    file = pathlib.Path(path)
    if kind_of_bag(file):
        return "bag"
    if file.is_dir():
        raise FormatError(path, "", "is a folder without metadata.yaml, so no ROS 2 bag")
    with file.open("rb") as stream:
        head = stream.read(8)
    if head[:4] == b"LASF":
        return "las"
    if head == b"ASTM-E57":
        return "e57"
    if head[:4] in _PCAP:
        return "pcap"
    if head[:4] == b"PK\x03\x04":
        return "npz"
    if is_helios_xyz(file):
        return "xyz"
    raise FormatError(path, "", "is none of LAS, LAZ, E57, ROS bag, MCAP, pcap, .npz, HELIOS++ .xyz")


def open_recording(path: PathLike, *, topic: str | None = None, poses: PathLike | None = None,
                   metadata: PathLike | None = None, sensor: str | None = None, frame: str | None = None,
                   clock: str = "stamp", unit: str = "",
                   point_times: str = "after") -> Recording:
    """Opens a recording, whose kind is detected from its content.

    `topic`, `frame` and `clock` select what is read of a ROS recording (see `BagRecording`); for packet captures
    `topic` is the stream, for E57 the station. `metadata` and `sensor` determine how packets are decoded. `poses` is a
    file of poses (see `read_poses`) or a topic. `unit` (m, cm, mm, ft) is that of the coordinates of a bag's clouds or an E57
    file, by default m, or of a LAS file, by default its CRS's. `point_times` is how the times of the points of a bag's clouds
    count (see `PointTimes`). Raises `FormatError` where the file cannot be read, `OptionMissing` where an option is needed,
    `ImportError` where a library is, and `OSError`.
    """
    from ..recorded import bag_in
    from .las_units import UNITS

    path = bag_in(pathlib.Path(path))
    kind = kind_of(path)
    recording: Any
    if unit and kind not in ("las", "bag", "e57"):
        raise ValueError(f"{path}: --unit is for bags, E57, LAS and LAZ files")
    if point_times != "after" and kind != "bag":
        raise ValueError(f"{path}: --point-times is for the point clouds of bags")
    if kind == "bag":
        from .bag import BagRecording
        return BagRecording(path, topic=topic or None, frame=frame or None, poses=poses or None, clock=clock,
                            metadata=metadata or None, sensor=sensor or None, unit_m=UNITS[unit] if unit else 1.0,
                            point_times=point_times)
    if kind == "las":
        from .las import LasRecording
        recording = LasRecording(path, unit=unit)
    elif kind == "e57":
        from .e57 import E57Recording
        recording = E57Recording(path, topic or None, UNITS[unit] if unit else 1.0)
    elif kind == "npz":
        from .numpy_log import NumpyRecording
        recording = NumpyRecording(path)
    elif kind == "xyz":
        from .helios_xyz import HeliosRecording
        recording = HeliosRecording(path)
    else:
        from .packets import PacketRecording  # type: ignore[import-not-found, unused-ignore]
        recording = PacketRecording(path, metadata=metadata or None, sensor=sensor or None, stream=topic or None)
    if poses:
        recording.poses = read_poses_of(recording, poses)
    result: Recording = recording
    return result
