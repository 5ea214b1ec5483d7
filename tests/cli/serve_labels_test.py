#!/usr/bin/env python3
"""Tests of the labels, boxes and commands of `underbrush serve`: what they change, and what they refuse."""
import json
import pathlib
import tempfile
import time
import unittest
import urllib.parse

import cli_test
import serving

class ServeLabels(unittest.TestCase):
    """Labels and commands: what they change, what they refuse, and that they write nowhere else."""
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.temporary.name)
        serving.make_files(cls.folder)
        cls.server = serving.Server(cls.folder, "log.ply", "model", "primitives", "scene", words=("--labels", "work"))
        cls.server.octree(0)

    @classmethod
    def tearDownClass(cls):
        cls.server.end()
        cls.temporary.cleanup()

    def post(self, path, server=None, /, **values):
        query = urllib.parse.urlencode({"file": 0, **values})
        status, _, body = (server or self.server).get(f"api/{path}?{query}", method="POST")
        return status, json.loads(body)

    def revision(self):
        return self.server.json_of("api/labels?file=0")["revision"]

    def test_edits_undo_and_conflicts(self):
        info = json.loads(cli_test.call("info", "log.ply", "--json", "-", cwd=self.folder).stdout)
        known = self.revision()
        status, reply = self.post("labels/edit", revision=known, **{"class": 2}, instance="new", name="all: grass")
        self.assertEqual((status, reply["rows"]), (200, info["hits"]))
        for path in ("labels/edit", "labels/undo", "labels/redo", "labels/box", "labels/import", "labels/carry"):
            values = {"name": "x.ply", "class": 1, "number": 1}
            status, conflict = self.post(path, revision=known, **values)
            self.assertIn(status, (400, 409, 422), path)
            if path in ("labels/edit", "labels/undo", "labels/redo"):
                self.assertEqual((status, conflict["revision"]), (409, known + 1), path)
        self.assertEqual(self.server.json_of("api/labels?file=0")["last"], "all: grass")
        self.assertEqual(self.post("labels/undo", revision=known + 1)[0], 200)
        state = self.server.json_of("api/labels?file=0")
        self.assertEqual((state["classes"][2]["points"], state["redos"]), (0, 1))
        self.assertEqual(state["next"], "all: grass")

    def test_labels_come_back_from_their_files(self):
        """The law of export and import: what was written is read again as it was."""
        self.post("labels/edit", revision=self.revision(), **{"class": 1})
        self.post("labels/edit", revision=self.revision(), **{"class": 8}, instance=7, box="0,0,0,20,20,50,0.3")
        before = self.server.json_of("api/labels?file=0")["classes"]
        self.assertGreater(before[8]["points"], 0)
        self.assertGreater(before[1]["points"], 0)
        _, log = self.post("labels/export", format="log", name="out.ply")
        _, file = self.post("labels/export", format="label", name="out.label", set="rellis")
        self.assertEqual(file["without_number"], 0)
        for name, form in (("out.ply", "log"), ("out.label", "label")):
            self.assertEqual(self.post("labels/export", format=form, name=name)[0], 400)  # it is there already
        names = self.server.json_of("api/labels/files")["names"]
        self.assertTrue({"out.ply", "out.label"} <= set(names), names)
        annotated = cli_test.call("annotate", "work/out.ply", "--min-points", "1", "-o", "out.json", cwd=self.folder)
        self.assertEqual(annotated.returncode, 0, annotated.stderr)
        for values in ({"from": log["file"]}, {"name": "out.label", "set": "rellis"}):
            self.post("labels/edit", revision=self.revision(), **{"class": 0}, instance=0)
            status, _ = self.post("labels/import", revision=self.revision(), **values)
            self.assertEqual(status, 200)
            self.assertEqual(self.server.json_of("api/labels?file=0")["classes"], before)
        status, reply = self.post("labels/carry", revision=self.revision(), scan=0, radius=5)
        self.assertEqual((status, reply["rows"]), (200, 0))  # every point has a class already

    def test_a_killed_server_finds_its_labels(self):
        server = serving.Server(self.folder, "labelled.ply", words=("--labels", "killed"))
        server.octree(0)
        for k in range(8):
            known = server.json_of("api/labels?file=0")["revision"]
            status, _ = self.post("labels/edit", server, revision=known, stroke=5, **{"class": k % 3},
                                  box=f"0,0,0,{5 + 3 * k},30,30,0")
            self.assertEqual(status, 200)
        state = server.json_of("api/labels?file=0")
        server.process.kill()
        server.process.communicate()
        again = serving.Server(self.folder, "labelled.ply", words=("--labels", "killed"))
        again.octree(0)
        self.assertEqual(again.json_of("api/labels?file=0&since=99"), state | {"nodes": []})
        other = serving.Server(self.folder, "labelled.ply", words=("--labels", "killed"))
        other.octree(0)
        self.assertEqual(other.get("api/labels?file=0")[0], 422)  # the first server has them
        other.end()
        again.end()

    def test_what_is_refused(self):
        box = {"class": "small_tree", "position_m": [0, 0, 0], "yaw_rad": 0, "min_m": [-1, -1, 0], "max_m": [1, 1, 2]}
        shape = {"matrix": ",".join(["1"] * 16), "path": "1,1,9,1,9,9", "width": 10, "height": 10}
        before = set(pathlib.Path(self.folder).rglob("*"))
        bad = [("labels/edit", {"class": 99}), ("labels/edit", {"class": -1}), ("labels/edit", {"instance": 1 << 30}),
               ("labels/edit", {**shape, "path": "1,1,9"}), ("labels/edit", {**shape, "matrix": "1,2"}),
               ("labels/edit", {**shape, "width": "nan"}), ("labels/edit", {**shape, "radius": -1}),
               ("labels/edit", {"box": "1,2,3"}), ("labels/edit", {"box": "0,0,0,0,1,1,0"}),
               ("labels/edit", {"hidden": "200"}), ("labels/edit", {"select": "some"}),
               ("labels/box", {"value": "{"}), ("labels/box", {"value": json.dumps({**box, "class": "ground"})}),
               ("labels/box", {"number": 77}), ("labels/nothing", {})]
        bad += [("labels/export", {"format": "log", "name": name})
                for name in ("../x.ply", "a/b.ply", ".x.ply", "-x.ply", "x", "x.txt", "", "x" * 90 + ".ply", "/x.ply")]
        bad += [("labels/import", {"name": name}) for name in ("../log.ply", "/etc/passwd", "nothing.ply")]
        log = {"log": 0, "name": "y.ply"}
        bad += [("jobs/start", {**log, "verb": verb}) for verb in ("", "serve", "segment;ls", "--help", "import")]
        bad += [("jobs/start", {**log, "verb": "segment", **more})
                for more in ({"log": 1}, {"log": 99}, {"name": "../y.ply"}, {"name": "--y.ply"}, {"name": "y"},
                             {"name": "log.txt"}, {"min_range": "1;ls"}, {"min_range": -4})]
        bad += [("jobs/start", {"verb": "fit", "log": 0, "name": "m", **more})
                for more in ({"tau": 0}, {"fitter": "--help"}, {"fitter": "voxel;ls"}, {"surface_carve": "--force"},
                             {"min_points": 1.5}, {"seed": -1})]
        bad += [("jobs/start", {"verb": "compose", "annotation": "../site.json", "primitives": 2, "name": "z"}),
                ("jobs/cancel", {"number": 12345})]
        for path, values in bad:
            with self.subTest(path=path, values=values):
                status, reply = self.post(path, **{"revision": self.revision(), **values})
                self.assertIn(status, (400, 404, 422))
                self.assertTrue(reply["error"])
        self.assertEqual(set(pathlib.Path(self.folder).rglob("*")), before)

    def test_only_the_page_may_change_labels(self):
        path = f"api/labels/edit?file=0&class=1&revision={self.revision()}"
        self.assertEqual(self.server.get(path)[0], 405)  # GET changes nothing
        own = self.server.address.split("/" + self.server.token)[0]
        for origin in (own.replace("127.0.0.1", "example.org"), "null", own.replace(":", "s:", 1), own + "0"):
            self.assertEqual(self.server.get(path, "POST", headers={"Origin": origin})[0], 403, origin)
        self.assertEqual(self.server.get(path, "POST", token="0" * 32)[0], 403)
        self.assertEqual(self.server.get(path, "POST", host="example.org")[0], 403)
        self.assertEqual(self.server.get(path, "POST", headers={"Content-Length": "5"})[0], 413)
        self.assertEqual(self.server.get(path, "POST", headers={"Origin": own})[0], 200)
        reader = serving.Server(self.folder, "log.ply")
        self.assertEqual([reader.get(p, "POST")[0] for p in (path, "api/jobs/start?verb=fit")], [403, 403])
        reader.end()

    def test_a_link_in_the_folder_is_not_followed(self):
        work = pathlib.Path(self.folder, "work")
        outside = pathlib.Path(self.folder, "outside.label")
        outside.write_bytes(b"kept")
        (work / "link.label").symlink_to(outside)
        self.assertEqual(self.post("labels/export", format="label", name="link.label")[0], 400)
        self.assertEqual(self.post("labels/import", revision=self.revision(), name="link.label")[0], 400)
        self.assertEqual(outside.read_bytes(), b"kept")
        self.assertNotIn("link.label", self.server.json_of("api/labels/files")["names"])

    def test_commands(self):
        status, job = self.post("jobs/start", verb="simulate", world=3, like=0, name="scan.ply", seed=5)
        self.assertEqual(status, 200, job)
        self.assertRegex(job["command"], r"^underbrush simulate \S+/scene --like \S+/log.ply --seed 5 -o \S+/scan.ply$")
        job = self.server.ended(job["number"])
        self.assertEqual(job["state"], "done", job)
        files = self.server.json_of("api/files")["files"]
        self.assertIn(("scan.ply", "log"), [(f["name"], f["kind"]) for f in files])
        cli_test.call("simulate", "scene", "--like", "log.ply", "--seed", "5", "-o", "same.ply", cwd=self.folder)
        same = [json.loads(cli_test.call("score", "log.ply", p, "--json", "-", cwd=self.folder).stdout)["models"]
                for p in ("same.ply", "work/scan.ply")]
        self.assertEqual(list(same[0].values()), list(same[1].values()))
        _, job = self.post("jobs/start", verb="fit", log=0, name="m")
        self.assertEqual(self.post("jobs/cancel", number=job["number"])[0], 200)
        self.assertIn(self.server.ended(job["number"])["state"], ("cancelled", "done"))

    def test_options_of_commands_are_those_of_the_tables(self):
        listed = {verb: {o["name"]: o for o in options}
                  for verb, options in self.server.json_of("api/jobs/options").items()}
        self.assertEqual(listed["fit"]["voxel-side"]["unit"], "m")
        self.assertEqual(listed["fit"]["fitter"]["choices"][0], listed["fit"]["fitter"]["default"])
        self.assertEqual((listed["simulate"]["sun"]["least"], listed["simulate"]["sun"]["most"]), (0, 1))
        self.assertEqual(listed["fit"]["tau"]["most"], 20)
        self.assertEqual(listed["fit"]["echoes"]["choices"], ["first", "all"])
        self.assertEqual(listed["score"]["protocol"]["choices"], ["kitti360", "clouds"])
        command = self.server.json_of("api/jobs/command?verb=score&real=0&simulated=0&model=3&train=0&name=s.json")["command"]
        self.assertRegex(command, r"^underbrush score \S+/log.ply \S+/log.ply --model \S+/scene --train \S+/log.ply --json ")
        instrument = self.server.json_of("api/jobs/command?verb=simulate&world=3&like=0&name=n.ply&super_sample=3x3&returns=2"
                                         "&material=tree%3Dbark%20ground%3Dsoil")["command"]
        self.assertIn(" --super-sample 3x3 --returns 2 --material tree=bark ground=soil ", instrument)
        for bad in ("-o", "../x", "a/b", " ", "x;y", "x\0", "2 log.ply"):  # neither options nor paths
            status, _ = self.post("jobs/start", verb="simulate", world=3, like=0, name="n.ply", super_sample=bad)
            self.assertEqual(status, 400, bad)
        status, _ = self.post("jobs/start", verb="score", real=0, simulated=0, name="s.json", memory="2GiB log.ply")
        self.assertEqual(status, 400)
        files = {"fit": ("start", "logs"), "simulate": ("materials",)}
        for verb, names in files.items():  # no path of a request reaches a command line
            self.assertFalse(set(names) & set(listed[verb]))
            for name in names:
                command = self.server.json_of(f"api/jobs/command?verb={verb}&log=0&world=3&like=0&name=new"
                                              f"{'.ply' if verb == 'simulate' else ''}&{name.replace('-', '_')}=7")
                self.assertNotIn("7", command["command"].split())
        command = self.server.json_of("api/jobs/command?verb=fit&log=0&name=new&fitter=voxel&voxel_side=0.5&min_points=4"
                                      "&surface_carve=true&ranges_as_given=false&seed=8123456789012345")["command"]
        self.assertRegex(command, r"^underbrush fit \S+/log.ply --seed 8123456789012345 --fitter voxel --min-points 4 "
                                  r"--voxel-side 0.5 --surface-carve -o \S+/new$")


if __name__ == "__main__":
    cli_test.main()
