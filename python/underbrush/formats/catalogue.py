"""Sensor files of the catalogue (`share/sensors/*.yaml`), whose keys docs/reference/sensor-files.md explains."""
from __future__ import annotations

import dataclasses
import functools
import pathlib
from typing import Any

import numpy as np
import numpy.typing as npt
import yaml

Floats = npt.NDArray[np.float64]


@dataclasses.dataclass(frozen=True)
class SpinningSensor:
    """What a decoder of packets takes from a sensor file. Rings are in the file's order."""

    name: str
    title: str
    period_s: float  #: Time in which all channels fire once.
    firings_per_packet: int
    start_azimuth_deg: float  #: Where a revolution begins.
    resolution_m: float  #: Step of the reported range.
    elevation_deg: Floats  #: (rings,)
    azimuth_deg: Floats  #: (rings,), counter-clockwise from the firing's azimuth.
    time_s: Floats  #: (rings,), after the start of the firing.
    z_m: Floats  #: (rings,), height of the beam's origin above the sensor's.


def folder() -> pathlib.Path:
    """The folder of the sensor files: inside the installed package, else in the source tree."""
    here = pathlib.Path(__file__).resolve()
    places = (here.parents[1] / "share" / "underbrush" / "sensors", here.parents[3] / "share" / "sensors")
    return next((place for place in places if place.is_dir()), places[0])


def names() -> list[str]:
    """Names of all sensors of the catalogue."""
    return sorted(path.stem for path in folder().glob("*.yaml"))


@functools.cache
def load(name: str) -> SpinningSensor:
    """The spinning or sweeping sensor `name` of the catalogue. Raises ValueError where there is none."""
    path = folder() / f"{name}.yaml"
    if not path.is_file():
        raise ValueError(f"sensor '{name}' is not in the catalogue; it has {', '.join(names())}")
    file = yaml.safe_load(path.read_text(encoding="utf-8"))
    if file["kind"] not in ("spinning", "sweep"):
        raise ValueError(f"sensor '{name}' does not spin")
    channels = file["channels"]
    elevation = _column(channels["elevation_deg"])

    def column(key: str) -> Floats:
        return _column(channels.get(key, np.zeros(len(elevation))))

    return SpinningSensor(
        name, file["title"], file["firing_period_us"] * 1e-6, file.get("firings_per_packet", 1),
        file.get("start_azimuth_deg", 180.0), file["range_resolution_m"], elevation, column("azimuth_deg"),
        column("time_us") * 1e-6, column("z_mm") * 1e-3)


def _column(values: Any) -> Floats:
    """A value for each channel: a list, or the first and the last value of equal steps."""
    if isinstance(values, dict):
        return np.linspace(values["first"], values["last"], values["count"])
    return np.asarray(values, dtype=np.float64)
