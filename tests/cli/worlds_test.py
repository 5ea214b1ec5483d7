#!/usr/bin/env python3
"""Tests of worlds in other programs' formats: meshes, scenes and surveys of HELIOS++, voxels of AMAPVox."""
import csv
import json
import math
import pathlib
import sys

import cli_test

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "fuzz"))
import seeds  # pylint: disable=wrong-import-position


class Worlds(cli_test.OnALog):
    def setUp(self):
        super().setUp()

        def put(name, content):
            pathlib.Path(self.folder, name).write_bytes(content.encode() if isinstance(content, str) else content)

        seeds.worlds(put)
        put("spinning.yaml", seeds.SPINNING)

    def call(self, *words):
        return cli_test.call(*words, cwd=self.folder)

    def json_of(self, *words):
        done = self.call(*words, "--json", "-")
        self.assertEqual((done.returncode, done.stderr), (0, ""), words)
        return json.loads(done.stdout)

    def rows(self, *words):
        answer = self.json_of("simulate", *words, "--trajectory", "pose.txt", "-o", "sim.csv", "--element-ids")
        with open(pathlib.Path(self.folder, "sim.csv"), newline="") as file:
            return answer, [{k: float(v) for k, v in row.items()} for row in csv.DictReader(file)]

    def test_a_mesh_is_a_world_at_its_own_place(self):
        answer, rows = self.rows("world.obj", "--sensor", "spinning.yaml")
        self.assertEqual(answer["world"]["offset_m"], [510, 10, 2])
        self.assertEqual(answer["world"]["classes"], {"ground": 1, "las_6": 1})
        self.assertEqual(answer["world"]["element_classes"][14], "las_6")
        hits = [row for row in rows if row["hit"]]
        self.assertGreater(len(hits), 10)
        self.assertEqual({row["instance"] for row in hits}, {1, 2})
        self.assertEqual({row["element_class"] for row in hits if row["instance"] == 2}, {14})
        for row in hits:
            if row["instance"] == 2:  # the wall stands at y = 5, without any noise
                self.assertAlmostEqual(row["y"], 5, places=4)
        self.assertEqual(len(rows), 80)  # one pose is one turn: 20 firings of 4 channels

    def test_materials_of_the_file_decide_what_comes_back(self):
        def reflectance():
            self.rows("world.obj", "--sensor", "spinning.yaml", "--super-sample", "sensor")
            with open(pathlib.Path(self.folder, "sim.csv"), newline="") as file:
                rows = [row for row in csv.DictReader(file) if float(row["instance"]) == 1]
            return sum(float(row["intensity"]) for row in rows) / len(rows)

        bright = reflectance()
        mtl = pathlib.Path(self.folder, "world.mtl")
        mtl.write_text(mtl.read_text().replace("0.3", "0.1"))
        self.assertAlmostEqual(reflectance() / bright, 1 / 3, delta=0.1)
        done = self.call("simulate", "world.obj", "--sensor", "spinning.yaml", "--trajectory", "pose.txt",
                         "--super-sample", "2", "--material", "las_6=concrete", "-o", "m.ply")
        self.assertEqual((done.returncode, done.stderr), (0, ""))

    def test_info_tells_meshes_scenes_and_voxels(self):
        for name, triangles, voxels in (("world.obj", 3, 0), ("rock.stl", 2, 0), ("text.stl", 1, 0),
                                        ("forest.vox", 0, 7), ("world.xml", 3, 7), ("survey.xml", 3, 7)):
            facts = self.json_of("info", name)
            self.assertEqual((facts["kind"], facts["triangles"], facts["voxels"]), ("world", triangles, voxels), name)
        self.assertEqual(self.json_of("info", "world.obj")["left_out"], {"lines and points": 1})

    def test_a_survey_becomes_a_scene_sensors_and_trajectories(self):
        survey = self.json_of("import", "survey.xml", "-o", "survey")
        self.assertEqual([leg["number"] for leg in survey["legs"]], [0, 2])
        self.assertEqual(survey["left_out"], {"legs with an inactive scanner": 1})
        for leg in (0, 2):
            done = self.json_of("simulate", "survey/scene", "--sensor", f"survey/leg-{leg}.yaml", "--trajectory",
                                f"survey/leg-{leg}.txt", "-o", f"leg-{leg}.ply")
            self.assertGreater(done["beams"], 700)
            self.assertGreater(done["hits"], 0)
        again = self.json_of("info", "survey/scene")
        self.assertEqual(again["kind"], "scene")
        self.assertEqual(self.call("import", "survey.xml", "-o", "survey").returncode, 0)  # replaces its own
        pathlib.Path(self.folder, "other").mkdir()
        pathlib.Path(self.folder, "other", "file").write_text("")
        self.assertEqual(self.call("import", "survey.xml", "-o", "other").returncode, 4)

    def test_a_trajectory_that_does_not_fit_the_scene_is_told(self):
        leg = ("--sensor", "survey/leg-2.yaml", "--trajectory", "survey/leg-2.txt", "-o", "leg.ply")
        flight = pathlib.Path(self.folder, "flight.trj")
        rows = [line.replace(",", " ").split() for line in flight.read_text().splitlines() if not line.startswith(("#", "/"))]

        def moved(east, north, up):
            flight.write_text("".join(" ".join([*row[:4], str(float(row[4]) + east), str(float(row[5]) + north),
                                                str(float(row[6]) + up)]) + "\n" for row in rows))
            found = self.json_of("import", "survey.xml", "-o", "survey").get("warnings", [])
            return found, self.json_of("simulate", "survey/scene", *leg)

        told, done = moved(0, 0, 0)
        self.assertEqual((told, "warnings" in done), ([], False))
        self.assertGreater(done["hits"], 0)
        told, done = moved(412000, 5645000, 0)  # The flight in UTM, the scene in local coordinates.
        self.assertEqual((len(told), done["hits"], len(done["warnings"])), (1, 0, 1))
        self.assertRegex(told[0], r"^leg 2: the sensor lies at x 4125\d\d.* the world at x 492.4.*; they are 56\d\d km apart")
        self.assertRegex(done["warnings"][0], "^no beam meets anything: the sensor lies at .* UTM: shift the poses$")
        self.assertIn("  warning     no beam meets anything", self.call("simulate", "survey/scene", *leg).stdout)
        told, done = moved(0, 0, 2e6)
        self.assertEqual((told, done["hits"]), ([], 0))
        self.assertRegex(done["warnings"][0], r"it is 2000 km above the world, beyond its range of ")

    def test_files_outside_the_folder_are_refused(self):
        inner = pathlib.Path(self.folder, "inner")
        inner.mkdir()
        for name in ("world.xml", "survey.xml"):
            (inner / name).write_bytes(pathlib.Path(self.folder, name).read_bytes())
        done = self.call("info", "inner/world.xml")
        self.assertEqual(done.returncode, 3)
        self.assertIn("--assets FOLDER", done.stderr)
        self.json_of("import", "inner/survey.xml", "--assets", ".", "-o", "out")
        text = (inner / "world.xml").read_text()
        (inner / "world.xml").write_text(text.replace("world.obj", "../world.obj"))
        done = self.call("info", "inner/world.xml")
        self.assertEqual(done.returncode, 3)
        self.assertIn("leads out", done.stderr)
        (inner / "world.xml").write_text('<!DOCTYPE d [<!ENTITY a "aaaa">]>' + text)
        self.assertIn("document type", self.call("info", "inner/world.xml").stderr)

    def test_rasters_of_voxels_give_their_density_back(self):
        lines = ["VOXEL SPACE", "#min_corner: 0 0 0", "#max_corner: 10 10 10", "#split: 20 20 20", "i j k pad"]
        lines += [f"{k // 400} {k // 20 % 20} {k % 20} 0.4" for k in range(8000)]
        pathlib.Path(self.folder, "even.vox").write_text("\n".join(lines) + "\n")
        facts = self.json_of("rasters", "even.vox", "-o", "maps")
        n = facts["size"]
        raw = pathlib.Path(self.folder, "maps/plant_area_density.npy").read_bytes()
        values = memoryview(raw[len(raw) - 4 * math.prod(n):]).cast("f")
        middle = [values[x + n[0] * (y + n[1] * z)] for x in range(3, 9) for y in range(3, 9) for z in range(3, 9)]
        self.assertAlmostEqual(sum(middle) / len(middle), 0.4, delta=0.01)
        self.assertTrue(pathlib.Path(self.folder, "maps/canopy_height.tif").read_bytes().startswith(b"II*\0"))

    def test_meshes_says_how_it_moved_plants(self):
        facts = self.json_of("meshes", "world.obj", "-o", "set", "--sizes", "1")
        self.assertEqual(facts["range_noise_m"], 0.02)
        self.assertGreater(facts["scale"][1], facts["scale"][0])
        about = next(iter(pathlib.Path(self.folder, "set").rglob("primitive.json")))
        plant = json.loads(about.read_text())["plants"][0]
        self.assertEqual(plant["plant"], "world.obj")
        self.assertAlmostEqual(plant["foot_m"][0], 510, delta=1)
        text = self.call("meshes", "world.obj", "-o", "set2", "--sizes", "1").stdout
        self.assertIn("a scene keeps its places with `underbrush simulate FILE`", text)


if __name__ == "__main__":
    cli_test.main()
