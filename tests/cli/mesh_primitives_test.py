#!/usr/bin/env python3
"""Tests of the comparison simulator: the set of primitives `mesh_primitives`, and the script of four verbs."""
import json
import math
import os
import pathlib
import subprocess

import cli_test

SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "scripts/mesh_primitives.sh"
# Options that the steps by hand share with the script; each finds other objects in the log.
SHARED = ([], ["--tile", "16", "--min-range", "6.65"], ["--ground-method", "spherical_variance"])


def without_provenance(path):
    """Reads a file; JSON is returned without its provenance."""
    if path.suffix != ".json":
        return path.read_bytes()
    manifest = json.loads(path.read_text())
    manifest.pop("provenance")
    return manifest


class MeshPrimitives(cli_test.OnALog):
    def setUp(self):
        super().setUp()
        cli_test.write_log(self.folder, scans=8)

    def call(self, *words):
        return cli_test.call(*words, cwd=self.folder)

    def json_of(self, *words):
        done = self.call(*words, "--json", "-")
        self.assertEqual((done.returncode, done.stderr), (0, ""), words)
        return json.loads(done.stdout)

    def script(self, *words):
        environment = dict(os.environ, UNDERBRUSH=str(pathlib.Path(cli_test.PROGRAM).resolve()))
        return subprocess.run([SCRIPT, *words], cwd=self.folder, env=environment, text=True,
                              stdin=subprocess.DEVNULL, capture_output=True, check=False, timeout=120)

    def make(self, scene, *words):
        done = self.script("log.ply", scene, *words)
        self.assertEqual((done.returncode, done.stderr), (0, ""), words)
        return self.json_of("info", scene)

    def scene(self, name):
        folder = pathlib.Path(self.folder, name)
        return {str(p.relative_to(folder)): without_provenance(p) for p in folder.rglob("*") if p.is_file()}

    def annotate(self, *shared):
        self.json_of("fit", "log.ply", "--fitter", "ground_mesh", "-o", "ground", *shared)
        self.json_of("segment", "log.ply", "-o", "labelled.ply", *shared)
        return self.json_of("annotate", "labelled.ply", "--ground", "ground", "-o", "site.json")

    def own_set(self, name):
        """Makes a set of one plant that has the class of the log's posts."""
        folder = pathlib.Path(self.folder, "large_shrub")
        folder.mkdir()
        (folder / "bush.obj").write_bytes(pathlib.Path(self.folder, "tree.obj").read_bytes())
        self.json_of("meshes", "large_shrub", "-o", name)

    def test_the_script_is_the_chain_of_verbs(self):
        counts = set()
        for words in SHARED:
            self.annotate("--seed", "3", *words)
            self.json_of("compose", "site.json", "mesh_primitives", "-o", "by-hand", "--seed", "3")
            counts.add(self.make("scene", "--seed", "3", *words)["instances"])
            self.assertEqual(self.scene("scene"), self.scene("by-hand"))
        self.assertEqual(len(counts), len(SHARED), counts)

    def test_threads_change_nothing(self):
        for threads in ("1", "2"):
            self.make(threads, "--threads", threads)
        one, two = (pathlib.Path(self.folder, name) for name in ("1", "2"))
        names = sorted(str(p.relative_to(one)) for p in one.rglob("*") if p.is_file())
        self.assertEqual(names, sorted(str(p.relative_to(two)) for p in two.rglob("*") if p.is_file()))
        for name in names:
            self.assertEqual((one / name).read_bytes(), (two / name).read_bytes(), name)

    def test_the_name_is_the_generated_set_and_wins_over_a_folder(self):
        self.annotate()
        self.json_of("meshes", "generated", "-o", "generated")
        self.own_set("mesh_primitives")
        self.json_of("compose", "site.json", "generated", "-o", "of-folder")
        named = self.json_of("compose", "site.json", "mesh_primitives", "-o", "of-name")
        self.assertEqual(self.scene("of-name"), self.scene("of-folder"))
        self.assertIn("./mesh_primitives", named["warnings"][0])
        own = self.json_of("compose", "site.json", "./mesh_primitives", "-o", "own")
        self.assertEqual(own["warnings"], [])
        self.assertEqual(own["elements"], 2)  # triangles
        self.assertNotEqual(self.scene("own"), self.scene("of-name"))
        other = self.json_of("compose", "site.json", "mesh_primitives", "-o", "other", "--seed", "2")
        self.assertEqual(other["objects"], named["objects"])
        self.assertNotEqual(self.scene("other"), self.scene("of-name"))

    def test_a_set_of_ones_own(self):
        self.own_set("meshes")
        self.annotate()
        self.json_of("compose", "site.json", "meshes", "-o", "by-hand")
        self.make("scene", "--primitives", "meshes")
        self.assertEqual(self.scene("scene"), self.scene("by-hand"))
        done = self.script("log.ply", "bad", "--primitives", "nowhere")
        self.assertEqual(done.returncode, 3)
        self.assertIn("nowhere", done.stderr)
        self.assertFalse(pathlib.Path(self.folder, "bad").exists())

    def test_wrong_usage_of_the_script(self):
        for words in ([], ["log.ply"], ["log.ply", "bad", "--meshes", "x"], ["log.ply", "bad", "--seed"]):
            done = self.script(*words)
            self.assertEqual(done.returncode, 2, words)
            self.assertRegex(done.stderr, r"\Amesh_primitives: [^\n]+\n\Z")
        self.assertFalse(pathlib.Path(self.folder, "bad").exists())

    def test_it_is_a_model_to_all_that_take_one(self):
        known = self.make("scene")
        self.assertEqual((known["kind"], known["ellipsoids"]), ("scene", 0))
        self.assertGreater(known["surface_triangles"], 100)
        answered = self.json_of("simulate", "scene", "--like", "log.ply", "-o", "sim.ply")
        self.assertGreater(answered["hits"], 0)
        scores = self.json_of("score", "log.ply", "sim.ply", "--model", "scene")
        self.assertTrue(math.isfinite(scores["nll_per_beam"]) and scores["crps_m"] > 0)
        # No return beyond the range limit that the log shows.
        manifest = json.loads(pathlib.Path(self.folder, "scene/models/0000/model.json").read_text())
        self.annotate()
        ground = json.loads(pathlib.Path(self.folder, "ground/model.json").read_text())
        self.assertEqual(manifest["max_range_m"], ground["max_range_m"])
        tuned = self.json_of("optimize", "log.ply", "--annotation", "site.json", "--primitives", "mesh_primitives",
                             "--budget", "2", "-o", "densities.yaml")
        self.assertTrue(tuned["parameters"])

    def test_what_it_is_not(self):
        self.assert_fails(self.call("fit", "log.ply", "--fitter", "mesh_primitives", "-o", "bad"), 2, "--fitter")
        self.make("scene")
        self.assert_fails(self.call("fit", "log.ply", "--fitter", "likelihood", "--start", "scene", "-o", "bad"), 2,
                          "--start", "scene")
        self.json_of("fit", "log.ply", "-o", "model")
        done = self.script("log.ply", "model")
        self.assertEqual(done.returncode, 4)
        self.assertIn("not a scene", done.stderr)
        self.assert_fails(self.call("fit", "log.ply", "-o", "scene"), 4, "scene", "not a model")

    def log_of(self, name, keep):
        """Makes a log of the rows (as {column: number}) that `keep` lets through."""
        head, *rows = pathlib.Path(self.folder, "log.csv").read_text().splitlines()
        kept = [row for row in rows if keep(dict(zip(head.split(","), map(float, row.split(",")))))]
        pathlib.Path(self.folder, name + ".csv").write_text("\n".join([head, *kept]) + "\n")
        self.assertEqual(self.call("import", name + ".csv", "-o", name + ".ply").returncode, 0)
        return [name + ".ply", "scene"]

    def test_a_log_of_ground_alone(self):
        words = self.log_of("bare", lambda row: row["hit"] == 0 or abs(row["z"]) < 0.01)
        done = self.script(*words)
        self.assertIn("warning     there are no objects: the scene is its ground", done.stdout)
        self.assertEqual(self.json_of("info", "scene")["instances"], 1)
        self.assertGreater(self.json_of("simulate", "scene", "--like", "bare.ply", "-o", "sim.ply")["hits"], 0)

    def test_a_log_without_ground(self):
        done = self.script("log.ply", "scene", "--ground-method", "none")
        self.assertNotEqual(done.returncode, 0)
        self.assertFalse(pathlib.Path(self.folder, "scene").exists())

    def test_a_log_without_returns(self):
        done = self.script(*self.log_of("misses", lambda row: row["hit"] == 0))
        self.assertEqual(done.returncode, 3)
        self.assertIn("no return", done.stderr)
        self.assertFalse(pathlib.Path(self.folder, "scene").exists())


if __name__ == "__main__":
    cli_test.main()
