#!/usr/bin/env python3
"""Tests the FMU through ctypes, without a co-simulation master: what it exports, lifetimes, copies, states, and what
it does with inputs and calls that make no sense.

  fmu_test.py --fmu build/underbrush.fmu [--data DATA] [--long]
"""
from __future__ import annotations

import argparse
import ctypes
import math
import os
import pathlib
import re
import resource
import subprocess
import sys
import tempfile
import threading
import typing
import unittest

import osi_bytes as osi
from fmu import CONFIG, DATA_IN, ERROR, OK, REQUEST, Archive, Instance

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
"""
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


class Binary(FmuTest):
    """The library."""

    def test_exports(self) -> None:
        names = subprocess.run(["nm", "-D", "--defined-only", str(self.archive.path)], check=True, capture_output=True,
                               text=True).stdout.split()[2::3]
        self.assertEqual(len(names), 34)
        self.assertTrue(all(name.startswith("fmi2") for name in names), names)

    def test_needs_glibc_only(self) -> None:
        text = subprocess.run(["readelf", "-d", str(self.archive.path)], check=True, capture_output=True,
                              text=True).stdout
        needed = set(re.findall(r"\(NEEDED\).*\[(.*)\]", text))
        self.assertLessEqual(needed, {"libc.so.6", "libm.so.6", "ld-linux-x86-64.so.2"})
        self.assertNotIn("TEXTREL", text)

    def test_version_and_guid(self) -> None:
        self.assertEqual(self.archive.library.fmi2GetVersion(), b"2.0")
        self.assertEqual(self.archive.library.fmi2GetTypesPlatform(), b"default")
        one = self.instance(start=False)
        again = self.archive.library.fmi2Instantiate(b"x", 1, b"{other}", b"", ctypes.byref(one.callbacks), 0, 0)
        self.assertIsNone(again)
        self.assertIn("GUID", one.messages[-1])
        exchange = self.archive.library.fmi2Instantiate(b"x", 0, self.archive.guid.encode(), b"",
                                                        ctypes.byref(one.callbacks), 0, 0)
        self.assertIsNone(exchange)


class Replay(FmuTest):
    """Equal inputs give equal bytes."""

    def test_a_thousand_steps_twice(self) -> None:
        one = self.instance()
        first = self.outputs(1000, one)
        self.assertGreater(len(objects(first[5])), 0)
        self.assertEqual(one.call("Reset"), OK)
        one.now = 0
        one.start()
        self.assertEqual(self.outputs(1000, one), first)

    def test_any_number_of_threads(self) -> None:
        self.assertEqual(self.outputs(50, threads=3), self.outputs(50))
        self.assertNotEqual(self.outputs(50, seed=2), self.outputs(50))

    def test_one_by_one_is_batched(self) -> None:
        a, b = self.instance(), self.instance()
        for k in range(10):
            a.give(drive(k), one_by_one=True)
            self.assertEqual(a.call("DoStep", ctypes.c_double(k * 0.05), ctypes.c_double(0.05), 1), OK)
            self.assertEqual(a.output()[1], b.step(drive(k)))

    def test_two_instances_do_not_meet(self) -> None:
        alone = self.outputs(30), [self.instance().step(drive(0, 1))]
        a, b = self.instance(), self.instance()
        for k in range(30):
            self.assertEqual(a.step(drive(k)), alone[0][k])
            out = b.step(drive(k, 1))
            if k == 0:
                self.assertEqual(out, alone[1][0])

    def test_two_copies_in_one_process(self) -> None:
        copy = Archive(ARGUMENTS.fmu, self.folder / "b")
        self.assertNotEqual(copy.library._handle, self.archive.library._handle)
        a, b = self.instance(), self.instance(copy)
        for k in range(30):
            self.assertEqual(a.step(drive(k)), b.step(drive(k)))

    def test_two_instances_on_two_threads(self) -> None:
        alone = self.outputs(100)
        results: list[list[bytes]] = []
        instances = [self.instance(), self.instance()]
        threads = [threading.Thread(target=lambda i=i: results.append(self.outputs(100, i))) for i in instances]
        for t in threads:
            t.start()
        for t in threads:
            t.join()
        self.assertEqual(results, [alone, alone])

    def test_a_recorded_trace(self) -> None:
        trace = pathlib.Path(ARGUMENTS.data) / "osi/qc_example_sv_trace.osi"
        if not trace.exists():
            self.skipTest("real data 'osi' absent: set UNDERBRUSH_DATA")
        messages = osi.frames(trace.read_bytes())
        runs = []
        for _ in range(2):  # The master steps twice as often as the simulator: 1 094 steps.
            one = self.instance()
            runs.append([one.step(m) for m in messages for _ in range(2)])
        self.assertEqual(runs[0], runs[1])
        self.assertEqual(runs[0][0::2], runs[0][1::2])
        self.assertGreater(sum(len(objects(out)) > 0 for out in runs[0]), 100)


class Lifetimes(FmuTest):
    """Who may use which bytes for how long."""

    def test_an_output_lives_until_the_step_after_the_next(self) -> None:
        one = self.instance()
        for k in range(6):
            one.step(drive(2 * k))
            address, out = one.output()
            one.step(drive(2 * k + 1))  # One more step: the bytes are still there.
            self.assertEqual(ctypes.string_at(address, len(out)), out)
            self.assertNotEqual(one.output()[0], address)

    def test_the_input_is_not_used_after_the_step(self) -> None:
        one, other = self.instance(), self.instance()
        for k in range(5):
            one.give(drive(k))
            self.assertEqual(one.call("DoStep", ctypes.c_double(k * 0.05), ctypes.c_double(0.05), 1), OK)
            held = one.held[-1]
            ctypes.memset(ctypes.addressof(held), 0xFF, len(held))  # type: ignore[arg-type]
            self.assertEqual(one.output()[1], other.step(drive(k)))

    def test_states(self) -> None:
        one = self.instance()
        self.outputs(20, one)
        state = ctypes.c_void_p()
        self.assertEqual(one.call("GetFMUstate", ctypes.byref(state)), OK)
        saved = one.output()[1]
        later = [one.step(drive(k)) for k in range(20, 40)]
        self.assertEqual(one.call("SetFMUstate", state), OK)
        self.assertEqual(one.output()[1], saved)
        self.assertEqual([one.step(drive(k)) for k in range(20, 40)], later)
        other = self.instance()
        self.assertEqual(other.call("SetFMUstate", state), OK)  # Also that of another instance.
        self.assertEqual([other.step(drive(k)) for k in range(20, 40)], later)
        self.assertEqual(one.call("FreeFMUstate", ctypes.byref(state)), OK)
        self.assertIsNone(state.value)

    def test_memory_is_flat(self) -> None:
        one = self.instance()
        steps = 100_000 if ARGUMENTS.long else 1500
        self.outputs(500, one)
        before = memory_kib()
        for k in range(500, 500 + steps):
            one.step(drive(k))
        grown = memory_kib() - before
        print(f"memory: {grown} KiB more after {steps} steps, {before} KiB before", file=sys.stderr)
        self.assertLess(grown, 4096)


def memory_kib() -> int:
    """The memory that the process has now."""
    pages = int(pathlib.Path("/proc/self/statm").read_text(encoding="utf-8").split()[1])
    return pages * resource.getpagesize() // 1024


class Chains(FmuTest):
    """Parts of the chain, and inputs of both kinds."""

    def test_two_in_a_row_are_one(self) -> None:
        first = self.instance(strategies="tracer,front_end,alignment")
        second = self.instance(strategies="tracking,classification,grid")
        whole = self.instance()
        for k in range(40):
            between = first.step(drive(k))
            self.assertEqual(objects(between), [])
            self.assertEqual(second.step(between, DATA_IN), whole.step(drive(k)))

    def test_reflections_are_as_good_as_our_own(self) -> None:
        tracer = self.instance()
        receiver = self.instance(input_mode="reflections")
        for k in range(20):
            out = tracer.step(drive(k))
            view = osi.parts(out, 8)[0]
            self.assertEqual(len(osi.parts(view, 1002)), 1)
            self.assertEqual(objects(receiver.step(view)), objects(out))

    def test_copy_of_the_view(self) -> None:
        with_view, without = self.instance(), self.instance(copy_sensor_view=False)
        a, b = with_view.step(drive(0)), without.step(drive(0))
        self.assertEqual(len(osi.parts(a, 8)), 1)
        self.assertEqual(len(osi.parts(b, 8)), 0)
        self.assertLess(len(b), len(a) - len(drive(0)))

    def test_request_and_config(self) -> None:
        one = self.instance(start=False)
        one.set("profile", str(self.folder / "tiny.yaml"))
        self.assertEqual(one.call("EnterInitializationMode"), OK)
        request = one.output(REQUEST)[1]
        self.assertEqual(len(osi.parts(request, 1002, 11)), osi.value(request, 1002, 10))
        self.assertEqual(one.output(REQUEST), one.output(REQUEST))  # It is not made anew.
        config = osi.VERSION + osi.part(3, osi.vector(1, 1.0, 0.5, 2.0))
        one.give(config, CONFIG)
        self.assertEqual(one.output(REQUEST)[1], config)
        self.assertEqual(one.call("ExitInitializationMode"), OK)
        out = one.step(drive(0))
        self.assertEqual(osi.value(out, 26, 3, 1, 3, 1, 3), 2.0)  # The sensor stands 2 m high.

    def test_confirmed_in_cycle_3(self) -> None:
        one = self.instance()
        counts = [len(objects(one.step(drive(k, 1)))) for k in range(5)]
        self.assertEqual(counts, [0, 0, 1, 1, 1])
        for k in range(5, 8):
            one.step(drive(k, 1))
        hidden = [objects(one.step(drive(k, 0))) for k in range(8, 19)]  # The car is gone.
        self.assertEqual([len(o) for o in hidden], [1] * 9 + [0] * 2)
        self.assertAlmostEqual(float(osi.value(hidden[8][0], 1, 3)), 0.505)
        self.assertEqual(osi.value(hidden[0][0], 1, 5), 3)  # Predicted.
        self.assertAlmostEqual(float(osi.value(hidden[0][0], 1, 4)), 8 * 0.05, 6)  # Age in seconds.

    def test_output_trace(self) -> None:
        path = self.folder / "out.osi"
        one = self.instance(trace_output_path=str(path))
        outputs = self.outputs(5, one)
        self.assertEqual(one.call("Terminate"), OK)
        self.assertEqual(osi.frames(path.read_bytes()), outputs)


class Abuse(FmuTest):
    """Inputs and calls that make no sense are told of, and never end the host."""

    def refused(self, message: bytes | None, reason: str, **parameters: typing.Any) -> None:
        """Gives the message between good ones."""
        one = self.instance(**parameters)
        one.step(drive(0))
        out = one.step(message)
        self.assertIn(reason, one.messages[-1])
        self.assertEqual((qualifier(out), len(objects(out)), one.boolean("valid")), (4, 0, False))
        out = one.step(drive(2))
        self.assertEqual((qualifier(out), one.boolean("valid")), (2, True))

    def test_no_input(self) -> None:
        self.refused(None, "there is no input")
        self.refused(b"", "there is no input")
        one = self.instance()
        for values in ([1, 0, -5], [0, 0, 100], [0, 0, 0]):
            self.assertEqual(one.set_integers([0, 1, 2], values), OK)
            self.assertEqual(one.call("DoStep", ctypes.c_double(one.now), ctypes.c_double(0.05), 1), OK)
            self.assertIn("there is no input", one.messages[-1])

    def test_damaged_input(self) -> None:
        self.refused(drive(1)[:-3], "truncated")
        self.refused(bytes(range(256)), "truncated")
        self.refused(osi.sensor_view(3, [osi.vehicle(5, 1, math.nan, 0, 0, 0)]), "not a finite number")
        self.refused(osi.sensor_view(3, [osi.vehicle(5, 1, 0, math.inf, 0, 0)]), "not a finite number")
        self.refused(osi.part(1, osi.number(1, 9)) + drive(1)[8:], "only version 3")

    def test_missing_parts(self) -> None:
        self.refused(osi.sensor_view(10**8, [osi.vehicle(5, 1, 0, 0, 0, 0)], 99), "no host vehicle")
        self.refused(osi.VERSION + osi.stamp(2, 10**8), "ground truth")
        self.refused(osi.VERSION, "no time")

    def test_wrong_count_of_reflections(self) -> None:
        tracer = self.instance()
        view = osi.parts(tracer.step(drive(0)), 8)[0]
        short = osi.sensor_view(2 * CYCLE_NS, [osi.vehicle(5, 1, 0, 0, 0, 0)], 1,
                                osi.part(1002, osi.part(2), osi.part(2, osi.real(1, -20), osi.real(2, 1e-7))))
        one = self.instance(input_mode="reflections")
        self.assertEqual(qualifier(one.step(view)), 2)
        self.assertEqual(qualifier(one.step(short)), 4)
        self.assertIn("2 reflections for", one.messages[-1])

    def test_a_host_that_is_named_once(self) -> None:
        one = self.instance()
        one.step(drive(0))
        cars = [osi.vehicle(5, 1, 0.5, 0, 0, 10), osi.vehicle(5, 2, 15.6, 0.5, 0, 12)]
        self.assertEqual(qualifier(one.step(osi.sensor_view(2 * CYCLE_NS, cars, None))), 2)

    def test_time(self) -> None:
        one = self.instance()
        first = one.step(drive(5))
        self.assertEqual(one.step(drive(5)), first)  # The same cycle is not another one.
        self.assertEqual(one.messages, [])
        self.assertEqual(qualifier(one.step(drive(4))), 4)
        self.assertIn("goes back", one.messages[-1])
        slow = self.instance(cycle_s=0.1)
        outputs = [slow.step(drive(k)) for k in range(6)]
        self.assertEqual(outputs[0::2], outputs[1::2])

    def test_calls_that_are_not_allowed(self) -> None:
        one = self.instance(start=False)
        self.assertEqual(one.call("DoStep", ctypes.c_double(0), ctypes.c_double(0.05), 1), ERROR)
        self.assertEqual(one.call("ExitInitializationMode"), ERROR)
        self.assertEqual(one.call("Terminate"), ERROR)
        one.start()
        self.assertEqual(one.call("EnterInitializationMode"), ERROR)
        self.assertEqual(one.set("seed", 3), ERROR)
        self.assertEqual(one.set("count", 3), ERROR)
        self.assertEqual(one.set_integers([99999], [3]), ERROR)
        self.assertEqual(one.set_integers([self.archive.reference["cycle_s"]], [3]), ERROR)
        self.assertEqual(one.call("SetInteger", None, ctypes.c_size_t(3), None), ERROR)
        self.assertEqual(one.call("GetString", None, ctypes.c_size_t(1), None), ERROR)
        self.assertEqual(one.call("SetFMUstate", None), ERROR)
        for function in ("GetStatus", "CancelStep", "SerializeFMUstate", "GetDirectionalDerivative"):
            self.assertEqual(one.call(function, 0, None, 0, None, 0, None, None), ERROR)
        self.assertEqual(one.call("DoStep", ctypes.c_double(math.nan), ctypes.c_double(0.05), 1), ERROR)
        self.assertEqual(qualifier(one.step(drive(0))), 2)
        self.assertEqual(one.call("Terminate"), OK)
        self.assertEqual(one.call("DoStep", ctypes.c_double(0), ctypes.c_double(0.05), 1), ERROR)
        self.assertNotIn("BAD FORMAT", one.messages)
        self.assertEqual(self.archive.library.fmi2DoStep(None, ctypes.c_double(0), ctypes.c_double(0.05), 1), ERROR)
        self.archive.library.fmi2FreeInstance(None)

    def test_parameters_that_are_wrong(self) -> None:
        for name, value, reason in (("profile", "no-such-sensor", "no-such-sensor"),
                                    ("chain", "none.yaml", "none.yaml"),
                                    ("input_mode", "both", "input_mode"), ("world", "nowhere", "nowhere"),
                                    ("strategies", "dancing", "strategies"), ("max_echoes", 99, "max_echoes"),
                                    ("tracking", "magic", "pipeline"), ("existence_threshold", 7.0, "threshold"),
                                    ("threads", -1, "threads"), ("trace_output_path", "/nowhere/x.osi", "nowhere")):
            one = self.instance(start=False)
            self.assertEqual(one.set(name, value), OK)
            self.assertEqual(one.call("EnterInitializationMode"), OK)
            self.assertEqual(one.call("ExitInitializationMode"), ERROR, name)
            self.assertIn(reason, one.messages[-1])
            self.assertEqual(one.call("DoStep", ctypes.c_double(0), ctypes.c_double(0.05), 1), ERROR)
            self.assertEqual(one.call("Reset"), OK)
            one.start()
            one.step(drive(0))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--fmu", required=True)
    parser.add_argument("--data", default=os.environ.get("UNDERBRUSH_DATA") or
                        str(pathlib.Path(__file__).resolve().parents[3] / "shared/data"))
    parser.add_argument("--long", action="store_true", help="100 000 steps for the test of memory")
    rest = parser.parse_known_args(namespace=ARGUMENTS)[1]
    unittest.main(argv=[sys.argv[0], *rest])


if __name__ == "__main__":
    main()
