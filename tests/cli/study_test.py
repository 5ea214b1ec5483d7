#!/usr/bin/env python3
"""Tests of `underbrush-study` and of `info --leaves`; run as cli_test.py is."""
import json
import math
import pathlib
import random
import tempfile
import unittest

import cli_test
from cli_test import call


def study(*words, cwd=None):
    return call(*words, cwd=cwd, program=pathlib.Path(cli_test.PROGRAM).with_name("underbrush-study"), timeout=600)


def write_cloud(path, points):
    path.write_text("x,y,z\n" + "".join("{:.4f},{:.4f},{:.4f}\n".format(*p) for p in points))


def write_pair(folder, scale):
    """Makes two clouds of the miniature's nine patches, the simulated one `scale` times as large, and five corners."""
    draw = random.Random(3)
    cubes = (((0, 0), 1), ((-0.6, 0), 0.2), ((0, -0.6), 0.2))

    def points():
        for (x, y), side in cubes:
            steps = [(k + 0.5) * side / round(side / 0.014) for k in range(round(side / 0.014))]
            for u in steps:
                for v in steps:
                    off = draw.gauss(0, 0.003)
                    yield x - side / 2 + u, y - side / 2 + v, side + off
                    if not (x == 0 and y == 0 and v < 0.2 and abs(u - side / 2) < 0.1):
                        yield x - side / 2 - off, y - side / 2 + u, v
                        yield x - side / 2 + u, y - side / 2 - off, v

    def seen(p):  # rotated by 40 degrees, 24 m ahead of the scanner
        c, s = math.cos(0.7), math.sin(0.7)
        return 24 + c * p[0] - s * p[1], s * p[0] + c * p[1], p[2] - 0.5

    write_cloud(folder / "real.csv", [seen(p) for p in points()])
    write_cloud(folder / "simulated.csv", [[scale * q for q in p] for p in points()])
    corners = [(-0.5, -0.5, 1), (-0.7, -0.1, 0.2), (-0.1, -0.7, 0.2), (0.5, -0.5, 1), (-0.5, 0.5, 1)]
    (folder / "conjugates.csv").write_text(
        "".join(",".join(f"{q:.4f}" for q in (*seen(p), *p)) + "\n" for p in corners))


class Study(cli_test.Failing):
    def test_ends_with_a_verdict(self):
        with tempfile.TemporaryDirectory() as folder:
            done = study("vegetation", "--quick", "--json", "s.json", "--report", "r", cwd=folder)
            self.assertIn(done.returncode, (0, 1), done.stderr)
            found = json.loads(pathlib.Path(folder, "s.json").read_text())
            self.assertEqual(done.returncode, 0 if found["verdict"] == "holds" else 1)
            self.assertRegex(found["verdict"], "^(holds$|falls short: )")
            self.assertIn(f"verdict: {found['verdict']}\n", done.stdout)
            self.assertIn("mobile experiment was left out", done.stdout)
            self.assertTrue(pathlib.Path(folder, "r", "index.html").is_file())

    def test_without_its_logs_falls_short(self):
        done = study("echoes")
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn("verdict: falls short: nothing was compared\n", done.stdout)

    def test_transmission_has_the_truth_beside_each_model(self):
        with tempfile.TemporaryDirectory() as folder:
            done = study("transmission", "--quick", "--json", "s.json", "--keep", "kept", cwd=folder)
            self.assertIn(done.returncode, (0, 1), done.stderr)
            found = json.loads(pathlib.Path(folder, "s.json").read_text())
            self.assertEqual(done.returncode, 0 if found["verdict"] == "holds" else 1)
            (name, sources), = found["figures"].items()
            truth, plain = sources["truth"], sources["plain"]
            self.assertAlmostEqual(truth["transmission"]["overhead"], math.exp(-2.5), delta=1e-6)
            self.assertAlmostEqual(truth["covered"], 0.95, delta=0.03)
            self.assertAlmostEqual(plain["area_density"], truth["area_density"], delta=0.02)
            self.assertEqual({len(source["layers"]) for source in sources.values()}, {10})
            for kept in (f"{name}.ply", f"{name}, default"):
                self.assertTrue(pathlib.Path(folder, "kept", kept).exists(), kept)

    def test_of_no_such_name(self):
        self.assert_fails(study("vegetatoin"), 2, "vegetation")

    def test_verification_of_ones_own_pair(self):
        with tempfile.TemporaryDirectory() as folder:
            write_pair(pathlib.Path(folder), scale=1)
            words = ("verification", "--quick", "--data", ".", "--json", "s.json")
            done = study(*words, "--report", "r", cwd=folder)
            self.assertIn(done.returncode, (0, 1), done.stderr)
            found = json.loads(pathlib.Path(folder, "s.json").read_text())
            self.assertEqual(done.returncode, 0 if found["verdict"] == "holds" else 1)
            pair = found["figures"]["own_pair"]
            self.assertEqual(len(pair["patches"]), 9)
            self.assertLess(pair["mean_patch_distance_m"], 0.0031)
            self.assertEqual(pair["corners"], 5)
            self.assertIn("Your pair: distances", pathlib.Path(folder, "r", "index.html").read_text())
            self.assertNotIn("your pair by ICP, mean distance", found["verdict"])
            done = study("verification", "--quick", "--json", "own.json", "--keep", "kept", cwd=folder)
            self.assertIn(done.returncode, (0, 1), done.stderr)
            kept = json.loads(study(*words[:2], "--data", "kept", "--json", "-", cwd=folder).stdout)
            own = json.loads(pathlib.Path(folder, "own.json").read_text())
            self.assertAlmostEqual(kept["figures"]["own_pair"]["mean_patch_distance_m"],
                                   own["figures"]["miniature"]["mean_patch_distance_m"], delta=1e-6)
            write_pair(pathlib.Path(folder), scale=1.03)
            done = study(*words, cwd=folder)
            self.assertEqual(done.returncode, 1, "a study that falls short")
            self.assertRegex(done.stdout, "verdict: falls short: .*your pair by ICP, mean distance")
            pathlib.Path(folder, "conjugates.csv").write_text("1,2,3\n")
            self.assert_fails(study(*words, cwd=folder), 3, "conjugates.csv", "line 1")

    def test_mesh_fidelity_with_a_report_and_ones_own_clouds(self):
        with tempfile.TemporaryDirectory() as folder:
            draw = random.Random(1)
            write_cloud(pathlib.Path(folder, "cube.csv"), [[draw.random() for _ in range(3)] for _ in range(3000)])
            pathlib.Path(folder, "meshes").mkdir()
            pathlib.Path(folder, "meshes", "tent.obj").write_text(
                "v 0 0 0\nv 0 2 0\nv 1 1 2\nv 2 0 0\nf 1 2 3\nf 1 3 4\n")
            done = study("mesh-fidelity", "--quick", "--data", ".", "--json", "s.json", "--report", "r",
                        "--keep", "kept", cwd=folder)
            self.assertIn(done.returncode, (0, 1), done.stderr)
            found = json.loads(pathlib.Path(folder, "s.json").read_text())
            self.assertEqual(done.returncode, 0 if found["verdict"] == "holds" else 1)
            self.assertRegex(found["verdict"], "^(holds$|falls short: )")
            figures = found["figures"]
            self.assertGreater(figures["plants"]["billboard"]["epsilon"], 0.11)
            self.assertGreater(figures["plants"]["cartoon, a ball"]["epsilon"], 0.11)
            self.assertEqual(figures["plants"]["tent, given"]["elements"], 2)
            self.assertLess(figures["real"]["cube"]["epsilon"], 0.11)
            self.assertLessEqual({"exact poses", "odometry"}, set(figures["regression"]))
            kept = json.loads(call("info", "kept/billboard.ply", "--leaves", "all", "--json", "-", cwd=folder).stdout)
            self.assertAlmostEqual(kept["epsilon"], figures["plants"]["billboard"]["epsilon"], delta=1e-3)
            page = pathlib.Path(folder, "r", "index.html").read_text()
            for text in ("Realism distance against the number of triangles", "<svg", "published", "cube"):
                self.assertIn(text, page)


class Leaves(cli_test.Failing):
    def test_of_any_cloud(self):
        with tempfile.TemporaryDirectory() as folder:
            draw = random.Random(2)
            points = [[draw.random() for _ in range(3)] for _ in range(4000)]
            write_cloud(pathlib.Path(folder, "cube.csv"), points)
            write_cloud(pathlib.Path(folder, "floor.csv"), [[x, y, 0.01 * z] for x, y, z in points])
            write_cloud(pathlib.Path(folder, "few.csv"), points[:20])
            for name, realistic in (("cube", True), ("floor", False)):
                done = call("info", f"{name}.csv", "--leaves", "all", "--json", "-", cwd=folder)
                self.assertEqual(done.returncode, 0, done.stderr)
                found = json.loads(done.stdout)
                self.assertEqual((found["points"], found["realistic"]), (4000, realistic))
                self.assertEqual(sum(found["histogram"]), 4000)
            self.assert_fails(call("info", "few.csv", "--leaves", "all", cwd=folder), 3, "30 points")
            self.assert_fails(call("info", "none.csv", "--leaves", "all", cwd=folder), 3, "none.csv")
            self.assert_fails(call("info", "cube.csv", "--leaves", "some", cwd=folder), 2, "--leaves")


if __name__ == "__main__":
    cli_test.main()
