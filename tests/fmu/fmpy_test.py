#!/usr/bin/env python3
"""Tests the FMU in FMPy, a co-simulation master, and its messages with OSI's official Python package.

  fmpy_test.py --build build --program build/bin/underbrush

The packages live in a virtual environment under the build folder; where pip cannot fetch them, the exit status is 77.
"""
from __future__ import annotations

import argparse
import importlib
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import typing
import unittest
import zipfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
PACKAGES = ["fmpy", "osi-python", "numpy"]
ARGUMENTS = argparse.Namespace()
STEPS = 1000


def in_environment() -> None:
    """Runs this file again with the Python of an environment that has the packages."""
    sys.path.insert(0, str(ROOT / "python/tests"))
    environment = importlib.import_module("environment")
    try:
        python = environment.environment(pathlib.Path(ARGUMENTS.build) / "fmu_venv", PACKAGES, compiled=False)
    except environment.Missing as missing:
        print(missing)
        sys.exit(77)
    os.execv(python, [str(python), *sys.argv, "--ready"])


def use_single_rays(folder: pathlib.Path) -> None:
    """Makes the chain of an unpacked FMU trace one ray a beam instead of the sensor's sub-rays."""
    chain = folder / "resources/chain.yaml"
    sensor = "    sensor: ibeo-lux-2010\n"
    text = chain.read_text(encoding="utf-8")
    assert text.count(sensor) == 2
    chain.write_text(text.replace(sensor, sensor + "    columns: 1\n    rows: 1\n"), encoding="utf-8")


class Master(unittest.TestCase):
    """The FMU as FMPy sees it."""
    fmpy: typing.Any
    fmi2: typing.Any
    fmi3: typing.Any
    osi: typing.Any
    view: typing.Any
    fmu: str
    fmu3: str

    @classmethod
    def setUpClass(cls) -> None:
        cls.fmpy = importlib.import_module("fmpy")
        cls.fmi2 = importlib.import_module("fmpy.fmi2")
        cls.fmi3 = importlib.import_module("fmpy.fmi3")
        cls.osi = importlib.import_module("osi3.osi_sensordata_pb2")
        cls.view = importlib.import_module("osi3.osi_sensorview_pb2")
        cls.fmu = str(pathlib.Path(ARGUMENTS.build) / "underbrush.fmu")
        cls.fmu3 = str(pathlib.Path(ARGUMENTS.build) / "underbrush3.fmu")

    def test_are_valid(self) -> None:
        validation = importlib.import_module("fmpy.validation")
        for fmu in (self.fmu, self.fmu3):
            self.assertEqual(validation.validate_fmu(fmu), [])
            self.assertEqual(self.fmpy.supported_platforms(fmu), ["linux64"])

    def test_runs_without_inputs(self) -> None:
        messages: list[str] = []
        result = self.fmpy.simulate_fmu(self.fmu, stop_time=1.0, output=["count", "valid"], debug_logging=False,
                                        logger=lambda *words: messages.append(words[4].decode()))
        self.assertEqual(len(result), 21)
        self.assertFalse(any(result["valid"]))
        self.assertTrue(any("there is no input" in message for message in messages))

    def test_a_row_of_two_copies_as_the_example_of_ssp_has_it(self) -> None:
        """FMPy leaves the parameters in the example out, so that both copies run all strategies. The test is the first
        by its name, because FMPy's logger ends the process after a run with another logger."""
        import ctypes
        ssp = importlib.import_module("fmpy.ssp.simulation")
        step_s, steps = 0.05, 10
        buffers = []
        for k in range(steps):
            view = self.view.SensorView()
            view.version.version_major = 3
            view.timestamp.nanos = (k + 1) * 50_000_000
            view.host_vehicle_id.value = 1
            for number, x in ((1, 0.0), (2, 15.0 + 0.2 * k)):
                car = view.global_ground_truth.moving_object.add()
                car.id.value, car.type = number, car.TYPE_VEHICLE
                car.base.position.x, car.base.position.z = x, 0.75
                car.base.dimension.length, car.base.dimension.width, car.base.dimension.height = 4.6, 1.8, 1.5
                car.vehicle_classification.type = car.vehicle_classification.TYPE_MEDIUM_CAR
            data = view.SerializeToString()
            buffers.append((ctypes.create_string_buffer(data, len(data)), len(data)))

        def part(of: typing.Callable[[int, int], int]) -> typing.Callable[[float], int]:
            def value(time_s: float) -> int:
                buffer, size = buffers[min(steps - 1, int(time_s / step_s + 0.5))]
                return of(ctypes.addressof(buffer), size)
            return value
        inputs = {"base.lo": part(lambda address, _: ctypes.c_int32(address & 0xFFFFFFFF).value),
                  "base.hi": part(lambda address, _: address >> 32), "size": part(lambda _, size: size)}
        with tempfile.TemporaryDirectory() as folder:
            archive = pathlib.Path(folder) / "lidar.ssp"
            with zipfile.ZipFile(archive, "w") as file:
                file.write(ROOT / "share/examples/SystemStructure.ssd", "SystemStructure.ssd")
                file.write(self.fmu, "resources/underbrush.fmu")
            result = ssp.simulate_ssp(str(archive), stop_time=step_s * (steps - 1), step_size=step_s,
                                      input={f"OSMPSensorViewIn.{name}": f for name, f in inputs.items()})
        self.assertEqual(result["count"][-1], 1)  # the car ahead

    def outputs(self, views: list[bytes], steps: int, *, single_rays: bool) -> typing.Iterator[bytes]:
        """The outputs of a run; each view is given as many times as makes so many steps. With all sub-rays, an output
        has the reflections of 290 000 rays, which are 12 MB."""
        import ctypes
        description = self.fmpy.read_model_description(self.fmu)
        with tempfile.TemporaryDirectory() as folder:
            self.fmpy.extract(self.fmu, folder)
            if single_rays:
                use_single_rays(pathlib.Path(folder))
            one = self.fmi2.FMU2Slave(guid=description.guid, unzipDirectory=folder, modelIdentifier="underbrush",
                                      instanceName="one")
            one.instantiate()
            one.setupExperiment(startTime=0.0)
            one.enterInitializationMode()
            one.exitInitializationMode()
            for k in range(steps):
                view = views[k * len(views) // steps]
                held = ctypes.create_string_buffer(view, len(view))
                address = ctypes.addressof(held)
                one.setInteger([0, 1, 2], [ctypes.c_int32(address & 0xFFFFFFFF).value, address >> 32, len(view)])
                one.doStep(currentCommunicationPoint=k * 0.02, communicationStepSize=0.02)
                low, high, size = one.getInteger([3, 4, 5])
                yield ctypes.string_at((high & 0xFFFFFFFF) << 32 | low & 0xFFFFFFFF, size)
            one.terminate()
            one.freeInstance()

    def outputs3(self, views: list[bytes], steps: int, *, single_rays: bool) -> typing.Iterator[bytes]:
        """The outputs of the first steps of such a run in FMI 3.0."""
        description = self.fmpy.read_model_description(self.fmu3)
        reference = {v.name: v.valueReference for v in description.modelVariables}
        with tempfile.TemporaryDirectory() as folder:
            self.fmpy.extract(self.fmu3, folder)
            if single_rays:
                use_single_rays(pathlib.Path(folder))
            one = self.fmi3.FMU3Slave(guid=description.instantiationToken, unzipDirectory=folder,
                                      modelIdentifier="underbrush", instanceName="one")
            one.instantiate()
            one.enterInitializationMode()
            one.exitInitializationMode()
            for k in range(steps):
                one.setBinary([reference["OSMPSensorViewIn"]], [views[k * len(views) // steps]])
                one.doStep(currentCommunicationPoint=k * 0.02, communicationStepSize=0.02)
                yield one.getBinary([reference["OSMPSensorDataOut"]])[0]
            one.terminate()
            one.freeInstance()

    def views(self) -> list[bytes]:
        """A drive of 20 s, encoded by OSI's own package."""
        views = []
        for k in range(400):
            t = 0.05 * (k + 1)
            view = self.view.SensorView()
            view.version.version_major, view.version.version_minor, view.version.version_patch = 3, 5, 0
            for stamp in (view.timestamp, view.global_ground_truth.timestamp):
                stamp.seconds, stamp.nanos = divmod((k + 1) * 50_000_000, 10**9)
            view.sensor_id.value = 4
            view.host_vehicle_id.value = view.global_ground_truth.host_vehicle_id.value = 0
            for number, x, y in ((0, 8 * t, 0.0), (5, 12 + 8.5 * t, 0.4), (6, 60.0, 5.0)):
                car = view.global_ground_truth.moving_object.add()
                car.id.value, car.type = number, 2
                car.base.position.x, car.base.position.y, car.base.position.z = x, y, 0.75
                car.base.dimension.length, car.base.dimension.width, car.base.dimension.height = 4.6, 1.8, 1.5
                car.base.orientation.yaw = 0.0
                car.vehicle_classification.type = 4
            lane = view.global_ground_truth.lane.add()
            lane.id.value = 99
            views.append(view.SerializeToString())
        return views

    def test_a_thousand_steps(self) -> None:
        trace = pathlib.Path(ARGUMENTS.data) / "osi/qc_example_sv_trace.osi"
        views = self.views()
        if trace.exists():
            views = importlib.import_module("osi_bytes").frames(trace.read_bytes())
        for steps, single_rays in ((STEPS, True), (STEPS // 20, False)):
            done = objects = 0
            for out, again, other in zip(*(run(views, steps, single_rays=single_rays)
                                           for run in (self.outputs, self.outputs, self.outputs3)), strict=True):
                self.assertTrue(out == again == other, done)
                objects += len(self.osi.SensorData.FromString(out).moving_object)
                done += 1
            self.assertEqual(done, steps)
            self.assertGreater(objects, steps / 2)

    def test_messages_are_those_of_the_official_package(self) -> None:
        views = self.views()
        for out in self.outputs(views, STEPS // 20, single_rays=False):
            data = self.osi.SensorData.FromString(out)
            self.assertEqual(data.SerializeToString(deterministic=True), out)
            self.check(data)

    def check(self, data: typing.Any) -> None:
        """Holds a SensorData against the rules that OSI's comments give."""
        for name in ("version", "timestamp", "sensor_id", "mounting_position", "last_measurement_time",
                     "moving_object_header"):
            self.assertTrue(data.HasField(name), name)
        self.assertEqual(data.version.version_major, 3)
        self.assertEqual(len(data.sensor_view), 1)
        for item in data.moving_object:
            self.assertTrue(item.header.HasField("tracking_id"))
            self.assertTrue(0 <= item.header.existence_probability <= 1)
            self.assertTrue(0 <= item.header.age <= 20)
            self.assertIn(item.header.measurement_state, (2, 3))
            self.assertGreater(len(item.header.sensor_id), 0)
            self.assertAlmostEqual(sum(c.probability for c in item.candidate), 1, 5)
            self.assertTrue(-3.15 <= item.base.orientation.yaw <= 3.15)
            self.assertGreater(min(item.base.dimension.length, item.base.dimension.width), 0)
        for lidar in data.feature_data.lidar_sensor:
            self.assertEqual(lidar.header.number_of_valid_detections, len(lidar.detection))
            for hit in lidar.detection:
                self.assertTrue(0 <= hit.intensity <= 100 and 0 < hit.position.distance <= 300)
        logical = data.logical_detection_data
        self.assertEqual(logical.header.number_of_valid_logical_detections, len(logical.logical_detection))

    def test_the_page(self) -> None:
        page = (ROOT / "docs/how-to/co-simulation.md").read_text(encoding="utf-8")
        blocks = re.findall(r"<!-- run: fmpy -->\n```python\n(.*?)^```", page, re.M | re.S)
        self.assertEqual(len(blocks), 2)
        with tempfile.TemporaryDirectory() as folder:
            for fmu in (self.fmu, self.fmu3):
                path = pathlib.Path(fmu).resolve()
                (pathlib.Path(folder) / path.name).symlink_to(path)
            done = [subprocess.run([sys.executable, "-c", block], cwd=folder, check=False, capture_output=True,
                                   text=True) for block in (blocks[0], blocks[0] + blocks[1])]
        self.assertEqual([one.returncode for one in done], [0, 0], done[0].stderr + done[1].stderr)
        self.assertRegex(done[0].stdout, r"\d+\.\d m ahead, 0\.45 s old, [34]\.\d m/s faster")
        self.assertEqual(done[1].stdout, done[0].stdout + "the same bytes\n")

    def test_traces_of_the_official_package_are_read(self) -> None:
        import json
        import struct
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "drive_sv_.osi"
            path.write_bytes(b"".join(struct.pack("<I", len(v)) + v for v in self.views()))
            done = subprocess.run([ARGUMENTS.program, "osi", "info", str(path), "--json", "-"], check=True,
                                  capture_output=True, text=True)
            found = json.loads(done.stdout)
        self.assertEqual((found["messages"], found["moving_objects"], found["lanes"], found["host_vehicle_id"]),
                         (400, 3, 1, 0))
        self.assertEqual(found["versions"], ["3.5.0"])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", required=True)
    parser.add_argument("--program", required=True)
    parser.add_argument("--data", default=os.environ.get("UNDERBRUSH_DATA") or str(ROOT.parent / "shared/data"))
    parser.add_argument("--ready", action="store_true", help=argparse.SUPPRESS)
    rest = parser.parse_known_args(namespace=ARGUMENTS)[1]
    if not ARGUMENTS.ready:
        in_environment()
    unittest.main(argv=[sys.argv[0], *rest])


if __name__ == "__main__":
    main()
