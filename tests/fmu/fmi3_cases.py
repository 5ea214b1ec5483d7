"""The FMU of FMI 3.0: it gives the bytes of that of FMI 2.0, with native binary variables."""
from __future__ import annotations

import ctypes
import math
import pathlib
import re
import subprocess
import typing

from cases import ARGUMENTS, FmuTest, drive, objects, qualifier
from fmi3 import ERROR, OK, Archive3, Instance3


class Fmi3(FmuTest):
    """Both versions of FMI, side by side."""
    archive3: Archive3

    @classmethod
    def setUpClass(cls) -> None:
        super().setUpClass()
        cls.archive3 = Archive3(ARGUMENTS.fmi3, cls.folder / "three")

    def instance3(self, start: bool = True, **parameters: typing.Any) -> Instance3:
        """An instance with the small sensor, which is freed when the test ends."""
        made = Instance3(self.archive3, {"profile": str(self.folder / "tiny.yaml"), **parameters}, start)
        self.assertTrue(made.component.value, made.messages)
        self.addCleanup(made.free)
        return made

    def test_the_bytes_of_fmi_2(self) -> None:
        choices: tuple[dict[str, typing.Any], ...] = (
            {}, {"tracking": "real", "seed": 3}, {"strategies": "tracer,front_end", "threads": 2})
        for parameters in choices:
            one, two = self.instance3(**parameters), self.instance(**parameters)
            for k in range(30):
                self.assertEqual(one.step(drive(k)), two.step(drive(k)))

    def test_two_in_a_row_are_one(self) -> None:
        first = self.instance3(strategies="tracer,front_end,alignment")
        second = self.instance3(strategies="tracking,classification,grid")
        whole = self.instance3()
        for k in range(20):
            between = first.step(drive(k))
            self.assertEqual(second.step(between, "OSMPSensorDataIn"), whole.step(drive(k)))

    def test_exports(self) -> None:
        text = subprocess.run(["nm", "-D", "--defined-only", str(self.archive3.path)], check=True,
                              capture_output=True, text=True).stdout
        names = set(text.split()[2::3])
        self.assertEqual(len(names), 75)
        self.assertTrue(all(name.startswith("fmi3") for name in names), names)
        needed = set(re.findall(r"\(NEEDED\).*\[(.*)\]", subprocess.run(
            ["readelf", "-d", str(self.archive3.path)], check=True, capture_output=True, text=True).stdout))
        self.assertLessEqual(needed, {"libc.so.6", "libm.so.6", "ld-linux-x86-64.so.2"})

    def test_variables_are_those_of_fmi_2(self) -> None:
        names = {re.sub(r"\.(base\.lo|base\.hi|size)$", "", name) for name in self.archive.reference}
        self.assertEqual(set(self.archive3.reference), names | {"time"})

    def test_instantiation(self) -> None:
        library = self.archive3.library
        self.assertEqual(library.fmi3GetVersion(), b"3.0")
        self.assertIsNone(library.fmi3InstantiateModelExchange())
        self.assertIsNone(library.fmi3InstantiateScheduledExecution())
        for refused, reason in ((Instance3(self.archive3, start=False, token="{other}"), "token"),
                                (Instance3(self.archive3, start=False, events=True), "event mode")):
            self.assertIsNone(refused.component.value)
            self.assertIn(reason, refused.messages[-1])

    def test_time(self) -> None:
        one = self.instance3()
        self.assertEqual(one.number("time"), 0)
        one.step(drive(0))
        self.assertEqual(one.number("time"), 0.05)
        self.assertEqual(one.set("time", 3.0), ERROR)

    def test_states_hold_the_inputs(self) -> None:
        one, other = self.instance3(), self.instance3()
        for k in range(5):
            one.step(drive(k))
        self.assertEqual(one.set("OSMPSensorViewIn", drive(5)), OK)
        state = ctypes.c_void_p()
        self.assertEqual(one.call("GetFMUState", ctypes.byref(state)), OK)
        later = [one.do_step(), one.binary()]
        one.step(drive(9))
        for restored in (one, other):
            self.assertEqual(restored.call("SetFMUState", state), OK)
            restored.now = 0.25
            self.assertEqual([restored.do_step(), restored.binary()], later)
        self.assertEqual(one.call("FreeFMUState", ctypes.byref(state)), OK)
        self.assertIsNone(state.value)

    def test_reset_is_a_new_start(self) -> None:
        one = self.instance3()
        first = [one.step(drive(k)) for k in range(10)]
        self.assertEqual(one.call("Reset"), OK)
        one.now = 0
        one.start()
        self.assertEqual([one.step(drive(k)) for k in range(10)], first)

    def test_request(self) -> None:
        one, two = self.instance3(start=False), self.instance(start=False)
        for instance in (one, two):
            self.assertEqual(instance.set("profile", str(self.folder / "tiny.yaml")), OK)
        self.assertEqual((one.initialize(), two.call("EnterInitializationMode")), (OK, OK))
        request = one.binary("OSMPSensorViewInConfigRequest")
        self.assertEqual(request, two.output(two.archive.reference["OSMPSensorViewInConfigRequest.base.lo"])[1])
        self.assertGreater(len(request), 100)

    def test_abuse(self) -> None:
        one = self.instance3(start=False)
        self.assertEqual(one.do_step(), ERROR)
        one.start()
        for message, reason in ((b"", "there is no input"), (drive(1)[:-3], "truncated")):
            out = one.step(message)
            self.assertIn(reason, one.messages[-1])
            self.assertEqual((qualifier(out), objects(out)), (4, []))
        self.assertEqual(qualifier(one.step(drive(2))), 2)
        self.assertEqual(one.set("seed", 3), ERROR)
        self.assertEqual(one.set("OSMPSensorDataOut", b"x"), ERROR)
        self.assertEqual(one.initialize(), ERROR)
        two, three = ctypes.c_size_t(2), ctypes.c_size_t(3)
        references = (ctypes.c_uint * 2)(self.archive3.reference["OSMPSensorViewIn"], 1)
        self.assertEqual(one.call("SetBinary", references, two, (ctypes.c_size_t * 2)(), (ctypes.c_void_p * 2)(), two),
                         ERROR)  # There is no variable 1 here: a binary variable has one reference.
        self.assertEqual(one.call("SetBinary", references, two, None, None, three), ERROR)
        self.assertEqual(one.call("GetBinary", None, two, None, None, two), ERROR)
        for function in ("GetInt64", "SetClock", "EnterEventMode", "UpdateDiscreteStates", "SerializeFMUState",
                         "GetDirectionalDerivative", "EnterConfigurationMode", "ActivateModelPartition"):
            self.assertEqual(one.call(function, None, ctypes.c_size_t(0), None, None, None, None), ERROR)
        one.now = math.nan
        self.assertEqual(one.do_step(), ERROR)
        self.assertEqual(one.call("Terminate"), OK)
        self.assertEqual(one.library.fmi3GetVersion(), b"3.0")
        self.assertEqual(one.library.fmi3Reset(None), ERROR)
        one.library.fmi3FreeInstance(None)

    def test_output_trace(self) -> None:
        path = self.folder / "out3.osi"
        one = self.instance3(trace_output_path=str(path))
        outputs = [one.step(drive(k)) for k in range(5)]
        self.assertEqual(one.call("Terminate"), OK)
        data = pathlib.Path(path).read_bytes()
        self.assertEqual(data, b"".join(len(out).to_bytes(4, "little") + out for out in outputs))
