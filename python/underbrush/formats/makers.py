"""The makers whose packets are recognised by their content, and what their decoders have in common."""
from __future__ import annotations

import collections
import pathlib
from collections.abc import Callable, Iterator
from typing import NamedTuple, Protocol

import numpy as np
import numpy.typing as npt

from underbrush.formats import hesai, livox, velodyne
from underbrush.formats.scans import Scan
from underbrush.formats.velodyne_calibration import Calibration

Floats = npt.NDArray[np.float64]


class Decoder(Protocol):
    """What the decoder of a maker offers. It counts what it leaves out."""

    sensor: str  #: Name in the sensor catalogue; empty where it has none.
    title: str  #: Name for people.
    modes: set[str]  #: Return modes so far, in words.
    packet_bytes: int
    organised: bool  #: Whether scans keep the beams without a return.

    def unfit(self, data: bytes) -> str:
        """Why a packet is not decoded; empty where it is."""

    def decode(self, data: list[bytes], captured_s: Floats, /) -> Iterator[Scan]:
        """Yields the scans that end in n packets, which were captured at (n,) `captured_s`."""

    def finish(self) -> Iterator[Scan]:
        """Yields the last scans."""

    def found(self) -> list[str]:
        """Lines about clock and angles."""


class Probe(NamedTuple):
    """What a decoder is made of: the first packets with their times of capture, and what the user gave."""

    data: list[bytes]
    captured_s: Floats
    sensor: str | None
    metadata: pathlib.Path | None  #: File of angles.
    reference_s: float
    clock: str


def _velodyne(first: Probe, skipped: collections.Counter[str]) -> Decoder:
    calibration = None if first.metadata is None else Calibration.read(first.metadata)
    return velodyne.Decoder(first.data, first.captured_s, skipped, first.sensor, calibration, first.reference_s,
                            first.clock)


def _hesai(first: Probe, skipped: collections.Counter[str]) -> Decoder:
    return hesai.Decoder(first.data, first.captured_s, skipped, first.sensor, first.metadata, first.clock)


def _livox(first: Probe, skipped: collections.Counter[str]) -> Decoder:
    if first.metadata is not None:
        raise ValueError(f"packets of a Livox contain all directions; leave out --metadata {first.metadata}")
    return livox.Decoder(first.data, first.captured_s, skipped, first.sensor, first.clock)


class Maker(NamedTuple):
    """A maker whose packets are recognised by their content."""

    recognise: Callable[[bytes], bool]
    decoder: Callable[[Probe, collections.Counter[str]], Decoder]


MAKERS = (Maker(velodyne.recognise, _velodyne), Maker(hesai.recognise, _hesai), Maker(livox.recognise, _livox))
