#!/usr/bin/env python3
"""Tests of keyframes end to end, on the recorded scan that comes with the program: half of its columns teach a model,
and the other half judge it beside the same model without keyframes."""
import csv
import json
import math
import pathlib
import struct
import tempfile

import cli_test

SCAN = pathlib.Path(__file__).resolve().parents[2] / "share/examples/marv_forest.pcd"


class Keyframes(cli_test.Failing):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.temporary.name)
        cls.run_verb("import", SCAN, "-o", "scan.ply", "--unknown-below-deg", "-13")
        cls.run_verb("split", "scan.ply", "--columns", "2", "--train", "train.ply", "--test", "test.ply")
        cls.run_verb("fit", "train.ply", "--keyframes", "0", "-o", "without")
        cls.fit = cls.run_verb("fit", "train.ply", "-o", "with")

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    @classmethod
    def run_verb(cls, verb, *words):
        done = cli_test.call(verb, *map(str, words), "--json", "-", cwd=cls.folder)
        if done.returncode:
            raise AssertionError(done.stderr)
        return json.loads(done.stdout)

    def scored(self, model, *options):
        self.run_verb("simulate", model, "--like", "test.ply", *options, "-o", f"{model}.ply", "--force")
        return self.run_verb("score", "test.ply", f"{model}.ply", "--model", model, "--name", "m")["models"]["m"]

    def test_recorded_scan_is_answered_better(self):
        without, remembered = self.scored("without"), self.scored("with")
        self.assertLess(remembered["nll_per_beam"], min(without["nll_per_beam"] - 0.2, -0.64))
        self.assertLess(remembered["crps_m"], 0.95 * without["crps_m"])
        self.assertLess(remembered["packet_error_m"], 0.82 * without["packet_error_m"])
        self.assertLess(remembered["cloud_error_m"], without["cloud_error_m"])
        self.assertGreater(remembered["f1"], without["f1"])

    def test_median_is_nearer_than_a_draw_and_than_a_carved_mesh(self):
        self.run_verb("fit", "train.ply", "--fitter", "surface", "--surface-carve", "-o", "mesh")
        drawn, mesh = self.scored("with"), self.scored("mesh")
        median = self.scored("with", "--draw", "median")
        for other in (drawn, mesh):
            self.assertLess(median["packet_error_m"], 0.95 * other["packet_error_m"])
            self.assertGreater(median["f1"], other["f1"])

    def test_report_says_what_is_remembered(self):
        found = self.fit["keyframes"]
        self.assertEqual(found["frames"], 1)
        self.assertGreater(found["trust"][0]["where_ranges_agree"], 0.5)
        used = self.run_verb("simulate", "with", "--like", "test.ply", "-o", "a.ply")
        self.assertTrue(used["keyframes"])
        labelled = self.run_verb("simulate", "with", "--like", "test.ply", "--element-ids", "-o", "b.ply")
        self.assertFalse(labelled["keyframes"])

    def test_a_moving_object_hides_what_was_recorded(self):
        corners = [(x, y, z) for z in (-3, 3) for y in (-3, 3) for x in (-3, 3)]
        sides = [(1, 2, 4, 3), (5, 6, 8, 7), (1, 2, 6, 5), (3, 4, 8, 7), (1, 3, 7, 5), (2, 4, 8, 6)]
        (self.folder / "box.obj").write_text("".join(f"v {x} {y} {z}\n" for x, y, z in corners)
                                             + "".join(f"f {a} {b} {c} {d}\n" for a, b, c, d in sides))
        still = self.run_verb("simulate", "with", "--like", "test.ply", "-o", "a.ply", "--force")
        for place, x in (("away", 9000), ("here", 0)):
            (self.folder / f"{place}.txt").write_text(f"0 {x} 0 0 0 0 0 1\n")
            moved = self.run_verb("simulate", "with", "--like", "test.ply", "--mover", f"box.obj:{place}.txt",
                                  "-o", f"{place}.ply")
            self.assertTrue(moved["keyframes"])
            if place == "here":
                self.assertEqual(moved["misses"], 0)
                continue
            self.assertEqual(moved["misses"], still["misses"])
            same = self.run_verb("score", "a.ply", "away.ply", "--name", "m")["models"]["m"]
            self.assertLess(same["packet_error_m"], 1e-3)

    def waveforms(self, *words):
        """Simulates, and returns the rows of the log and {beam: (samples, their signals, ranges of echoes)}."""
        told = self.run_verb("simulate", "named", "--like", "again.ply", "--super-sample", "3x3", *words, "--waveforms",
                             "all.waves", "-o", "made.csv", "--force")
        data, found, at = (self.folder / "all.waves").read_bytes(), {}, 16
        while at < len(data):
            beam, *_, echoes, samples, _ = struct.unpack_from("<QdIHHII", data, at)
            values = struct.unpack_from(f"<{2 * samples + echoes}f", data, at + 32)
            found[beam] = values[:2 * samples:2], values[1:2 * samples:2], values[2 * samples:]
            at += 32 + 4 * len(values)
        self.assertEqual((told["waveforms"], struct.unpack_from("<Q", data, 8)[0]), (len(found), len(found)))
        with open(self.folder / "made.csv", newline="") as file:
            return list(csv.DictReader(file)), found

    def assert_echo_is_at_a_peak(self, row, ranges, signals, echoes):
        self.assertEqual(int(row["hit"]), len(echoes), row)
        if not echoes:
            return
        measured = math.dist(*([float(row[o + axis]) for axis in "xyz"] for o in ("", "o")))
        self.assertAlmostEqual(measured, echoes[0], delta=1e-4)
        peaks = [k for k, signal in enumerate(signals) if signal == max(signals[max(0, k - 1):k + 2])]
        peak = min(peaks, key=lambda k: abs(ranges[k] - measured))
        self.assertLess(abs(ranges[peak] - measured), 0.2, row)  # The sample of 2 ns (0.30 m), or hardly beside it.
        # The sensor returns the echo of the most energy, which is that of the samples within 2 m.
        energy = lambda at: sum(s for r, s in zip(ranges, signals) if abs(r - ranges[at]) < 2)
        self.assertGreater(energy(peak), 0.5 * max(map(energy, peaks)), row)

    def test_echoes_are_peaks_of_waveforms_and_beams_of_keyframes_have_none(self):
        for name, x in (("seen", 0), ("again", 0.02)):
            (self.folder / f"{name}.txt").write_text("".join(f"{t} {x} 0 0 0 0 0 1\n" for t in (0, 0.1)))
            self.run_verb("simulate", "without", "--sensor", "velodyne-vlp16", "--trajectory", f"{name}.txt", "-o",
                          f"{name}.ply")
        self.run_verb("fit", "seen.ply", "-o", "named")
        model = self.folder / "named/model.json"
        manifest = json.loads(model.read_text())
        # Two channels whose ranges are wrong by more than a sample of the waveform.
        manifest["channels"] = [{"ring": ring, "range_offset_m": offset, "standard_error_m": 0.01}
                                for ring, offset in ((3, 0.4), (4, -0.4))]
        model.write_text(json.dumps(manifest))
        rows, found = self.waveforms()
        of_world, all_found = self.waveforms("--element-ids")  # which keyframes do not answer
        self.assertEqual(len(all_found), len(rows))
        for beam, row in enumerate(of_world):
            self.assert_echo_is_at_a_peak(row, *all_found[beam])
        same = {beam for beam, row in enumerate(rows) if all(row[name] == of_world[beam][name] for name in row)}
        self.assertTrue(0.02 * len(rows) < len(found) < 0.5 * len(rows))
        self.assertLessEqual(set(found), same)  # with a waveform: answered by the world
        # Without one: answered by a keyframe, with the pulse as the sensor fires it.
        widths = {row["pulse_width"] for beam, row in enumerate(rows) if beam not in found and row["hit"] == "1"}
        self.assertEqual(len(widths), 1)
        self.assertFalse(widths & {rows[beam]["pulse_width"] for beam in found if rows[beam]["hit"] == "1"})

    def test_damaged_keyframes_are_refused(self):
        file = self.folder / "with/keyframes.ply"
        content = file.read_bytes()
        try:
            file.write_bytes(content[:len(content) // 2])
            done = cli_test.call("simulate", "with", "--like", "test.ply", "-o", "c.ply", cwd=self.folder)
            self.assert_fails(done, 3, "keyframes.ply")
            file.unlink()
            done = cli_test.call("simulate", "with", "--like", "test.ply", "-o", "c.ply", cwd=self.folder)
            self.assert_fails(done, 3, "keyframes.ply")
        finally:
            file.write_bytes(content)


if __name__ == "__main__":
    cli_test.main()
