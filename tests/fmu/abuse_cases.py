"""Inputs and calls that make no sense."""
from __future__ import annotations

import ctypes
import math
import typing

import osi_bytes as osi
from cases import CYCLE_NS, FmuTest, drive, objects, qualifier
from fmu import ERROR, OK


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

    def test_addresses_that_lead_nowhere(self) -> None:
        one = self.instance()
        good = drive(0)
        for low, high, size in ((16, 0, 1), (16, 0, 2**31 - 1), (-1, -1, 100), (0, 1 << 20, 100), (0, -2**31, 1)):
            self.assertEqual(one.set_integers([0, 1, 2], [low, high, size]), OK)
            self.assertEqual(one.call("DoStep", ctypes.c_double(0), ctypes.c_double(0.05), 1), OK)
            self.assertIn("lead to no memory", one.messages[-1])
            self.assertFalse(one.boolean("valid"))
        self.assertEqual(qualifier(one.step(good)), 2)

    def test_states_that_are_none(self) -> None:
        one = self.instance()
        state = ctypes.c_void_p()
        self.assertEqual(one.call("GetFMUstate", ctypes.byref(state)), OK)
        copy = ctypes.c_void_p(state.value)
        self.assertEqual(one.call("FreeFMUstate", ctypes.byref(state)), OK)
        for odd in (copy.value, 8, ctypes.addressof(copy)):
            self.assertEqual(one.call("SetFMUstate", ctypes.c_void_p(odd)), ERROR)
            self.assertEqual(one.call("FreeFMUstate", ctypes.byref(ctypes.c_void_p(odd))), ERROR)
            other = ctypes.c_void_p(odd)
            self.assertEqual(one.call("GetFMUstate", ctypes.byref(other)), OK)
            self.assertEqual(one.call("FreeFMUstate", ctypes.byref(other)), OK)

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
                                    ("threads", -1, "threads"), ("seed", -1, "seed"), ("cycle_s", -1.0, "cycle_s"),
                                    ("threshold_snr", -0.5, "threshold_snr"),
                                    ("latency_ms", -5.0, "latency_ms"), ("trace_output_path", "/nowhere/x.osi", "nowhere")):
            one = self.instance(start=False)
            self.assertEqual(one.set(name, value), OK)
            self.assertEqual(one.call("EnterInitializationMode"), OK)
            self.assertEqual(one.call("ExitInitializationMode"), ERROR, name)
            self.assertIn(reason, one.messages[-1])
            self.assertEqual(one.call("DoStep", ctypes.c_double(0), ctypes.c_double(0.05), 1), ERROR)
            self.assertEqual(one.call("Reset"), OK)
            one.start()
            one.step(drive(0))
