#!/usr/bin/env python3
"""Tests of `optimize`: the configuration that it writes, interruption and resumption."""
import json
import pathlib
import signal
import subprocess
import unittest

import cli_test

BAD_START = ["--clusters-per-point", "0.005", "--tau", "5", "--min-points", "3"]


class Tuning(cli_test.OnALog):
    def setUp(self):
        super().setUp()
        cli_test.write_log(self.folder, scans=8)

    def call(self, *words):
        return cli_test.call(*words, cwd=self.folder)

    def results(self, *words):
        done = self.call("optimize", "log.ply", *words, "--json", "-")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        return json.loads(done.stdout)

    def text(self, name):
        return pathlib.Path(self.folder, name).read_text()

    def test_a_bad_start_is_improved_and_the_result_is_what_fit_takes(self):
        found = self.results("-o", "p.yaml", "--budget", "20", "--tune", "clusters-per-point", "tau",
                             "--report", "r", *BAD_START)
        self.assertLess(found["tuned"]["objective"], found["start"]["objective"])
        self.assertEqual(set(found["parameters"]), {"clusters-per-point", "tau"})
        self.assertEqual(found["fixed"], {"min-points": "3"})
        self.assertLessEqual(len(found["evaluations"]), 20)
        self.assertEqual(min(e["objective"] for e in found["evaluations"]), found["tuned"]["objective"])
        done = self.call("fit", "log.ply", "-o", "model", "--config", "p.yaml")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        manifest = json.loads(self.text("model/model.json"))
        self.assertEqual(manifest["tau"], found["parameters"]["tau"]["tuned"])
        self.assertIn("<svg", self.text("r/index.html"))

    def test_every_fitter_has_parameters(self):
        for fitter in ("voxel", "top_down", "bottom_up", "ground_mesh", "surface", "rimls",
                       "likelihood"):
            with self.subTest(fitter):
                found = self.results("-o", "p.yaml", "--budget", "2", "--fitter", fitter)
                self.assertGreaterEqual(len(found["parameters"]), 3)
                done = self.call("fit", "log.ply", "-o", "model", "--config", "p.yaml")
                self.assertEqual((done.returncode, done.stderr), (0, ""))
                self.assertEqual(json.loads(self.text("model/model.json"))["fitter"], fitter)

    def test_threads_change_nothing(self):
        for objective in ("packet_f1", "nll"):
            texts = []
            for threads in ("1", "3"):
                self.results("-o", "p.yaml", "--budget", "4", "--threads", threads, "--objective", objective)
                texts.append(self.text("p.yaml"))
            self.assertEqual(*texts)

    def interrupted(self, *words, after):
        """Ends the run with Ctrl-C once `after` evaluations are reported."""
        process = subprocess.Popen([cli_test.PROGRAM, "optimize", "log.ply", *words], cwd=self.folder, text=True,
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        for _ in range(after):
            process.stderr.readline()
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=60)
        last = errors.splitlines()[-1]
        self.assertEqual((process.returncode, last), (-signal.SIGINT, "underbrush: interrupted"))

    def test_interrupted_and_resumed_is_as_uninterrupted(self):
        words = ["-o", "p.yaml", "--budget", "40"]
        whole = self.results(*words)
        text = self.text("p.yaml")
        for name in ("p.yaml", "p.yaml.checkpoint"):
            pathlib.Path(self.folder, name).unlink()
        before = self.left()
        for after in (3, 7):
            self.interrupted(*words, *(["--resume"] if after > 3 else []), after=after - 2)
            self.assertEqual(self.left() - before, {"p.yaml.checkpoint"})
            kept = json.loads(self.text("p.yaml.checkpoint"))["evaluations"]
            self.assertGreaterEqual(len(kept), after - 2)
            self.assertLess(len(kept), len(whole["evaluations"]))
            self.assert_fails(self.call("optimize", "log.ply", *words), 2, "--resume")
        again = self.results(*words, "--resume")
        self.assertGreaterEqual(again["resumed_from"], 3)
        self.assertEqual(again["evaluations"], whole["evaluations"])
        self.assertEqual(self.text("p.yaml"), text)
        # With a larger budget it continues from the end.
        more = self.results("-o", "p.yaml", "--budget", "44", "--resume")
        self.assertEqual(more["resumed_from"], len(whole["evaluations"]))
        self.assertEqual(more["evaluations"][:len(whole["evaluations"])], whole["evaluations"])

    def test_a_checkpoint_of_something_else_is_refused(self):
        self.results("-o", "p.yaml", "--budget", "3")
        other = ["optimize", "log.ply", "-o", "p.yaml", "--budget", "4", "--resume"]
        for words in (["--seed", "2"], ["--tau", "2"], ["--objective", "nll"], ["--slice", "0", "5"],
                      ["--tune", "tau"]):
            with self.subTest(words):
                self.assert_fails(self.call(*other, *words), 3, "p.yaml.checkpoint", "another search")
        checkpoint = pathlib.Path(self.folder, "p.yaml.checkpoint")
        whole = checkpoint.read_bytes()
        for text in (b"", whole[:len(whole) // 2], b"[1]", bytes(range(256))):
            checkpoint.write_bytes(text)
            self.assert_fails(self.call(*other), 3, "p.yaml.checkpoint")

    def test_densities_of_a_scene(self):
        cli_test.write_log(self.folder)
        self.run_all(until="simulate")
        found = self.results("-o", "d.yaml", "--budget", "5", "--annotation", "site.json",
                             "--primitives", "primitives")
        self.assertTrue(found["parameters"])
        done = self.call("compose", "site.json", "primitives", "-o", "tuned", "--config", "d.yaml", "--json", "-")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        site = json.loads(self.text("site.json"))
        site["objects"] = []
        pathlib.Path(self.folder, "site.json").write_text(json.dumps(site))
        self.assert_fails(self.call("optimize", "log.ply", "-o", "d.yaml", "--annotation", "site.json",
                                    "--primitives", "primitives"), 3, "no objects")

    def test_wrong_usage(self):
        for words, word in ((["--tune", "clusters-per-pont"], "'clusters-per-point'"),
                            (["--tune", "voxel-side"], "voxel-side"), (["--tune", "tau", "tau"], "twice"),
                            (["--annotation", "site.json"], "--primitives"), (["--budget", "0"], "--budget"),
                            (["--slice", "90", "99"], "slice"), (["--slice", "3", "1"], "slice"),
                            (["--algorithm", "bobyqa", "--tune", "tau"], "bobyqa"),
                            (["--objective", "beauty"], "--objective")):
            with self.subTest(words):
                before = self.left()
                self.assert_fails(self.call("optimize", "log.ply", "-o", "p.yaml", *words), 2, word)
                self.assertEqual(self.left(), before)


if __name__ == "__main__":
    cli_test.main()
