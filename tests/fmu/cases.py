"""What the tests of the FMU share: a small sensor, a drive, and the instances of a test."""
from __future__ import annotations

import argparse
import pathlib
import tempfile
import typing
import unittest

import osi_bytes as osi
from fmu import Archive, Instance

#: The options of fmu_test.py.
ARGUMENTS = argparse.Namespace()
SENSOR = """name: tiny
title: A sensor of few beams
kind: raster
shots_per_s: 7200
raster:
  azimuth_deg: [-30, 30]
  elevation_deg: [-4, 2]
  step_deg: [1.2, 0.6]
min_range_m: 0.5
max_range_m: 100
divergence_mrad: [2, 2]
profile: uniform
sub_rays: [3, 5]
"""
#: Of a beam of this sensor.
SUB_RAYS = 3 * 5
CYCLE_NS = 50_000_000


def drive(k: int, movers: int = 2) -> bytes:
    """Cycle k of a drive: the host at 10 m/s behind a car at 12 m/s, with another car that stands on the left."""
    t = k * CYCLE_NS * 1e-9
    cars = [osi.vehicle(5, 1, 10 * t, 0, 0, 10), osi.vehicle(5, 2, 15 + 12 * t, 0.5, 0, 12),
            osi.vehicle(5, 3, 40, 6, 0.3, 0)]
    return osi.sensor_view((k + 1) * CYCLE_NS, cars[:movers + 1])


def objects(data: bytes) -> list[bytes]:
    """The encoded objects of a SensorData."""
    return osi.parts(data, 13)


def qualifier(data: bytes) -> int:
    """The quality of the list of objects: 2 = available, 4 = not available."""
    return int(osi.value(data, 12, 3))


class FmuTest(unittest.TestCase):
    """What all tests share."""
    archive: Archive
    folder: pathlib.Path
    _temporary: tempfile.TemporaryDirectory[str]

    @classmethod
    def setUpClass(cls) -> None:
        cls._temporary = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls._temporary.name)
        cls.archive = Archive(ARGUMENTS.fmu, cls.folder / "a")
        (cls.folder / "tiny.yaml").write_text(SENSOR, encoding="utf-8")

    @classmethod
    def tearDownClass(cls) -> None:
        cls._temporary.cleanup()

    def instance(self, archive: Archive | None = None, start: bool = True, **parameters: typing.Any) -> Instance:
        """An instance with the small sensor, which is freed when the test ends."""
        made = Instance(archive or self.archive, {"profile": str(self.folder / "tiny.yaml"), **parameters}, start)
        self.addCleanup(made.free)
        return made

    def outputs(self, count: int, instance: Instance | None = None, **parameters: typing.Any) -> list[bytes]:
        """The outputs of the first cycles of the drive."""
        one = instance or self.instance(**parameters)
        return [one.step(drive(k)) for k in range(count)]
