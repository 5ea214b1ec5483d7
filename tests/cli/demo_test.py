#!/usr/bin/env python3
"""The demo: a generated site and a real scan, each fitted and scored, in one report."""
import json
import os
import pathlib
import re
import subprocess
import tempfile
import unittest

import cli_test

SHARE = pathlib.Path(__file__).resolve().parents[2] / "share"
MODELS = ["likelihood", "surface"]


def demo(folder, *words, share=SHARE):
    """Runs the demo with a sensor of few beams."""
    small = (SHARE / "sensors/velodyne-vlp16.yaml").read_text()
    for name, value in (("name", "small"), ("rate_hz", "2"), ("firing_period_us", "4000")):
        small = re.sub(rf"^{name}: .*", f"{name}: {value}", small, flags=re.MULTILINE)
    pathlib.Path(folder, "small.yaml").write_text(small)
    return subprocess.run([cli_test.PROGRAM, "demo", "--sensor", "small.yaml", "--sub-rays", "1", *words], cwd=folder,
                          env=dict(os.environ, UNDERBRUSH_SHARE=str(share)), text=True, stdin=subprocess.DEVNULL,
                          capture_output=True, check=False, timeout=300)


class Demo(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        scratch = tempfile.TemporaryDirectory()
        cls.addClassCleanup(scratch.cleanup)
        cls.whole = pathlib.Path(scratch.name)
        cls.done = demo(cls.whole, "--json", "scores.json")

    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)

    def test_both_parts(self):
        done = self.done
        self.assertEqual(done.returncode, 0, done.stderr)
        for part in ("demo", "demo/real"):
            for name in ("train.ply", "test.ply", "likelihood.ply", "surface.ply"):
                self.assertGreater((self.whole / part / name).stat().st_size, 1000)
            for model in MODELS:
                self.assertTrue((self.whole / part / model / "model.json").is_file())
        with self.subTest("text"):
            synthetic, real, last = re.match(r"(Synthetic: .*)^(Real: .*)^(report: .*)", done.stdout,
                                             re.DOTALL | re.MULTILINE).groups()
            for table in (synthetic, real):
                self.assertIn("packet error, m", table)
                self.assertRegex(table, r"\n  \d+ beams +likelihood +surface +always hit +look-up\n")
            self.assertEqual(last, "report: demo/report/index.html\n")
            for line in done.stderr.splitlines():
                self.assertRegex(line, r"^\[ *\d+\.\d s\] ")
        with self.subTest("json"):
            site = json.loads((self.whole / "scores.json").read_text())
            real = site.pop("real")
            self.assertIs(site["synthetic"], True)
            self.assertIs(real["synthetic"], False)
            self.assertEqual(set(site) - set(real), {"seconds", "program"})
            self.assertEqual(set(real) - set(site), set())
            for part in (site, real):
                self.assertEqual(list(part["models"]), MODELS)
                self.assertEqual(set(part["models"]["surface"]), set(site["models"]["surface"]))
                self.assertEqual(list(part["baselines"]), ["always hit", "look-up"])
                self.assertEqual(part["baselines"]["always hit"]["informedness"], 0)
            self.assertEqual(real["beams"], 51931)
            self.assertGreater(real["models"]["likelihood"]["f1"], 0.94)
            self.assertGreater(real["models"]["surface"]["f1"], 0.9)
            self.assertTrue(0.55 < real["models"]["likelihood"]["packet_error_m"] < 0.7)
        with self.subTest("page"):
            page = (self.whole / "demo/report/index.html").read_text()
            titles = re.findall(r"<h2>((?:Synthetic|Real): [^<]+)</h2>", page)
            self.assertEqual([t.split(":")[0] for t in titles], ["Synthetic", "Real"])
            links = re.findall(r'href="#([^"]+)"', page)
            ids = re.findall(r'<[^<>]* id="([^"]+)"', page)
            self.assertEqual(len(ids), len(set(ids)))
            self.assertTrue(links and set(links) <= set(ids), links)

    def test_without_the_scan(self):
        for words, lines in (([], 1), (["--only", "site"], 0)):
            with self.subTest(words):
                done = demo(self.folder, *words, share="/nonexistent")
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assertEqual(done.stderr.count("no real scan"), lines)
                self.assertNotIn("Real:", done.stdout)
                self.assertFalse((self.folder / "demo/real").exists())
                for log in ("train.ply", "test.ply"):  # the other part changes no bit
                    self.assertTrue((self.folder / "demo" / log).read_bytes() ==
                                    (self.whole / "demo" / log).read_bytes())

    def test_only_the_scan(self):
        done = demo(self.folder, "--only", "real", "--json", "-")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(set(json.loads(done.stdout)), {"real", "seconds", "program"})
        self.assertEqual({p.name for p in (self.folder / "demo").iterdir()}, {"real", "report"})
        absent = demo(self.folder, "--only", "real", "-o", "absent", share="/nonexistent")
        self.assertEqual(absent.returncode, 3)
        self.assertRegex(absent.stderr, r"^underbrush: examples/marv_forest.pcd: [^\n]+\n$")
        self.assertFalse((self.folder / "absent").exists())

    def test_the_verbs_give_the_same(self):
        """The real part is what import, split, fit and simulate make of the scan."""
        scan = SHARE / "examples/marv_forest.pcd"
        for words in (["import", scan, "--unknown-below-deg", "-13", "-o", "log.ply"],
                      ["split", "log.ply", "--columns", "2", "--train", "train.ply", "--test", "test.ply"],
                      ["fit", "train.ply", "-o", "model"],
                      ["simulate", "model", "--like", "test.ply", "-o", "sim.ply"]):
            done = cli_test.call(*words, cwd=self.folder)
            self.assertEqual(done.returncode, 0, done.stderr)

        def rows(path):
            return path.read_bytes().partition(b"end_header\n")[2]

        for ours, theirs in (("log", "log"), ("train", "train"), ("test", "test"), ("sim", "likelihood")):
            self.assertTrue(rows(self.folder / f"{ours}.ply") == rows(self.whole / f"demo/real/{theirs}.ply"), ours)


if __name__ == "__main__":
    cli_test.main()
