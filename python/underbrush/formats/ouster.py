"""Decoder of Ouster's lidar packets with the sensor's metadata.

Angles, origins and transforms are those of the metadata. Source: the maker's manuals and public SDK.
"""
from __future__ import annotations

import collections
import dataclasses
from collections.abc import Iterator
from typing import Any

import numpy as np
import numpy.typing as npt

from underbrush.formats import catalogue
from underbrush.formats.clock import Clock
from underbrush.formats.ouster_metadata import Metadata
from underbrush.formats.returns import rows_of
from underbrush.formats.scans import Scan

Floats = npt.NDArray[np.float64]
Packets = npt.NDArray[Any]  #: Of `Metadata.packet`, or its columns.


class Decoder:
    """Turns packets into scans, one a frame. Rows are in order of columns, then of pixels, then of range.

    Columns that were not received or that the sensor marks as not valid have no rows; `skipped` counts them.
    """

    organised = True

    def __init__(self, metadata: Metadata, skipped: collections.Counter[str], clock: str = "auto") -> None:
        self.metadata = metadata
        self.skipped = skipped
        self.packet = metadata.packet
        self.packet_bytes = self.packet.itemsize
        known = "ouster-" + metadata.product.lower().replace("os-", "os") if metadata.product else "ouster-os1-64"
        self.sensor = known if known in catalogue.names() and known.endswith(f"-{metadata.rows}") else ""
        self.title = f"Ouster {metadata.product or f'with {metadata.rows} rows'}"
        self.modes = {"dual return" if metadata.profile.returns == 2 else "single return"}
        self.clock = Clock(believed=clock)
        self._table = _Table(metadata)
        self._frames: list[_Frame] = []
        self._scans = 0

    def unfit(self, data: bytes) -> str:
        """Why a packet is not decoded; empty where it is."""
        return "" if len(data) == self.packet_bytes else "packets of another length"

    def decode(self, data: list[bytes], captured_s: Floats) -> Iterator[Scan]:
        """Yields the scans that end in n packets, which were captured at (n,) `captured_s`."""
        packets: Packets = np.frombuffer(b"".join(data), dtype=self.packet)
        if not self.metadata.profile.legacy:
            serial = packets["header"]["serial"] >> np.uint64(24) & np.uint64((1 << 40) - 1)
            other = (packets["header"]["kind"] != 1) | (
                (serial != self.metadata.serial) & (serial != 0) & (self.metadata.serial != 0))
            self.skipped["packets of another sensor or kind"] += int(other.sum())
            packets, captured_s = packets[~other], captured_s[~other]
        columns = packets["columns"]
        frame = columns["frame"] if self.metadata.profile.legacy else np.broadcast_to(
            packets["header"]["frame"][:, None], columns.shape)
        valid = (columns["status"] == 0xFFFFFFFF) if self.metadata.profile.legacy else (columns["status"] & 1) == 1
        sound = valid & (columns["id"] < self.metadata.columns)
        self.skipped["columns with a wrong number"] += int((valid & ~sound).sum())
        used = sound.any(axis=1)
        columns, frame, sound, captured_s = columns[used], frame[used], sound[used], captured_s[used]
        stamp_s = np.where(sound, columns["time_ns"], 0).max(axis=1, initial=0) * 1e-9
        shift = self.clock.shift(stamp_s, captured_s)
        time_s = columns["time_ns"] * 1e-9 + shift[:, None]
        columns, frame, time_s = columns[sound], frame[sound].astype(np.int64), time_s[sound]
        edges = [0, *(np.flatnonzero(np.diff(frame)) + 1), len(frame)]
        for begin, end in zip(edges[:-1], edges[1:]):
            if end > begin:
                yield from self._add(int(frame[begin]), columns[begin:end], time_s[begin:end])

    def finish(self) -> Iterator[Scan]:
        """Yields the last scans."""
        while self._frames:
            yield self._scan(self._frames.pop(0), last=not self._frames)

    def found(self) -> list[str]:
        """Lines about clock and layout."""
        data = self.metadata
        return [f"packets: {data.profile_name}, {data.rows} rows x {data.columns} columns", self.clock.found()]

    def _add(self, number: int, columns: Packets, time_s: Floats) -> Iterator[Scan]:
        """Adds columns to their frame. The frame before stays open for packets that come late."""
        for frame in self._frames:
            if frame.number == number:
                frame.columns.append(columns)
                frame.time_s.append(time_s)
                frame.size += len(time_s)
                if frame.size > 4 * self.metadata.columns:  # The same frame again and again.
                    self._frames.remove(frame)
                    yield self._scan(frame, last=False)
                return
        step = number - self._frames[-1].number if self._frames else 1
        if -8 <= step < 0:
            self.skipped["columns that came more than a frame late"] += len(time_s)
            return
        if 1 < step < 1000:  # More is a sensor that was started again.
            self.skipped["frames that were lost whole"] += step - 1
        if len(self._frames) == 2:
            yield self._scan(self._frames.pop(0), last=False)
        self._frames.append(_Frame(number, [columns], [time_s], len(time_s)))

    def _scan(self, frame: _Frame, last: bool) -> Scan:
        """The columns of a frame as a scan; `last` is the last frame of the recording."""
        columns, time_s = np.concatenate(frame.columns), np.concatenate(frame.time_s)
        ids, first = np.unique(columns["id"], return_index=True)
        self.skipped["columns received twice"] += len(columns) - len(ids)
        order = (ids.astype(np.int64) - self.metadata.window[0]) % self.metadata.columns
        sort = np.argsort(order)
        order, columns, time_s = order[sort], columns[first[sort]], time_s[first[sort]]
        width = (self.metadata.window[1] - self.metadata.window[0]) % self.metadata.columns + 1
        begin = int(order[0]) if self._scans == 0 else 0  # The recording may begin and end inside a frame.
        end = int(order[-1]) + 1 if last else width
        self.skipped["missing columns (lost packets or marked as not valid)"] += max(0, end - begin - len(order))
        self._scans += 1
        return self._table.scan(self._scans - 1, columns, time_s)


@dataclasses.dataclass
class _Frame:
    number: int
    columns: list[Packets]
    time_s: list[Floats]
    size: int


class _Table:
    """Directions and origins of all beams of a frame in the sensor's frame."""

    def __init__(self, metadata: Metadata) -> None:
        self._profile = metadata.profile
        encoder = -2 * np.pi / metadata.columns * np.arange(metadata.columns)[:, None]
        azimuth = encoder - metadata.azimuth
        axis_m, height_m = metadata.origin_m
        self._before_m = float(np.hypot(axis_m, height_m))  #: Ranges are from the axis; the beam begins here.
        flat, up = np.cos(metadata.elevation), np.sin(metadata.elevation)
        direction = np.stack([np.cos(azimuth) * flat, np.sin(azimuth) * flat, np.broadcast_to(up, azimuth.shape)], -1)
        origin = np.stack([axis_m * np.cos(encoder), axis_m * np.sin(encoder), np.full_like(encoder, height_m)], -1)
        rotation, shift = metadata.sensor_from_lidar[:3, :3], metadata.sensor_from_lidar[:3, 3]
        direction = direction @ rotation.T
        self.direction = direction / np.linalg.norm(direction, axis=-1, keepdims=True)  #: (columns, rows, 3)
        self.origin = np.broadcast_to(origin @ rotation.T + shift, direction.shape)  #: (columns, rows, 3), m.

    def scan(self, number: int, columns: Packets, time_s: Floats) -> Scan:
        """Decodes (n,) `columns` of a frame, whose times are (n,) `time_s`."""
        profile, pixels, rows = self._profile, columns["pixels"], self.direction.shape[1]
        mask = np.uint32((1 << profile.range_bits) - 1)
        counts = np.stack([(pixels[name] & mask).ravel() for name in ("range", "range2")[:profile.returns]])
        beam_rows = rows_of(counts)
        row_beam, row_return = np.arange(counts.shape[1])[beam_rows.beam], beam_rows.which
        count = counts[row_return, row_beam]
        range_m = np.where(count > 0, np.maximum(count * profile.range_step_m - self._before_m, 0.001), np.inf)
        extra: dict[str, npt.NDArray[np.generic]] = {}
        names = {name for name, _, _ in profile.fields}
        for name in ("signal", "reflectivity", "near_ir"):
            if name in names:
                both = np.stack([pixels[name].ravel(), pixels[name + "2" if name + "2" in names else name].ravel()])
                extra[name] = both[row_return, row_beam]
        if "near_ir" in extra:
            extra["near_ir"] = extra["near_ir"].astype(np.uint16) * np.uint16(profile.near_ir_scale)
        column = np.repeat(columns["id"], rows)[row_beam]
        pixel = row_beam % rows
        extra["column"] = column
        intensity = np.where(count > 0, extra.get("signal", extra["reflectivity"]), 0).astype(np.float32)
        return Scan(
            number=number, time_s=float(time_s[0]), direction=self.direction[column, pixel],
            range_m=range_m.astype(np.float32), origin=self.origin[column, pixel],
            beam_time_s=np.repeat(time_s, rows)[row_beam],
            intensity=intensity, ring=pixel.astype(np.uint16), echo=beam_rows.echo, echoes=beam_rows.echoes,
            extra=extra)
