#!/usr/bin/env python3
"""Tests of the verbs from labels to scenes, and of invalid annotations."""
import base64
import csv
import json
import math
import pathlib
import re
import shutil
import struct
import unittest

import cli_test


class Scenes(cli_test.OnALog):
    def setUp(self):
        super().setUp()
        self.run_all(until="simulate")

    def json_of(self, *words):
        done = cli_test.call(*words, "--json", "-", cwd=self.folder)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        return json.loads(done.stdout)

    def test_a_scene_is_simulated_as_a_model_is(self):
        scene = self.json_of("compose", "site.json", "primitives", "-o", "scene")
        self.assertGreaterEqual(scene["instances"], 2)
        self.assertEqual(scene["instances"], scene["objects"])
        answered = self.json_of("simulate", "scene", "--like", "log.ply", "-o", "scene.ply")
        bare = self.annotation(lambda site: site.update(objects=[]))
        ground = self.json_of("compose", bare, "primitives", "-o", "bare")
        self.assertEqual(ground["instances"], 0)
        self.assertGreater(answered["hits"], self.json_of("simulate", "bare", "--like", "log.ply", "-o",
                                                          "bare.ply")["hits"])

    def test_a_world_of_regions_is_its_model_to_all_verbs(self):
        self.json_of("simulate", "model", "--like", "log.ply", "-o", "sim.ply")
        self.json_of("regions", "model", "-o", "parts", "--side", 4)
        bytes_of = lambda name: {str(f.relative_to(self.folder / name)): f.read_bytes()
                                 for f in (self.folder / name).rglob("*.ply")}
        for model, of in (("model", "whole"), ("parts", "parts")):
            self.made = {
                "extract": self.json_of("extract", model, "labelled.ply", "-o", f"{of}-primitives"),
                "rasters": self.json_of("rasters", model, "--memory", "3MiB", "-o", f"{of}-maps"),
                "score": self.json_of("score", "log.ply", "sim.ply", "--model", model),
                "info": self.json_of("info", model)}
            for report in self.made.values():
                report.pop("provenance", None)
            if of == "whole":
                whole = self.made
        for verb in ("extract", "rasters", "score"):
            self.assertEqual(self.made[verb], whole[verb])
        self.assertEqual(bytes_of("parts-primitives"), bytes_of("whole-primitives"))
        for file in (self.folder / "whole-maps").glob("*.*[yf]"):
            self.assertEqual(file.read_bytes(), (self.folder / "parts-maps" / file.name).read_bytes())
        info = self.made["info"]
        for name in ("kind", "tau", "ellipsoids", "ground_triangles", "origin_m", "sway_s"):
            self.assertEqual(info[name], whole["info"][name])
        self.assertGreater(info["regions"], 4)
        self.assertGreater(info["memory_bytes"]["regions"], info["memory_bytes"]["largest"])

    def test_a_scene_is_a_model_to_scores_and_its_plants_have_numbers(self):
        self.json_of("compose", "site.json", "primitives", "-o", "scene")
        self.json_of("simulate", "scene", "--like", "log.ply", "--element-ids", "-o", "sim.ply")
        scores = self.json_of("score", "log.ply", "sim.ply", "--model", "scene")
        self.assertTrue(math.isfinite(scores["nll_per_beam"]) and scores["crps_m"] > 0)
        self.json_of("compose", self.annotation(lambda site: site.update(objects=[])), "primitives", "-o", "bare")
        worse = self.json_of("score", "log.ply", "sim.ply", "--model", "bare")
        self.assertLess(scores["nll_per_beam"], worse["nll_per_beam"])
        done = cli_test.call("simulate", "scene", "--like", "log.ply", "--element-ids", "-o", "sim.csv",
                             cwd=self.folder)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        head, *rows = pathlib.Path(self.folder, "sim.csv").read_text().splitlines()
        column = head.split(",").index("instance")
        numbers = {int(float(row.split(",")[column])) for row in rows}
        self.assertTrue(numbers > {0}, numbers)
        self.json_of("simulate", "model", "--like", "log.ply", "--element-ids", "-o", "sim.ply")
        raw = pathlib.Path(self.folder, "sim.ply").read_bytes()
        self.assertNotIn(b" instance\n", raw[:raw.index(b"end_header")])

    def test_echoes_of_an_instrument_name_the_plant_too(self):
        self.json_of("compose", "site.json", "primitives", "-o", "scene")
        pathlib.Path(self.folder, "poses.txt").write_text("0 0 0 1.5 0 0 0 1\n0.1 1 0 1.5 0 0 0 1\n")
        words = ["simulate", "scene", "--sensor", "velodyne-vlp16", "--trajectory", "poses.txt", "--super-sample", "9",
                 "--returns", "3", "-o", "echoes.csv"]
        self.json_of(*words, "--element-ids")
        with open(pathlib.Path(self.folder, "echoes.csv"), newline="") as file:
            rows = [{k: float(v) for k, v in row.items()} for row in csv.DictReader(file)]
        rows = [row for row in rows if row["element"] != 2**32 - 1]  # neither misses nor echoes of noise
        self.assertTrue({row["instance"] for row in rows} > {0})
        self.assertTrue(any(row["echo"] == 2 for row in rows))
        self.assertEqual({row["element_class"] for row in rows if row["instance"] == 0}, {1})  # the ground
        self.json_of(*words)
        head = pathlib.Path(self.folder, "echoes.csv").read_text().splitlines()[0]
        self.assertNotIn("instance", head)

    def simulate_mover(self, *words, material="", output="sim.csv"):
        """Simulates a shrub as a mover, 3 m from a sensor that sees all else beyond 4 m."""
        for name, pose in (("shrub.txt", "3 0 0 0 0 0.70710678 0.70710678"),
                           ("poses.txt", "0 0 1.5 0 0 0 1")):
            pathlib.Path(self.folder, name).write_text(f"0 {pose}\n0.1 {pose}\n")
        mover = f"primitives/large_shrub/0001:shrub.txt{material}"
        return cli_test.call("simulate", "model", "--sensor", "velodyne-vlp16", "--trajectory",
                             "poses.txt", "--mover", mover, "--element-ids", "-o", output, *words,
                             cwd=self.folder)

    def test_a_mover_on_a_plain_model_has_a_number_and_its_own_class(self):
        manifest = pathlib.Path(self.folder, "model/model.json")  # without what may stand in unknown space
        model = json.loads(manifest.read_text())
        del model["observed_space"]
        manifest.write_text(json.dumps(model))
        for words in ([], ["--super-sample", "9"]):
            with self.subTest(words):
                done = self.simulate_mover(*words, material=":leaf")
                self.assertEqual((done.returncode, done.stderr), (0, ""))
                with open(pathlib.Path(self.folder, "sim.csv"), newline="") as file:
                    rows = [{k: float(v) for k, v in row.items()} for row in csv.DictReader(file)]
                # The model has no classes; 6 is that of a large shrub.
                found = {(row["hit"] == 1 and math.hypot(row["x"], row["y"]) < 4, row["instance"],
                          row["element_class"]) for row in rows}
                self.assertEqual(found, {(True, 1, 6), (False, 0, 0)})
                self.assertEqual({row["hit"] for row in rows if row["instance"] == 0}, {0, 1})

    def test_a_movers_material_is_known_or_refused(self):
        for words in ([], ["--super-sample", "9"]):
            with self.subTest(words):
                done = self.simulate_mover(*words, material=":laef", output="bad.csv")
                self.assert_fails(done, 2, "'laef'", "'leaf'")
                self.assertFalse(pathlib.Path(self.folder, "bad.csv").exists())

    def annotation(self, change):
        site = json.loads(pathlib.Path(self.folder, "site.json").read_text())
        change(site)
        pathlib.Path(self.folder, "changed.json").write_text(json.dumps(site))
        return "changed.json"

    def models(self, scene):
        """The folders of the primitives that a scene is made of."""
        names = json.loads(pathlib.Path(self.folder, scene, "scene.json").read_text())["models"]
        return {model["name"] for model in names} - {"ground"}

    def test_plants_of_an_annotation_are_left_out(self):
        """No primitive is used that was cut from an object of that annotation."""
        whole = self.json_of("compose", "site.json", "primitives", "-o", "scene")
        self.assertNotIn("primitives_left_out", whole)
        used = self.models("scene")

        def without(change):
            name = self.annotation(change)
            return self.json_of("compose", "site.json", "primitives", "--leave-out", name, "-o", "other")

        def move(site):
            for o in site["objects"]:
                o["position_m"][0] += 1000
        self.assertEqual(without(move)["primitives_left_out"], 0)
        self.assertEqual(self.models("other"), used)
        first = json.loads(pathlib.Path(self.folder, "site.json").read_text())["objects"][0]
        some = without(lambda site: site.update(objects=[first]))
        self.assertGreaterEqual(some["primitives_left_out"], 1)
        for name in self.models("other"):
            about = json.loads(pathlib.Path(self.folder, "primitives", name, "primitive.json").read_text())
            self.assertNotEqual(about["source"]["position_m"], first["position_m"])
        none = without(lambda site: None)
        self.assertEqual((none["instances"], self.models("other")), (0, set()))
        done = cli_test.call("compose", "site.json", "primitives", "--leave-out", "site.json", "-o", "other",
                             cwd=self.folder)
        self.assertRegex(done.stdout, r"left out +\d+ primitives of plants of site.json")
        self.assert_fails(cli_test.call("compose", "site.json", "primitives", "--leave-out", "nowhere.json", "-o", "bad",
                                        cwd=self.folder), 3, "nowhere.json")

    def test_of_a_site_that_is_made_up(self):
        for kind in ("forest", "savanna", "meadow"):
            made = self.json_of("annotate", "--generate", kind, "--size", "60", "40", "-o", "made.json")
            self.assertGreater(made["objects"], 10)
            files = []
            for threads in (1, 2, 3):  # which change nothing
                scene = self.json_of("compose", "made.json", "primitives", "-o", "scene", "--threads", threads, "--force")
                self.assertEqual(scene["instances"] + sum(scene["left_out"].values()), made["objects"])
                files.append({f: re.sub(rb'"--threads", "\d"', b"", f.read_bytes())
                              for f in sorted((self.folder / "scene").rglob("*.*"))})
            self.assertGreater(len(files[0]), 2)
            self.assertTrue(files[0] == files[1] == files[2])

    def test_a_library_of_two_sets(self):
        merged = self.json_of("primitives", "merge", "primitives", "primitives", "--of-site", "creek", "--of-season",
                              "summer", "-o", "library")
        self.assertEqual((merged["duplicates"], merged["without_license"]), (merged["primitives"], 2))
        scene = self.json_of("compose", "site.json", "library", "-o", "scene")
        self.assertEqual(scene["instances"], scene["objects"])
        found = self.json_of("primitives", "list", "library", "--class", "shrub", "--season", "summer")["primitives"]
        self.assertTrue(0 < len(found) <= merged["primitives"])
        self.assertEqual({p["site"] for p in found}, {"creek"})
        self.assertEqual(self.json_of("primitives", "list", "library", "--season", "winter")["primitives"], [])
        done = cli_test.call("primitives", "merge", "library", "-o", "again", cwd=self.folder)
        self.assertIn("no licence", done.stdout)
        for words, code in ((("merge", "primitives"), 2), (("list", "library", "--class", "trees"), 2),
                            (("merge", "nowhere", "-o", "bad"), 3), (("list", "library", "primitives"), 2)):
            self.assert_fails(cli_test.call("primitives", *words, cwd=self.folder), code)
        manifest = pathlib.Path(self.folder, "library/primitives.json")
        manifest.write_text(manifest.read_text().replace('"origin": 0', '"origin": 7'))
        self.assert_fails(cli_test.call("primitives", "list", "library", cwd=self.folder), 3, "origin")

    def edits(self, *edits, **members):
        """Writes a list of edits of primitives."""
        listed = {"format": "underbrush-primitive-edits", "version": 1, "edits": edits, **members}
        pathlib.Path(self.folder, "edits.json").write_text(json.dumps(listed), encoding="utf-8")

    def test_a_library_is_edited(self):
        """What is thrown out is gone, and names and licences stay through further merges."""
        self.json_of("primitives", "merge", "primitives", "--of-license", "CC-BY-4.0", "-o", "library")
        folders = [p["folder"] for p in self.json_of("primitives", "list", "library")["primitives"]]
        thrown, kept = folders[0], folders[1]
        self.edits({"primitive": thrown, "remove": True}, {"primitive": kept, "class": "small_tree", "name": "Eiche <1>"})
        words = ("primitives", "merge", "library", "--edits", "edits.json")
        merged = self.json_of(*words, "-o", "edited")
        self.assertEqual([merged[k] for k in ("primitives", "thrown_out", "relabelled", "named")],
                         [len(folders) - 1, 1, 1, 1])
        self.json_of("primitives", "merge", "edited", "-o", "again")
        found = self.json_of("primitives", "list", "again", "--name", "Eiche")["primitives"]
        self.assertEqual([(p["folder"], p["name"], p["license"]) for p in found],
                         [("small_tree/0001", "Eiche <1>", "CC-BY-4.0")])
        self.assertTrue(pathlib.Path(self.folder, "again/small_tree/0001/thumbnail.png").is_file())
        self.assertIn("<b>Eiche &lt;1&gt;</b>", pathlib.Path(self.folder, "again/index.html").read_text(encoding="utf-8"))
        self.assertIn('"Eiche <1>"', cli_test.call("primitives", "list", "again", cwd=self.folder).stdout)
        inputs = json.loads(pathlib.Path(self.folder, "edited/primitives.json").read_text(encoding="utf-8"))["provenance"]["inputs"]
        self.assertEqual(set(inputs), {"library", "edits.json"})
        cli_test.call(*words, "--threads", "3", "-o", "threads", cwd=self.folder)
        for file in pathlib.Path(self.folder, "edited").rglob("*.*"):
            other = pathlib.Path(self.folder, "threads") / file.relative_to(self.folder / "edited")
            self.assertEqual(file.read_bytes().replace(b" --threads 3", b""), other.read_bytes().replace(b" --threads 3", b""))
        done = cli_test.call("compose", "site.json", "edited", "-o", "scene", cwd=self.folder)
        self.assertEqual((done.returncode, done.stderr), (0, ""))

    def test_edits_that_cannot_be_are_refused_with_their_place(self):
        shrub = {"primitive": "large_shrub/0001"}
        other = {"primitive": "large_shrub/0002", "name": "b"}
        for edit, place in (({"primitive": "large_shrub/9999", "remove": True}, "edits[1].primitive: there is no such primitive"),
                            ({**other, "name": "c"}, "edits[1].primitive: an edit before"), ({**shrub}, "edits[1]: needs"),
                            ({**shrub, "class": "smal_tree"}, "edits[1].class: no class of primitives 'smal_tree'; did you mean"),
                            ({**shrub, "class": "grass"}, "edits[1].class"), ({**shrub, "class": "low_shrub_patch"}, "edits[1].class"),
                            ({**shrub, "name": "a\u001b[2J"}, "edits[1].name"), ({**shrub, "name": 3}, "edits[1].name")):
            self.edits(other, edit)
            done = cli_test.call("primitives", "merge", "primitives", "--edits", "edits.json", "-o", "bad", cwd=self.folder)
            self.assert_fails(done, 3, f"edits.json: {place}")
        for members, place in (({"version": 2}, "version"), ({"format": "x"}, "format"), ({"set": "xxh3:0"}, "set"), ({"author": "me"}, "author")):
            self.edits(other, **members)
            done = cli_test.call("primitives", "merge", "primitives", "--edits", "edits.json", "-o", "bad", cwd=self.folder)
            self.assert_fails(done, 3, "edits.json", place)
        self.edits(*({"primitive": p["folder"], "remove": True} for p in self.json_of("primitives", "list", "primitives")["primitives"]))
        words = ("primitives", "merge", "primitives", "--edits", "edits.json", "-o", "bad")
        self.assert_fails(cli_test.call(*words, cwd=self.folder), 3, "edits.json: edits: all primitives are thrown out")
        pathlib.Path(self.folder, "edits.json").write_text('{"format"')
        self.assert_fails(cli_test.call(*words, cwd=self.folder), 3, "edits.json")
        self.assert_fails(cli_test.call(*words[:2], "primitives", *words[2:], cwd=self.folder), 2, "--edits takes one set")
        self.assertFalse(pathlib.Path(self.folder, "bad").exists())

    def test_of_a_site_like_another(self):
        site = ("annotate", "--generate", "savanna", "--density", "0.02", "--size", "60", "50", "-o", "site/a.json")
        pathlib.Path(self.folder, "site").mkdir()
        whole = self.json_of(*site)
        like = ("annotate", "--generate", "--like", "site/a.json", "--size", "60", "50")
        made = self.json_of(*like, "--draws", "5", "-o", "made.json")
        self.assertAlmostEqual(made["objects"], whole["objects"], delta=0.2 * whole["objects"])
        rows = {row["name"]: row for row in made["statistics"]}
        row = rows["trees per hectare"]
        self.assertAlmostEqual(row["mean"], row["site"], delta=0.1 * row["site"])
        self.assertLessEqual(row["low"], row["high"])
        provenance = json.loads(pathlib.Path(self.folder, "made.json").read_text())["provenance"]
        self.assertIn("site/a.json", json.dumps(provenance))
        few = self.json_of(*like, "--primitives", "primitives", "--draws", "0", "-o", "few.json")
        self.assertNotIn("statistics", few)
        classes = {p["class"] for p in json.loads(pathlib.Path(self.folder, "primitives/primitives.json").read_text())
                   ["primitives"]}
        self.assertLessEqual(set(few["classes"]), classes)
        self.assertTrue(few["replaced"] or few["left_out"])
        for name in ("forest", "meadow"):
            made = self.json_of("annotate", "--generate", name, "--size", "60", "50", "--primitives", "primitives", "-o",
                                "kind.json")
            self.assertLessEqual(set(made["classes"]), classes)
        for words in (("--generate",), ("--generate", "forest", "--like", "site/a.json"), ("--like", "site/a.json",
                      "--density", "0.1"), ("labelled.ply", "--primitives", "primitives")):
            self.assert_fails(cli_test.call("annotate", *words, "-o", "bad.json", cwd=self.folder), 2, "annotate")
        self.assert_fails(cli_test.call("annotate", "--like", "nowhere.json", "-o", "bad.json", cwd=self.folder), 3,
                          "nowhere.json")
        changed = self.annotation(lambda site: site.update(objects=site["objects"][:1]))
        self.assert_fails(cli_test.call("annotate", "--like", changed, "-o", "other.json", cwd=self.folder), 3,
                          "changed.json", "fewer than 10 objects")

    def test_labels_come_back_from_another_program(self):
        # CloudCompare saves text with float numbers, other names and another order.
        def labels(file):
            cli_test.call("info", file, cwd=self.folder)  # the file is a log
            raw = pathlib.Path(self.folder, file).read_bytes()
            return raw[raw.index(b"end_header"):]
        before = labels("labelled.ply")
        again = cli_test.call("segment", "labelled.ply", "--labels", "labelled.ply", "-o", "again.ply", cwd=self.folder)
        self.assertEqual((again.returncode, again.stderr), (0, ""))
        self.assertEqual(labels("again.ply"), before)

    def first(self, **members):
        return self.annotation(lambda site: site["objects"][0].update(members))

    def compose(self, name, *words, primitives="primitives"):
        return cli_test.call("compose", name, primitives, "-o", "bad", *words, cwd=self.folder)

    def assert_refused(self, name, *words):
        """Bad input gives one line that names the file and the place, and leaves no scene."""
        self.assert_fails(self.compose(name), 3, name, *words)
        self.assertFalse(pathlib.Path(self.folder, "bad").exists())

    def test_an_unknown_class(self):
        self.assert_refused(self.first(**{"class": "large_tre"}), "objects[0].class", "'large_tree'")
        self.assert_refused(self.first(**{"class": 7}), "objects[0].class")

    def test_a_box_without_extent(self):
        for size in ([1, 0, 1], [0, 0, 0], [1, 1, -1]):
            self.assert_refused(self.first(box_m={"size": size}), "objects[0].box_m")

    def test_numbers_that_are_none(self):
        self.assert_refused(self.first(position_m=[1, None]), "objects[0].position_m")
        self.assert_refused(self.first(yaw_rad="north"), "objects[0].yaw_rad")
        text = pathlib.Path(self.folder, "site.json").read_text()
        for word in ("NaN", "Infinity", "-nan", "1e999"):  # the first three are no JSON
            pathlib.Path(self.folder, "nan.json").write_text(re.sub(r'"yaw_rad":[^,]*', f'"yaw_rad":{word}', text))
            self.assert_refused("nan.json")

    def test_other_faults_of_an_annotation(self):
        self.assert_refused(self.annotation(lambda site: site["objects"][0].pop("class")), "class")
        self.assert_refused(self.annotation(lambda site: site["objects"][0].update(clas="x")), "'class'")
        self.assert_refused(self.annotation(lambda site: site.update(version=99)), "version")
        self.assert_fails(self.compose(self.annotation(lambda site: site.update(ground="nowhere"))), 3, "nowhere")

    def test_a_pose_off_the_ground_mesh(self):
        name = self.first(position_m=[9999, 0])
        counted = self.json_of("compose", name, "primitives", "-o", "some")
        self.assertEqual(counted["off_ground"], 1)
        self.assertEqual(counted["instances"], counted["objects"] - 1)
        self.assertIn("warning     1 left out: they stand off the ground", self.compose(name).stdout)
        shutil.rmtree(pathlib.Path(self.folder, "bad"))
        self.assert_fails(self.compose(name, "--strict"), 3, name, "1 objects stand off the ground")

    def test_a_class_without_primitives(self):
        # Another size of the same kind replaces it, and is counted.
        name = self.first(**{"class": "low_shrub"})
        counted = self.json_of("compose", name, "primitives", "-o", "some")
        self.assertEqual(counted["borrowed"], {"low_shrub": 1})
        self.assertEqual(counted["instances"], counted["objects"])
        self.assertRegex(self.compose(name).stdout, "warning     1 of class low_shrub: no primitives")
        shutil.rmtree(pathlib.Path(self.folder, "bad"))
        self.assert_fails(self.compose(name, "--strict"), 3, "low_shrub")
        # Without any primitive of its kind it is left out.
        name = self.first(**{"class": "small_tree"})
        counted = self.json_of("compose", name, "primitives", "-o", "some")
        self.assertEqual(counted["left_out"], {"small_tree": 1})
        self.assertEqual(counted["instances"], counted["objects"] - 1)
        self.assertRegex(self.compose(name).stdout, "warning     1 of class small_tree left out")
        shutil.rmtree(pathlib.Path(self.folder, "bad"))
        self.assert_fails(self.compose(name, "--strict"), 3, "small_tree")
        self.assertFalse(pathlib.Path(self.folder, "bad").exists())

    def test_no_objects(self):
        name = self.annotation(lambda site: site.update(objects=[]))
        done = self.compose(name)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertIn("warning     there are no objects", done.stdout)
        answered = self.json_of("simulate", "bad", "--like", "log.ply", "-o", "bare.ply")
        self.assertGreater(answered["hits"], 0)  # the ground answers

    def test_a_plant_of_gltf_stands_upright(self):
        corners = [(0, 0, 0), (1, 0, 0), (0, 0, 1), (0, 4, 0)]  # y is up
        data = b"".join(struct.pack("<3f", *c) for c in corners) + struct.pack("<9H", 0, 1, 3, 1, 2, 3, 2, 0, 3)
        buffer = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
        plant = {"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
                 "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
                 "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3",
                                "min": [0, 0, 0], "max": [1, 4, 1]},
                               {"bufferView": 1, "componentType": 5123, "count": 9, "type": "SCALAR"}],
                 "bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 18}],
                 "buffers": [{"uri": buffer, "byteLength": 66}]}
        folder = pathlib.Path(self.folder, "small_tree")
        folder.mkdir()
        (folder / "plant.gltf").write_text(json.dumps(plant))
        self.json_of("meshes", "small_tree", "-o", "plants")
        found = json.loads(pathlib.Path(self.folder, "plants/primitives.json").read_text())
        self.assertEqual([round(p["box_m"]["max"][2], 3) for p in found["primitives"]], [4.0])
        (folder / "plant.gltf").write_text(json.dumps(plant)[:-20])
        self.assert_fails(cli_test.call("meshes", "small_tree", "-o", "bad", cwd=self.folder), 3, "plant.gltf")

    def test_wrong_usage(self):
        self.assert_fails(cli_test.call("annotate", "-o", "a.json", cwd=self.folder), 2, "--generate")
        for density in ("tree=1", "large_tree", "large_tree=-1", "large_tree=x"):
            self.assert_fails(cli_test.call("compose", "site.json", "primitives", "--class-density", density, "-o", "bad",
                                   cwd=self.folder), 2)
        self.assert_fails(cli_test.call("extract", "model", "log.ply", "-o", "bad", cwd=self.folder), 3, "segment")


if __name__ == "__main__":
    cli_test.main()
