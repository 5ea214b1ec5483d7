"""The FMU's library, and that equal inputs give equal bytes."""
from __future__ import annotations

import ctypes
import pathlib
import re
import subprocess
import threading

import osi_bytes as osi
from cases import ARGUMENTS, FmuTest, drive, objects
from fmu import OK, Archive


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
