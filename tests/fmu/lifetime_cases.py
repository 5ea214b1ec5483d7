"""Who may use which bytes for how long, saved states, and memory."""
from __future__ import annotations

import ctypes
import pathlib
import resource
import sys

from cases import ARGUMENTS, FmuTest, drive
from fmu import OK


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
