#!/usr/bin/env python3
"""Tests of what moves in `underbrush serve`: the list of actors, edits of them, and boxes that become tracks."""
import csv
import json
import pathlib
import tempfile
import unittest
import urllib.parse

import cli_test
import serving

LOG, ACTORS, SCENE, MODEL = range(4)


def beams_of(path):
    """The binary part of a log, without the header, which names the command."""
    return path.read_bytes().split(b"end_header\n", 1)[1]


class ServeActors(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.temporary.name)
        serving.make_files(cls.folder)
        done = cli_test.call("actors", *cli_test.JOBS["actors"], "--json", "actors.json", cwd=cls.folder)
        assert done.returncode == 0, done.stderr
        cls.learnt = json.loads((cls.folder / "actors.json").read_text())["actors"]
        cls.server = serving.Server(cls.folder, "log.ply", "actors", "scene", "model", words=("--labels", "work"))
        cls.server.octree(LOG)

    @classmethod
    def tearDownClass(cls):
        cls.server.end()
        cls.temporary.cleanup()

    def request(self, path, method="GET", server=None, **values):
        status, _, body = (server or self.server).get(f"api/{path}?{urllib.parse.urlencode(values)}", method=method)
        return status, json.loads(body)

    def actors(self, *edits, file=ACTORS):
        status, reply = self.request("actors", file=file, **({"edits": json.dumps(edits)} if edits else {}))
        self.assertEqual(status, 200, reply)
        return reply

    def poses(self, *edits, name="other-1"):
        return [part["poses"] for a in self.actors(*edits)["actors"] if a["name"] == name for part in a["parts"]]

    def test_the_list_is_what_was_learnt(self):
        reply = self.actors()
        self.assertTrue(reply["editable"])
        told = [{k: a[k] for k in ("name", "class", "returns", "scans")} for a in reply["actors"]]
        self.assertEqual(told, [{k: a[k] for k in told[0]} for a in self.learnt])
        origin = self.server.json_of(f"api/world?file={ACTORS}")["origin_m"]
        table = [line.split() for line in (self.folder / "actors/movers/0000.txt").read_text().splitlines()]
        rows = [[float(v) for v in row] for row in table if row[0] != "#"]
        for told, (t, x, y, z, qx, qy, qz, qw) in zip(self.poses()[0], rows, strict=True):
            for a, b in zip(told, (t, x - origin[0], y - origin[1], z - origin[2], qw, qx, qy, qz)):
                self.assertAlmostEqual(a, b, delta=1e-9)
        still = self.actors(file=SCENE)
        self.assertEqual((still["editable"], still["actors"], still["list"]["edits"]), (False, [], []))
        self.assertEqual(self.request("actors", file=LOG)[0], 400)

    def test_edits_are_applied_in_their_order(self):
        before = self.poses()[0]
        other = {"actor": "other-1"}
        shift = {"edit": "shift", "translation_m": [1, -2, 0.5], **other}
        for a, b in zip(self.poses(shift)[0], before, strict=True):
            for got, expected in zip(a, [b[0], b[1] + 1, b[2] - 2, b[3] + 0.5, *b[4:]], strict=True):
                self.assertAlmostEqual(got, expected, delta=1e-9)
        copy = {"edit": "copy", "as": "twin", **other}
        late = {"edit": "delay", "actor": "twin", "by_s": 0.25}
        for a, b in zip(self.poses(copy, late, shift, name="twin")[0], before, strict=True):
            self.assertAlmostEqual(a[0], b[0] + 0.25, delta=1e-9)
            self.assertEqual(a[1:], b[1:])
        self.assertEqual(self.poses({"edit": "remove", **other}), [])
        self.assertEqual(self.poses(copy, {"edit": "remove", **other}, name="twin"), [before])

    def test_simulate_takes_what_is_written(self):
        """The edits of the page, written and simulated by the page, are those of the command line."""
        edits = [{"edit": "copy", "actor": "other-1", "as": "twin"},
                 {"edit": "shift", "actor": "twin", "translation_m": [-0.353, 0.75, 0], "at_s": 0.05, "within_s": 90}]
        status, reply = self.request("actors/write", "POST", file=ACTORS, name="edits.json", edits=json.dumps(edits))
        self.assertEqual(status, 200, reply)
        written = json.loads((self.folder / "work/edits.json").read_text())
        self.assertEqual((written["actors"], written["edits"]), ("../actors", edits))
        scans = {}
        for name, actors in (("edited.ply", "work/edits.json"), ("plain.ply", "actors")):
            done = cli_test.call("simulate", "model", "--actors", actors, "--like", "log.ply", "-o", name, cwd=self.folder)
            self.assertEqual(done.returncode, 0, done.stderr)
            scans[name] = beams_of(self.folder / name)
        self.assertFalse(scans["edited.ply"] == scans["plain.ply"], "the twin stands where no beam comes by")
        status, job = self.request("jobs/start", "POST", verb="simulate", world=MODEL, like=LOG, actors="edits.json",
                                   name="job.ply")
        self.assertEqual(status, 200, job)
        self.assertEqual(self.server.ended(job["number"])["state"], "done")
        self.assertTrue(beams_of(self.folder / "work/job.ply") == scans["edited.ply"], "the job gives other bits")

    def test_what_is_written_opens_again(self):
        """A list that was written, opened, and written again is the same to the byte, comments and numbers included."""
        edits = [{"edit": "move", "actor": "other-1", "translation_m": [1e-7, -0.353, 1e21], "yaw_rad": 3.141592653589793},
                 {"edit": "delay", "actor": "other-1", "by_s": 0.1, "comment": "late"}]
        written = None
        for name in ("first.json", "again.json"):
            sent = json.dumps(edits) if written is None else json.dumps({**json.loads(written), "comment": "mine"})
            status, reply = self.request("actors", file=ACTORS, edits=sent, name=name)
            self.assertEqual((status, reply["list"]["edits"]), (200, edits), reply)
            sent = json.dumps({**reply["list"], "comment": "mine"})
            status, reply = self.request("actors/write", "POST", file=ACTORS, name=name, edits=sent)
            self.assertEqual(status, 200, reply)
            text = (self.folder / "work" / name).read_bytes()
            self.assertTrue(written in (None, text), "the file has other bytes")
            written = text
        server = serving.Server(self.folder, "model", "work/first.json", words=("--labels", "other"))
        try:
            told = server.json_of("api/files")
            self.assertEqual([f["name"] for f in told["files"]], ["model", "actors"])
            self.assertEqual(told["edits"], {"file": 1, "list": json.loads(written)})
        finally:
            server.end()

    def test_a_list_that_cannot_be_opened_names_its_entry(self):
        """In one line: the file, the entry and the reason, from the page and on the command line."""
        whole = {"format": "underbrush-actor-edits", "version": 1, "actors": "actors", "edits": []}
        remove, delay = {"edit": "remove", "actor": "other-1"}, {"edit": "delay", "actor": "other-1", "by_s": 1}
        for change, reason in (({"edits": [remove, remove]}, "edits[1].actor: there is no such actor: 'other-1'"),
                               ({"edits": [{"edit": "delay", "actor": "other-1"}]}, "edits[0]: has no member 'by_s'"),
                               ({"edits": [delay, {"edit": "model", "actor": "other-1", "model": "model"}]}, "edits[1] names a file"),
                               ({"version": 2}, "version"), ({"format": "other"}, "format: not a list of edits"),
                               ({"author": "me"}, "unknown member 'author'"), ({"edits": 3}, "edits")):
            with self.subTest(change=change):
                status, reply = self.request("actors", file=ACTORS, edits=json.dumps({**whole, **change}), name="bad.json")
                self.assertIn(status, (400, 422))
                self.assertTrue(reply["error"].startswith("bad.json: ") and reason in reply["error"], reply)
                (self.folder / "bad.json").write_text(json.dumps({**whole, **change}), encoding="utf-8")
                done = cli_test.call("serve", "model", "bad.json", cwd=self.folder)
                self.assertEqual(done.returncode, 3, done.stderr)
                self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
                self.assertTrue("bad.json: " in done.stderr and reason in done.stderr, done.stderr)

    def test_what_cannot_be_is_refused(self):
        nobody = {"edit": "remove", "actor": "nobody"}
        for edits, status in (([nobody], 422), ([{"edit": "paint", "actor": "other-1"}], 422), ({}, 400), ("x", 400),
                              ([{"edit": "trajectory", "actor": "other-1", "trajectory": "/etc/passwd"}], 400),
                              ([{"edit": "model", "actor": "other-1", "model": "../model"}], 400),
                              ([{"edit": "shift", "actor": "other-1", "translation_m": [0, 0, 0], "at_s": 1}], 422)):
            with self.subTest(edits=edits):
                got, reply = self.request("actors", file=ACTORS, edits=json.dumps(edits))
                self.assertEqual(got, status, reply)
                wrote, _ = self.request("actors/write", "POST", file=ACTORS, name="bad.json", edits=json.dumps(edits))
                self.assertEqual(wrote, status)
        write = {"path": "actors/write", "method": "POST", "file": ACTORS}
        self.assertEqual(self.request(**{**write, "name": "../out.json"})[0], 400)
        self.assertEqual(self.request(**{**write, "name": "out.txt"})[0], 400)
        self.assertEqual(self.request(**{**write, "name": "still.json", "file": SCENE})[0], 400)
        self.assertEqual(self.request(**{**write, "name": "get.json", "method": "GET"})[0], 405)
        self.assertEqual(self.request(**{**write, "name": "twice.json"})[0], 200)
        self.assertEqual(self.request(**{**write, "name": "twice.json"})[0], 400)
        start = {"path": "jobs/start", "method": "POST", "verb": "simulate", "world": MODEL, "like": LOG, "name": "no.ply"}
        self.assertEqual(self.request(**start, actors="nothing.json")[0], 400)
        names = {p.name for p in (self.folder / "work").iterdir()}
        self.assertFalse(names & {"bad.json", "still.json", "get.json", "out.txt", "no.ply"}, names)
        reader = serving.Server(self.folder, "actors")
        try:
            self.assertEqual(self.request(**{**write, "file": 0, "name": "a.json", "server": reader})[0], 403)
        finally:
            reader.end()

    def put(self, **box):
        revision = self.server.json_of(f"api/labels?file={LOG}")["revision"]
        return self.request("labels/box", "POST", file=LOG, revision=revision, value=json.dumps(box))[0]

    def test_boxes_in_scans_become_tracks(self):
        with open(self.folder / "posts.csv", encoding="utf-8") as file:
            truth = list(csv.DictReader(file))
        for scan, row in enumerate(truth):
            at = [float(row["x"]), float(row["y"]), float(row["z"]) - 1.3]
            box = {"class": "other", "position_m": at, "yaw_rad": 0, "min_m": [-0.5, -0.5, 0], "max_m": [0.5, 0.5, 2.6],
                   "track": 1, "scan": scan}
            self.assertEqual(self.put(**box), 200)
            for bad in ({"class": "small_tree"}, {"track": 0}, {"track": "a"}, {"scan": -1}):
                self.assertEqual(self.put(**{**box, **bad}), 400, bad)
            self.assertEqual(self.put(**{k: v for k, v in box.items() if k != "scan"}), 400)
        status, reply = self.request("labels/export", "POST", file=LOG, format="tracks", name="tracks.csv")
        self.assertEqual((status, reply.get("boxes")), (200, len(truth)), reply)
        with open(self.folder / "work/tracks.csv", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        with open(self.folder / "log.csv", encoding="utf-8") as file:
            beams = [{k: float(v) for k, v in beam.items()} for beam in csv.DictReader(file)]
        for scan, (row, expected) in enumerate(zip(rows, truth, strict=True)):
            for key in ("id", "x", "y", "z", "yaw", "length", "width", "height"):
                self.assertAlmostEqual(float(row[key]), float(expected[key]), delta=1e-6, msg=key)
            inside = [b["time"] for b in beams if b["scan"] == scan and b["hit"] and all(
                abs(b[k] - float(expected[k])) <= half for k, half in (("x", 0.5), ("y", 0.5), ("z", 1.3)))]
            self.assertGreater(len(inside), 1)
            self.assertAlmostEqual(float(row["time"]), sum(inside) / len(inside), delta=1e-6)
        done = cli_test.call("actors", "log.ply", "--boxes", "work/tracks.csv", "-o", "again", "--least-returns", "10",
                             cwd=self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("other-1", done.stdout)
        # A box of a track is none of an annotation.
        status, reply = self.request("labels/export", "POST", file=LOG, format="annotation", name="none.json", ground=MODEL)
        self.assertEqual((status, reply["error"]), (400, "there is no box"))


if __name__ == "__main__":
    cli_test.main()
