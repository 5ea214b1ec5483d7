#!/usr/bin/env python3
"""Tests of `sensors` and of the instruments of `simulate`; run as cli_test.py is."""
import csv
import json
import pathlib
import re
import struct
import tempfile
import unittest
import xml.etree.ElementTree

import cli_test
from cli_test import call

SHARE = pathlib.Path(__file__).resolve().parents[2] / "share"


class Sensors(cli_test.Failing):
    def test_catalogue(self):
        listed = json.loads(call("sensors", "list", "--json", "-").stdout)
        self.assertGreaterEqual(len(listed), 10)
        for name in (sensor["name"] for sensor in listed):
            with self.subTest(name), tempfile.TemporaryDirectory() as folder:
                done = call("sensors", "show", name, "--plot", "p.svg", "--json", "s.json", cwd=folder)
                self.assertEqual((done.returncode, done.stderr), (0, ""))
                shown = json.loads(pathlib.Path(folder, "s.json").read_text())
                self.assertEqual(shown["name"], name)
                self.assertTrue(shown["sources"])
                self.assertTrue(xml.etree.ElementTree.parse(pathlib.Path(folder, "p.svg")))

    def test_echoes_of_two_surfaces_and_their_waveform(self):
        with tempfile.TemporaryDirectory() as folder:
            done = call("sensors", "echo", "ibeo-lux-2010", "--target", "30:leaf:0.4", "--target",
                        "33:soil:0.6", "--csv", "w.csv", "--plot", "w.svg", "--json", "-", cwd=folder)
            echoes = json.loads(done.stdout)["echoes"]
            self.assertEqual([round(e["range_m"]) for e in echoes], [30, 33])
            rows = pathlib.Path(folder, "w.csv").read_text().splitlines()
            self.assertEqual(rows[0], "range_m,signal")
            highest = max(rows[1:], key=lambda row: float(row.split(",")[1]))
            self.assertAlmostEqual(float(highest.split(",")[0]), 30, delta=0.5)

    def test_what_is_wrong(self):
        self.assert_fails(call("sensors", "show", "vlp61"), 2, "'velodyne-vlp16'")
        self.assert_fails(call("sensors", "show"), 2, "sensors list")
        self.assert_fails(call("sensors", "echo", "velodyne-vlp16"), 2, "--target")
        self.assert_fails(call("sensors", "echo", "velodyne-vlp16", "--target", "x"), 2, "RANGE")
        self.assert_fails(call("sensors", "echo", "velodyne-vlp16", "--target", "3:laef"), 2, "'leaf'")
        with tempfile.TemporaryDirectory() as folder:
            self.assert_fails(call("sensors", "show", "velodyne-vlp16", "--plot", "p.png", cwd=folder), 2)
            pathlib.Path(folder, "bad.yaml").write_text("name: [\n")
            self.assert_fails(call("sensors", "show", "bad.yaml", "--plot", "p.svg", cwd=folder), 3,
                              "bad.yaml", "line")
            self.assertEqual({p.name for p in pathlib.Path(folder).iterdir()}, {"bad.yaml"})


ONE_BEAM = """name: one
kind: directions
directions: one.csv
cycle_s: 0.001
rate_hz: 100
min_range_m: 0.1
max_range_m: 100
divergence_mrad: [20, 20]
profile: uniform
wavelength_nm: 905
receiver: {pulse_ns: 5, detects: {range_m: 100, reflectance: 0.1}, returns: all, max_echoes: 3}
"""


class FittedFootprints(cli_test.OnALog):
    """`fit --sensor` makes the ellipsoids of a log as wide as the matter, without the width of the beam."""

    def mean_size(self, *words):
        done = call("fit", "log.ply", "-o", "model", "--fitter", "hierarchical", *words, "--json", "-", cwd=self.folder)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        path = pathlib.Path(self.folder, "model", "ellipsoids.ply")
        data = path.read_bytes()
        end = data.index(b"end_header\n") + len(b"end_header\n")
        names = [line.split()[2].decode() for line in data[:end].splitlines() if line.startswith(b"property")]
        rows = [  # all columns are 4 bytes wide
            dict(zip(names, row)) for row in struct.iter_unpack(f"<{len(names)}f", data[end:])]
        self.assertTrue(rows)
        return sum(row["cov_xx"] + row["cov_yy"] + row["cov_zz"] for row in rows) / len(rows)

    def test_ellipsoids_are_narrower_behind_a_wider_beam(self):
        pathlib.Path(self.folder, "one.csv").write_text("azimuth_deg,elevation_deg\n0,0\n")
        for name, width in (("narrow.yaml", 1), ("wide.yaml", 400)):
            pathlib.Path(self.folder, name).write_text(ONE_BEAM.replace("[20, 20]", f"[{width}, {width}]"))
        thin, narrow, wide = (self.mean_size(*words) for words in
                              ([], ["--sensor", "narrow.yaml"], ["--sensor", "wide.yaml"]))
        self.assertAlmostEqual(narrow, thin, delta=0.01 * thin)
        self.assertLess(wide, 0.9 * thin)

    def test_what_is_wrong(self):
        self.assert_fails(call("fit", "log.ply", "--sensor", "vlp61", "-o", "m", cwd=self.folder), 2, "'velodyne-vlp16'")
        self.assert_fails(call("fit", "log.ply", "--mixture-rounds", "-1", "-o", "m", cwd=self.folder), 2, "rounds")


class OwnSensors(cli_test.OnALog):
    """A log carries the sensor file that it is made with, and needs that file no more."""

    def setUp(self):
        super().setUp()
        self.run_all(until="segment")
        own = (SHARE / "sensors/velodyne-vlp16.yaml").read_text()
        for name, value in (("name", "small"), ("firing_period_us", "2000"),
                            ("sub_rays", "[2, 3]")):
            own = re.sub(rf"^{name}: .*", f"{name}: {value}", own, flags=re.MULTILINE)
        pathlib.Path(self.folder, "own.yaml").write_text(own)
        pathlib.Path(self.folder, "poses.txt").write_text("0 0 0 2 0 0 0 1\n0.2 0 0 2 0 0 0 1\n")
        self.json_of("fit", "log.ply", "-o", "model", "--min-points", "4")
        self.json_of("simulate", "model", "--sensor", "./own.yaml", "--trajectory", "poses.txt",
                     "-o", "own.ply")
        pathlib.Path(self.folder, "own.yaml").unlink()
        pathlib.Path(self.folder, "elsewhere").mkdir()

    def json_of(self, *words, below="."):
        done = call(*words, "--json", "-", cwd=pathlib.Path(self.folder, below))
        self.assertEqual((done.returncode, done.stderr), (0, ""), words)
        return json.loads(done.stdout)

    def test_a_log_that_names_no_sensor_is_answered_by_the_instrument_that_is_named(self):
        like = ["simulate", "model", "--like", "log.ply", "--super-sample", "3", "-o", "told.ply"]
        refused = call(*like, cwd=self.folder)
        self.assertEqual(refused.returncode, 2)
        self.assertIn("sensor", refused.stderr)
        told = self.json_of(*like, "--sensor", "velodyne-vlp16")
        self.assertEqual(told["sub_rays"], 3)
        self.assertGreater(told["hits"], 0)
        small = call(*like, "--grain", "-1", cwd=self.folder)
        self.assertEqual(small.returncode, 2)
        self.assertIn("--grain: expected a value that is between 0 and 100 (see", small.stderr)
        negative = call("segment", "log.ply", "-o", "objects", "--min-points", "-1", cwd=self.folder)
        self.assertEqual(negative.returncode, 2)
        self.assertIn("--min-points: expected a value that is not negative (see", negative.stderr)
        both = call(*like, "--sensor", "velodyne-vlp16", "--trajectory", "poses.txt", cwd=self.folder)
        self.assertEqual(both.returncode, 2)

    def test_the_beams_of_a_log_keep_their_sensor_in_another_folder(self):
        self.assertEqual(self.json_of("info", "own.ply")["sensor"], "small")
        self.assertRegex(call("info", "own.ply", cwd=self.folder).stdout, r"\n  sensor +small\n")
        self.json_of("split", "own.ply", "--every", "2", "--train", "even.ply", "--test", "odd.ply")
        self.json_of("import", "own.ply", "-o", "again.ply")
        for log in ("own.ply", "again.ply", "even.ply", "odd.ply"):
            like = ["simulate", "../model", "--like", f"../{log}"]
            with self.subTest(log):
                echoes = self.json_of(*like, "--super-sample", "3", "-o", "echoes.ply",
                                      below="elsewhere")
                self.assertEqual(echoes["sub_rays"], 3)
                self.assertGreater(echoes["hits"], 0)
                self.json_of(*like, "--beam", "random", "-o", "thin.ply", below="elsewhere")
                for made in ("echoes.ply", "thin.ply"):  # both carry it on
                    told = self.json_of("simulate", "../model", "--like", made, "--super-sample",
                                        "sensor", "-o", "last.ply", below="elsewhere")
                    self.assertEqual(told["sub_rays"], 6, made)  # 45 if the catalogue's were taken


class Footprints(cli_test.OnALog):
    """A model answers as for the beam of its log, and an instrument spreads its sub-rays by what its own is wider."""

    def setUp(self):
        super().setUp()
        self.run_all(until="segment")
        self.write("poses.txt", "0 0 0 2 0 0 0 1\n0.2 0 0 2 0 0 0 1\n")
        self.json_of("fit", "log.ply", "--sensor", "velodyne-vlp16", "--min-points", "4", "-o", "model")

    def write(self, name, text):
        pathlib.Path(self.folder, name).write_text(text)

    def json_of(self, *words):
        done = call(*words, "--json", "-", cwd=self.folder)
        self.assertEqual((done.returncode, done.stderr), (0, ""), words)
        return json.loads(done.stdout)

    def sub_rays(self, sensor, *words):
        return self.json_of("simulate", "model", "--sensor", sensor, "--trajectory", "poses.txt",
                            "--super-sample", "9", "-o", "out.ply", "--force", *words)["sub_rays"]

    def test_the_instrument_that_recorded_the_log_fires_all_its_sub_rays_and_returns_as_often_as_thin_rays(self):
        manifest = json.loads(pathlib.Path(self.folder, "model", "model.json").read_text())
        self.assertEqual(manifest["sensor"], "velodyne-vlp16")
        score = {}
        for name, words in (("thin", []), ("instrument", ["--sensor", "velodyne-vlp16", "--super-sample", "9"])):
            done = self.json_of("simulate", "model", "--like", "log.ply", "-o", f"{name}.ply", *words)
            self.assertEqual(done.get("sub_rays", 1), 9 if words else 1)
            score[name] = self.json_of("score", "log.ply", f"{name}.ply")
        returns = {name: s["true_hits"] + s["false_hits"] for name, s in score.items()}
        self.assertLess(abs(returns["instrument"] / returns["thin"] - 1), 0.02, returns)
        self.assertLess(score["instrument"]["median_range_error_m"], 0.03)

    def test_a_wider_beam_has_its_sub_rays(self):
        wide = (SHARE / "sensors/velodyne-vlp16.yaml").read_text()
        self.write("wide.yaml", re.sub(r"^divergence_mrad: .*", "divergence_mrad: [9, 9]", wide, flags=re.MULTILINE))
        self.assertEqual(self.sub_rays("./wide.yaml"), 9)

    def test_shares_of_the_light_leave_the_footprint_to_the_instrument(self):
        self.json_of("fit", "log.ply", "--sensor", "velodyne-vlp16", "--echoes", "all", "--min-points", "4", "-o", "model",
                     "--force")
        self.assertEqual(self.sub_rays("velodyne-vlp16"), 9)


class Instruments(cli_test.OnALog):
    """Makes a wall for half of a beam and a farther wall for the other half, far from everything else."""

    def setUp(self):
        super().setUp()
        self.run_all(until="segment")
        fitted = call("fit", *cli_test.JOBS["fit"], cwd=self.folder)
        self.assertEqual(fitted.returncode, 0, fitted.stderr)
        self.write("one.yaml", ONE_BEAM)
        self.write("one.csv", "azimuth_deg,elevation_deg\n0,0\n")
        self.write("poses.txt", "0 0 0 500 0 0 0 1\n0.1 0 0 500 0 0 0 1\n")
        self.write("near.txt", "0 20 0 500 0 0 0 1\n")
        self.write("half.obj", "v 0 0 -9\nv 0 9 -9\nv 0 9 9\nv 0 0 9\nf 1 2 3 4\n")
        self.write("wall.obj", "v 0 -9 -9\nv 0 9 -9\nv 0 9 9\nv 0 -9 9\nf 1 2 3 4\n")

    def write(self, name, text):
        pathlib.Path(self.folder, name).write_text(text)

    def simulate(self, far, *words, output="sim.csv"):
        self.write("far.txt", f"0 {far} 0 500 0 0 0 1\n")
        done = call("simulate", "model", "--sensor", "one.yaml", "--trajectory", "poses.txt", "--super-sample",
                    "20x20", "--mover", "half.obj:near.txt:white_target", "--mover",
                    "wall.obj:far.txt:white_target", "-o", output, "--json", "-", *words, cwd=self.folder)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        return json.loads(done.stdout)

    def rows(self, name="sim.csv"):
        with open(pathlib.Path(self.folder, name), newline="") as file:
            return [{k: float(v) for k, v in row.items()} for row in csv.DictReader(file)]

    def test_an_edge_gives_two_echoes_and_what_the_pulse_cannot_separate_one_in_between(self):
        told = self.simulate(23)
        self.assertEqual((told["beams"], told["hits"], told["echoes"]), (100, 100, 200))
        for row in self.rows():
            self.assertAlmostEqual(row["x"], 20 if row["echo"] == 1 else 23, delta=0.02)
            self.assertEqual(row["echoes"], 2)
            self.assertGreater(row["pulse_width"], 0.5)
            self.assertAlmostEqual(row["intensity"], 50, delta=5)  # half of a white target each
        told = self.simulate(20.4)
        self.assertEqual(told["echoes"], 100)
        self.assertTrue(all(20.1 < row["x"] < 20.3 for row in self.rows()))

    def test_every_format_and_what_it_cannot_hold(self):
        for output, lost in (("sim.ply", None), ("sim.pcd", "misses"), ("kitti", "echo numbers"), ("sim.csv", None)):
            told = self.simulate(23, output=output)
            self.assertIn(lost or "", told.get("lost", ""))
        for profile in ("velodyne", "ouster", "autoware"):
            told = self.simulate(23, "--profile", profile, output="out")
            self.assertIn("pulse widths", told["lost"])
            self.assertEqual(len(list(pathlib.Path(self.folder, "out").glob("*.pcd"))), 10)
        header = pathlib.Path(self.folder, "out/000000.pcd").read_bytes().split(b"DATA")[0]
        self.assertIn(b"return_type channel azimuth elevation distance time_stamp", header)

    def test_other_verbs_take_a_log_of_several_echoes(self):
        self.simulate(23, output="sim.ply")
        info = json.loads(call("info", "sim.ply", "--json", "-", cwd=self.folder).stdout)
        self.assertEqual((info["beams"], info["hits"], info["misses"], info["echoes"]), (100, 100, 0, 200))
        again = call("simulate", "model", "--like", "sim.ply", "-o", "thin.ply", "--json", "-", cwd=self.folder)
        self.assertEqual(json.loads(again.stdout)["beams"], 100, again.stderr)
        score = call("score", "sim.ply", "sim.ply", "thin.ply", "--json", "-", cwd=self.folder)
        self.assertEqual(score.returncode, 0, score.stderr)
        split = call("split", "sim.ply", "--every", "2", "--train", "a.ply", "--test", "b.ply", cwd=self.folder)
        self.assertEqual(split.returncode, 0, split.stderr)
        half = json.loads(call("info", "a.ply", "--json", "-", cwd=self.folder).stdout)
        self.assertEqual((half["beams"], half["echoes"]), (50, 100))
        fitted = call("fit", "sim.ply", "-o", "walls", "--fitter", "surface", cwd=self.folder)
        self.assertIn(fitted.returncode, (0, 3), fitted.stderr)
        self.assertEqual(self.simulate(23, "--returns", "first")["echoes"], 100)

    def test_waveforms(self):
        self.simulate(23, "--waveforms", "w.csv", "--waveforms", "w.svg", "--waveform-every", "10",
                      "--waveform-count", "4")
        rows = self.rows("w.csv")
        self.assertEqual({row["beam"] for row in rows}, {0, 10, 20, 30})
        peak = max((row for row in rows if row["beam"] == 10), key=lambda row: row["signal"])
        self.assertAlmostEqual(peak["range_m"], 20, delta=0.1)
        self.assertTrue(xml.etree.ElementTree.parse(pathlib.Path(self.folder, "w.svg")))

    def test_a_mover_is_met_where_it_is_at_each_beams_time(self):
        self.write("near.txt", "0 30 0 500 0 0 0 1\n0.1 20 0 500 0 0 0 1\n")
        self.simulate(60, "--returns", "first")
        for row in self.rows():
            self.assertAlmostEqual(row["x"], 30 - 100 * row["time"], delta=0.02)

    def test_poses_that_are_hours_apart(self):
        self.write("apart.txt", "0 0 0 2 0 0 0 1\n1 0 0 2 0 0 0 1\n3602 1 0 2 0 0 0 1\n")
        done = call("simulate", "model", "--sensor", "one.yaml", "--trajectory", "apart.txt", "-o", "bad.ply",
                    cwd=self.folder)
        self.assert_fails(done, 3, "apart.txt: poses 2 and 3: 3601.0 s apart")

    def test_what_is_wrong(self):
        base = ["simulate", "model", "--sensor", "one.yaml", "--trajectory", "poses.txt", "-o", "bad.ply"]
        for words, word in ((["--super-sample", "0"], "sub-rays"), (["--super-sample", "3x"], "COLUMNSxROWS"),
                            (["--super-sample", "9", "--returns", "third"], "--returns"),
                            (["--super-sample", "9", "--material", "tree=leaf"], "CLASS=MATERIAL"),
                            (["--super-sample", "9", "--material", "grass=laef"], "'leaf'"),
                            (["--super-sample", "9", "--beam", "random"], "--super-sample"),
                            (["--super-sample", "9", "--waveforms", "w.png"], ".svg"),
                            (["--returns", "first"], "--super-sample"), (["--mover", "wall.obj"], "--mover")):
            with self.subTest(words):
                self.assert_fails(call(*base, *words, cwd=self.folder), 2, *([word] if word != "sub-rays" else []))
        self.assert_fails(call(*base, "--mover", "none.obj:near.txt", cwd=self.folder), 3, "none.obj")
        self.assert_fails(call(*base, "--mover", "wall.obj:half.obj", cwd=self.folder), 3, "half.obj")
        self.assert_fails(call("simulate", "model", "--like", "log.ply", "--super-sample", "9", "-o", "bad.ply",
                               cwd=self.folder), 2, "does not name its sensor")
        self.assertFalse(pathlib.Path(self.folder, "bad.ply").exists())


if __name__ == "__main__":
    cli_test.main()
