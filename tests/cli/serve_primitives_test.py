#!/usr/bin/env python3
"""Tests of the primitives of a set in `underbrush serve`: their facts, lists of edits, and the command that applies them."""
import json
import pathlib
import tempfile
import unittest
import urllib.parse

import cli_test
import serving

LIBRARY, SET, MODEL = range(3)
WORK = "work"
SHARE = pathlib.Path(__file__).resolve().parents[2] / "share"


class ServePrimitives(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.temporary.name)
        serving.make_files(cls.folder)
        cls.call("primitives", "merge", "primitives", "--of-site", "creek", "--of-season", "summer", "--of-license",
                 "CC-BY-4.0", "-o", "library")
        cls.server = serving.Server(cls.folder, "library", "primitives", "model", words=("--labels", WORK))

    @classmethod
    def tearDownClass(cls):
        cls.server.end()
        cls.temporary.cleanup()

    @classmethod
    def call(cls, *words):
        done = cli_test.call(*words, cwd=cls.folder)
        assert done.returncode == 0, done.stderr
        return done.stdout

    def request(self, path, method="GET", server=None, **values):
        status, _, body = (server or self.server).get(f"api/{path}?{urllib.parse.urlencode(values)}", method=method)
        return status, json.loads(body)

    def write(self, edits, name, **values):
        return self.request("primitives/write", "POST", **{"file": LIBRARY, "name": name, "edits": json.dumps(edits), **values})

    def test_the_facts_are_those_of_list(self):
        told = self.server.json_of(f"api/primitives?file={LIBRARY}")
        listed = json.loads(self.call("primitives", "list", "library", "--json", "-"))["primitives"]
        manifest = json.loads((self.folder / "library/primitives.json").read_text(encoding="utf-8"))["primitives"]
        for one, expected, entry in zip(told["primitives"], listed, manifest, strict=True):
            self.assertEqual({k: one[k] for k in expected}, expected)
            self.assertEqual([one[k] for k in ("class", "points", "elements", "set", "license")],
                             [entry["class"], entry["points"], entry["elements"], "primitives", "CC-BY-4.0"])
        self.assertEqual([p["license"] for p in self.server.json_of(f"api/primitives?file={SET}")["primitives"]],
                         [""] * len(listed))
        classes = {c["name"]: c for c in told["classes"]}
        schema = json.loads((SHARE / "schemas/primitive-edits.json").read_text(encoding="utf-8"))
        self.assertEqual(list(classes), schema["$defs"]["change"]["properties"]["class"]["enum"])
        self.assertIn("small_tree", classes["large_shrub"]["may_become"])
        self.assertEqual({c["kind"] for c in classes.values() if "low_shrub_patch" in c["may_become"]}, {"patch"})
        self.assertEqual(self.request("primitives", file=MODEL)[0], 400)

    def test_what_is_written_is_what_merge_applies(self):
        """In one request or in parts, and by the command that the page starts."""
        told = self.server.json_of(f"api/primitives?file={LIBRARY}")
        first, second = (p["folder"] for p in told["primitives"][:2])
        edits = [{"primitive": first, "remove": True}, {"primitive": second, "class": "small_tree", "name": "Ölbaum"}]
        status, reply = self.write(edits, "edits.json", set=told["set"])
        self.assertEqual((status, reply["edits"]), (200, 2), reply)
        self.assertEqual(json.loads((self.folder / "work/edits.json").read_text(encoding="utf-8")),
                         {"format": "underbrush-primitive-edits", "version": 1, "set": told["set"], "edits": edits})
        self.assertEqual(self.write(edits[:1], "parts.json", set=told["set"], more=1)[0], 200)
        self.assertFalse((self.folder / "work/parts.json").exists(), "half of a list was written")
        self.assertEqual(self.write(edits[1:], "parts.json", set=told["set"])[1]["edits"], 2)
        self.assertEqual(*((self.folder / "work" / name).read_bytes() for name in ("edits.json", "parts.json")))
        words = {"verb": "primitives", "primitives": LIBRARY, "edits": "edits.json", "name": "edited"}
        command = self.request("jobs/command", **words)[1]["command"]
        self.assertRegex(command, rf"^underbrush primitives merge \S+/library --edits \S+/{WORK}/edits.json -o \S+/{WORK}/edited$")
        status, job = self.request("jobs/start", "POST", **words)
        self.assertEqual(status, 200, job)
        self.assertEqual(self.server.ended(job["number"])["state"], "done")
        made = next(f for f in self.server.json_of("api/files")["files"] if f["name"] == "edited")
        after = self.server.json_of(f"api/primitives?file={made['id']}")["primitives"]
        self.assertEqual(len(after), len(told["primitives"]) - 1)
        self.assertEqual([(p["folder"], p["license"], p["site"]) for p in after if p["name"] == "Ölbaum"],
                         [("small_tree/0001", "CC-BY-4.0", "creek")])
        self.call(*command.split()[1:-1], "by-hand")
        self.assertEqual(json.loads(self.call("primitives", "list", "by-hand", "--json", "-")),
                         json.loads(self.call("primitives", "list", "work/edited", "--json", "-")))

    def test_what_cannot_be_is_refused(self):
        folders = [p["folder"] for p in self.server.json_of(f"api/primitives?file={LIBRARY}")["primitives"]]
        good = {"primitive": folders[0], "name": "a"}
        for edits, status, reason in (([{"primitive": "tree/1", "remove": True}], 422, "bad.json: edits[0].primitive"),
                                      ([good, good], 422, "edits[1].primitive"), ({}, 400, "edits: not a list"),
                                      ([{**good, "class": "grass"}], 422, "edits[0].class"),
                                      ([{"primitive": f, "remove": True} for f in folders], 422, "all primitives")):
            got, reply = self.write(edits, "bad.json")
            self.assertEqual(got, status, reply)
            self.assertIn(reason, reply["error"])
        self.assertEqual(self.write([good], "bad.json", set="xxh3:0")[0], 422)
        self.assertEqual(self.write([good], "bad.json", file=MODEL)[0], 400)
        self.assertEqual(self.write([good], "../out.json")[0], 400)
        self.assertEqual(self.write([good], "out.txt")[0], 400)
        # A part that is refused begins its list anew.
        self.assertEqual(self.write([good], "anew.json", more=1)[1]["edits"], 1)
        self.assertEqual(self.write([good], "anew.json")[0], 422)
        self.assertEqual(self.write([good], "anew.json")[1]["edits"], 1)
        self.assertEqual(self.write([good], "anew.json")[0], 400, "a file of this name is there")
        self.assertEqual(self.request("primitives/write", file=LIBRARY, name="get.json")[0], 405)
        self.assertFalse({p.name for p in (self.folder / "work").iterdir()} & {"bad.json", "out.txt", "get.json"})
        reader = serving.Server(self.folder, "library")
        try:
            self.assertEqual(self.request("primitives", file=0, server=reader)[0], 200)
            self.assertEqual(self.request("primitives/write", "POST", reader, file=0, name="a.json", edits="[]")[0], 403)
        finally:
            reader.end()


if __name__ == "__main__":
    cli_test.main()
