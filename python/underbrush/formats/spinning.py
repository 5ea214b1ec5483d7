"""What decoders of spinning sensors share: firings of their lasers, cut into revolutions, become scans."""
from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from typing import Protocol

import numpy as np
import numpy.typing as npt

from underbrush.formats.returns import rows_of
from underbrush.formats.scans import Scan

Floats = npt.NDArray[np.float64]
Counts = npt.NDArray[np.uint16]

_LONGEST_S = 0.4  #: A scan of a sensor that stands still ends then; the slowest revolution takes 0.2 s.


@dataclasses.dataclass
class Firings:
    """Firings, in order of time. In each of them, some or all lasers fire."""

    azimuth_deg: Floats  #: (n,), clockwise from forward, at the start.
    rate_deg_s: Floats  #: (n,)
    time_s: Floats  #: (n,)
    turn: Floats  #: (n,), number of the revolution.
    state: npt.NDArray[np.intp]  #: (n,), the row of the firing times that holds.
    unknown: npt.NDArray[np.bool_]  #: (n, lasers), beams of whose end nothing is known; they are left out.
    range: Counts  #: (n, returns, lasers), in steps of the range; 0 is a miss.
    intensity: npt.NDArray[np.uint8]  #: (n, returns, lasers)

    def __len__(self) -> int:
        return len(self.turn)

    def part(self, begin: int, end: int) -> Firings:
        return Firings(*(getattr(self, field.name)[begin:end] for field in dataclasses.fields(self)))


class Angles(Protocol):
    """Directions of the lasers of a sensor, and corrections of their ranges."""

    @property
    def has_ranges(self) -> bool:
        """As `Calibration.has_ranges`."""

    def beams(self, azimuth: Floats, /) -> tuple[Floats, Floats | None]:
        """As `Calibration.beams`."""

    def corrected(self, direction: Floats, range_m: npt.NDArray[np.float32], laser: npt.NDArray[np.int64], /) -> tuple[
            Floats, npt.NDArray[np.float32]]:
        """As `Calibration.corrected`."""


class Revolutions:
    """Turns firings into scans, one a revolution; rows are in order of firing, then of the lasers' times."""

    def __init__(self, calibration: Angles, ring: npt.NDArray[np.int64], laser_s: Floats, period_s: float,
                 resolution_m: float) -> None:
        """`ring` is (lasers,), and `laser_s` (lasers,) or (states, lasers): the time (s) after the start of a firing.

        A firing takes `period_s`. In a state in which its time is NaN, a laser does not fire, and what firings have of
        it has no meaning. `resolution_m` is the step of the range.
        """
        self._calibration, self._ring, self._laser_s = calibration, ring.astype(np.uint16), np.atleast_2d(laser_s)
        self._period_s, self._resolution_m = period_s, resolution_m
        self._pending: list[Firings] = []
        self._scans = 0

    def cut(self, firings: Firings) -> Iterator[Scan]:
        """Yields the scans that end before or in `firings`; keeps the rest."""
        edges = [0, *(np.flatnonzero(np.diff(firings.turn)) + 1), len(firings)]
        for begin, end in zip(edges[:-1], edges[1:]):
            part = firings.part(int(begin), int(end))
            if self._pending and len(part):
                last = self._pending[-1]
                held = sum(len(pending) for pending in self._pending)
                if (last.turn[-1] != part.turn[0] or last.range.shape[1] != part.range.shape[1]
                        or held * self._period_s > _LONGEST_S):
                    yield from self._scan()
            if len(part):
                self._pending.append(part)

    def finish(self) -> Iterator[Scan]:
        """Yields the last scan."""
        if self._pending:
            yield from self._scan()

    def _scan(self) -> Iterator[Scan]:
        """Yields the pending firings as a scan, unless no laser of them has measured anything."""
        parts, self._pending = self._pending, []
        joined = Firings(*(np.concatenate([getattr(part, field.name) for part in parts])
                           for field in dataclasses.fields(Firings)))
        after_s = self._laser_s[joined.state]
        time_s = (joined.time_s[:, None] + after_s).ravel()
        clockwise = np.radians(joined.azimuth_deg[:, None] + joined.rate_deg_s[:, None] * after_s)
        direction, origin = self._calibration.beams(-clockwise)
        counts, shades = (values.swapaxes(0, 1).reshape(values.shape[1], -1)
                          for values in (joined.range, joined.intensity))
        laser = np.tile(np.arange(len(self._ring)), len(joined))
        if len(self._laser_s) > 1 or not np.isfinite(self._laser_s).all() or joined.unknown.any():
            # The lasers that count, and their order, differ from firing to firing.
            first = np.arange(len(joined))[:, None] * len(self._ring)
            order = (first + np.argsort(self._laser_s, axis=1, kind="stable")[joined.state]).ravel()
            order = order[np.isfinite(time_s[order]) & ~joined.unknown.ravel()[order]]
            if not len(order):
                return
            time_s, direction, laser = time_s[order], direction[order], laser[order]
            counts, shades, origin = counts[:, order], shades[:, order], None if origin is None else origin[order]
        rows = rows_of(counts)
        count = counts[rows.which, rows.beam]
        laser = laser[rows.beam]
        direction, origin = direction[rows.beam], None if origin is None else origin[rows.beam]
        range_m = count * np.float32(self._resolution_m)
        range_m[count == 0] = np.inf
        if self._calibration.has_ranges:
            direction, range_m = self._calibration.corrected(direction, range_m, laser)
        intensity = np.where(count > 0, shades[rows.which, rows.beam], 0).astype(np.float32)
        time_s = time_s[rows.beam]
        self._scans += 1
        yield Scan(number=self._scans - 1, time_s=float(time_s[0]), direction=direction, range_m=range_m,
                   origin=origin, beam_time_s=time_s, intensity=intensity, ring=self._ring[laser], echo=rows.echo,
                   echoes=rows.echoes)
