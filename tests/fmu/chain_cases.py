"""Parts of the chain, and inputs of both kinds."""
from __future__ import annotations

import osi_bytes as osi
from cases import SUB_RAYS, FmuTest, drive, objects
from fmu import CONFIG, DATA_IN, OK, REQUEST


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
        beams = osi.value(request, 1002, 10)
        self.assertEqual(beams, 51 * 11)
        self.assertEqual(len(osi.parts(request, 1002, 11)), SUB_RAYS * beams)
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
