#!/usr/bin/env python3
"""Tests of `fit --update`: what it says, what it leaves alone, and what it refuses."""
import json
import pathlib
import shutil

import cli_test


class Update(cli_test.OnALog):
    def setUp(self):
        super().setUp()
        cli_test.write_log(self.folder, scans=8)
        self.fine("split", "log.ply", "--every", "2", "--train", "a.ply", "--test", "b.ply")
        self.fine("fit", "a.ply", "-o", "model", "--min-points", "4", "--tau", "2.5")

    def call(self, *words):
        return cli_test.call(*words, cwd=self.folder)

    def fine(self, *words):
        done = self.call(*words)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        return done.stdout

    def bytes_of(self, model):
        files = sorted(pathlib.Path(self.folder, model).rglob("*.*"))
        return {file.name: file.read_bytes() for file in files if file.is_file()}

    def refused(self, code, text, *words):
        done = self.call(*words)
        self.assertEqual(done.returncode, code, done.stderr)
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        self.assertIn(text, done.stderr)
        output = words[words.index("-o") + 1]
        self.assertTrue(output == "model" or not pathlib.Path(self.folder, output).exists())

    def test_a_log_is_added_and_the_model_before_stays(self):
        before = self.bytes_of("model")
        said = self.fine("fit", "b.ply", "--update", "model", "-o", "grown")
        self.assertRegex(said, r"tiles +\d+ of \d+ touched, \d+ fitted anew")
        self.assertRegex(said, r"ellipsoids +\d+ kept, \d+ added, \d+ dropped")
        self.assertEqual(self.bytes_of("model"), before)
        training = json.loads(pathlib.Path(self.folder, "grown/training/training.json").read_text())
        self.assertEqual([log["file"] for log in training["logs"]], ["a.ply", "b.ply"])
        self.assertEqual(training["parameters"]["tau"], 2.5)
        self.refused(3, "already", "fit", "b.ply", "--update", "grown", "-o", "again")

    def test_threads_do_not_matter(self):
        for n in ("1", "2"):
            self.fine("fit", "b.ply", "--update", "model", "-o", f"grown{n}", "--threads", n)
        self.assertEqual(self.bytes_of("grown1"), self.bytes_of("grown2"))

    def test_logs_may_move_but_not_change(self):
        pathlib.Path(self.folder, "there").mkdir()
        shutil.move(pathlib.Path(self.folder, "a.ply"), pathlib.Path(self.folder, "there/a.ply"))
        self.refused(3, "--logs FOLDER", "fit", "b.ply", "--update", "model", "-o", "grown")
        self.fine("fit", "b.ply", "--update", "model", "-o", "grown", "--logs", "there")
        shutil.rmtree(pathlib.Path(self.folder, "grown"))
        shutil.copy(pathlib.Path(self.folder, "log.ply"), pathlib.Path(self.folder, "a.ply"))
        self.refused(3, "not the log", "fit", "b.ply", "--update", "model", "-o", "grown")

    def test_what_cannot_be_updated_is_refused(self):
        self.fine("fit", "a.ply", "-o", "mesh", "--fitter", "surface")
        self.refused(3, "cannot be updated", "fit", "b.ply", "--update", "mesh", "-o", "grown")
        self.refused(3, "no such model", "fit", "b.ply", "--update", "nothing", "-o", "grown")
        damaged = pathlib.Path(self.folder, "model/training/tiles.ply")
        damaged.write_bytes(damaged.read_bytes()[:-9])
        self.refused(3, "tiles.ply", "fit", "b.ply", "--update", "model", "-o", "grown")

    def test_the_parameters_of_the_model_hold(self):
        self.refused(2, "--tau", "fit", "b.ply", "--update", "model", "-o", "grown", "--tau", "3")
        self.refused(2, "--seed", "fit", "b.ply", "--update", "model", "-o", "grown", "--seed", "3")
        self.refused(2, "--update", "fit", "b.ply", "-o", "grown", "--growth", "0")
        self.refused(2, "replace the input", "fit", "b.ply", "--update", "model", "-o", "model")


if __name__ == "__main__":
    cli_test.main()
