#!/usr/bin/env python3
"""The comparison simulator by its name, `mesh_primitives`: as a set of primitives and as a fitter."""
import json
import math
import pathlib

import cli_test

FIT = ["fit", "log.ply", "--fitter", "mesh_primitives"]
# Options that the steps by hand share with the fitter; each finds other objects in the log.
SHARED = ([], ["--tile", "16", "--min-range", "6.65"], ["--ground-method", "spherical_variance"])


def without_provenance(path):
    """A file's content; JSON without where it came from."""
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

    def scene(self, name):
        folder = pathlib.Path(self.folder, name)
        return {str(p.relative_to(folder)): without_provenance(p) for p in folder.rglob("*") if p.is_file()}

    def annotate(self, *shared):
        self.json_of("fit", "log.ply", "--fitter", "ground_mesh", "-o", "ground", *shared)
        self.json_of("segment", "log.ply", "-o", "labelled.ply", *shared)
        return self.json_of("annotate", "labelled.ply", "--ground", "ground", "-o", "site.json")

    def own_set(self, name):
        """Of one plant, of the class of the log's posts."""
        folder = pathlib.Path(self.folder, "large_shrub")
        folder.mkdir()
        (folder / "bush.obj").write_bytes(pathlib.Path(self.folder, "tree.obj").read_bytes())
        self.json_of("meshes", "large_shrub", "-o", name)

    def test_the_fitter_is_the_chain_of_verbs(self):
        counts = set()
        for words in SHARED:
            site = self.annotate(*words)
            by_hand = self.json_of("compose", "site.json", "mesh_primitives", "-o", "by-hand", "--seed", "3")
            fitted = self.json_of(*FIT, "-o", "scene", "--seed", "3", *words)
            counts.add(fitted["scene"]["instances"])
            self.assertEqual(fitted["annotation"], site)
            self.assertEqual(fitted["scene"], {k: v for k, v in by_hand.items() if k not in ("seconds", "warnings")})
            self.assertEqual(self.scene("scene"), self.scene("by-hand"))
        self.assertEqual(len(counts), len(SHARED), counts)

    def test_threads_change_nothing(self):
        for threads in ("1", "2"):
            self.json_of(*FIT, "-o", threads, "--threads", threads)
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
        fitted = self.json_of(*FIT, "--meshes", "meshes", "-o", "scene")
        self.assertEqual(self.scene("scene"), self.scene("by-hand"))
        self.assertEqual(fitted["scene"]["borrowed"], {})
        inputs = json.loads(pathlib.Path(self.folder, "scene/scene.json").read_text())["provenance"]["inputs"]
        self.assertEqual(set(inputs), {"log.ply", "meshes"})
        self.assert_fails(self.call("fit", "log.ply", "--meshes", "meshes", "-o", "bad"), 2, "--meshes")
        self.assert_fails(self.call(*FIT, "--meshes", "nowhere", "-o", "bad"), 3, "nowhere")
        self.assertFalse(pathlib.Path(self.folder, "bad").exists())

    def test_it_is_a_model_to_all_that_take_one(self):
        fitted = self.json_of(*FIT, "-o", "scene", "--export-ground", "ground.obj")
        self.assertGreater(pathlib.Path(self.folder, "ground.obj").stat().st_size, 1000)
        self.assertEqual(fitted["fitter"], "mesh_primitives")
        known = self.json_of("info", "scene")
        self.assertEqual((known["kind"], known["instances"] - 1, known["surface_triangles"], known["ellipsoids"]),
                         ("scene", fitted["scene"]["instances"], fitted["scene"]["elements"], 0))
        answered = self.json_of("simulate", "scene", "--like", "log.ply", "-o", "sim.ply")
        self.assertGreater(answered["hits"], 0)
        scores = self.json_of("score", "log.ply", "sim.ply", "--model", "scene")
        self.assertTrue(math.isfinite(scores["nll_per_beam"]) and scores["crps_m"] > 0)
        # No return beyond the range limit that the log shows.
        manifest = json.loads(pathlib.Path(self.folder, "scene/models/0000/model.json").read_text())
        self.assertEqual(manifest["max_range_m"], fitted["max_range_m"])
        self.annotate()
        tuned = self.json_of("optimize", "log.ply", "--annotation", "site.json", "--primitives", "mesh_primitives",
                             "--budget", "2", "-o", "densities.yaml")
        self.assertTrue(tuned["parameters"])

    def test_what_it_is_not(self):
        self.assert_fails(self.call("optimize", "log.ply", "--fitter", "mesh_primitives", "-o", "p.yaml"), 2,
                          "mesh_primitives", "densities")
        self.assert_fails(self.call(*FIT, "-o", "bad", "--export-splat", "a.ply"), 2, "--export-splat")
        self.json_of(*FIT, "-o", "scene")
        for start in ("mesh_primitives", "scene"):
            self.assert_fails(self.call("fit", "log.ply", "--fitter", "likelihood", "--start", start, "-o", "bad"), 2,
                              "--start", start)
        self.json_of("fit", "log.ply", "-o", "model")
        self.assert_fails(self.call(*FIT, "-o", "model"), 4, "model", "not a scene")
        self.assert_fails(self.call("fit", "log.ply", "-o", "scene"), 4, "scene", "not a model")

    def log_of(self, name, keep):
        """Another log, of the rows (as {column: number}) that `keep` lets through."""
        head, *rows = pathlib.Path(self.folder, "log.csv").read_text().splitlines()
        kept = [row for row in rows if keep(dict(zip(head.split(","), map(float, row.split(",")))))]
        pathlib.Path(self.folder, name + ".csv").write_text("\n".join([head, *kept]) + "\n")
        self.assertEqual(self.call("import", name + ".csv", "-o", name + ".ply").returncode, 0)
        return ["fit", name + ".ply", "--fitter", "mesh_primitives", "-o", "scene"]

    def test_a_log_of_ground_alone(self):
        words = self.log_of("bare", lambda row: row["hit"] == 0 or abs(row["z"]) < 0.01)
        found = self.json_of(*words)
        self.assertEqual((found["annotation"]["objects"], found["scene"]["instances"]), (0, 0))
        self.assertIn("warning     there are no objects: the scene is its ground", self.call(*words).stdout)
        self.assertGreater(self.json_of("simulate", "scene", "--like", "bare.ply", "-o", "sim.ply")["hits"], 0)

    def test_a_log_without_ground(self):
        self.assert_fails(self.call(*FIT, "--ground-method", "none", "-o", "scene"), 3, "log.ply", "ground")
        self.assertFalse(pathlib.Path(self.folder, "scene").exists())

    def test_a_log_without_returns(self):
        self.assert_fails(self.call(*self.log_of("misses", lambda row: row["hit"] == 0)), 2, "no return")
        self.assertFalse(pathlib.Path(self.folder, "scene").exists())


if __name__ == "__main__":
    cli_test.main()
