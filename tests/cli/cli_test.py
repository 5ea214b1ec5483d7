#!/usr/bin/env python3
"""The command line as its users meet it: help texts against golden files, exit codes, one-line errors.

  cli_test.py --program build/bin/underbrush             runs all checks
  cli_test.py --program build/bin/underbrush --update    rewrites tests/cli/golden from the program
"""
import argparse
import difflib
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree

GOLDEN = pathlib.Path(__file__).parent / "golden"
PROGRAM = None


def call(*words, cwd=None):
    # A terminal's width or language must not change what is compared.
    environment = {k: v for k, v in os.environ.items() if k not in ("COLUMNS", "LANG", "LC_ALL")}
    return subprocess.run([PROGRAM, *map(str, words)], cwd=cwd, env=environment, text=True,
                          stdin=subprocess.DEVNULL, capture_output=True, check=False, timeout=120)


def verbs():
    """The verbs that the root's help lists."""
    listed = call("--help").stdout.partition("Subcommands:\n")[2]
    return re.findall(r"^  ([a-z][a-z-]*) ", listed, re.MULTILINE)


def help_texts():
    """{golden file: help text} of the root and of each verb."""
    texts = {"underbrush.txt": call("--help").stdout}
    texts.update({f"{verb}.txt": call(verb, "--help").stdout for verb in verbs()})
    return texts


def update():
    GOLDEN.mkdir(exist_ok=True)
    for old in GOLDEN.glob("*.txt"):
        old.unlink()
    for name, text in help_texts().items():
        (GOLDEN / name).write_text(text)


class Help(unittest.TestCase):
    def test_golden(self):
        texts = help_texts()
        golden = {p.name: p.read_text() for p in GOLDEN.glob("*.txt")}
        changes = []
        for name in sorted(set(texts) | set(golden)):
            changes += difflib.unified_diff(golden.get(name, "").splitlines(),
                                            texts.get(name, "").splitlines(),
                                            f"golden/{name}", f"--help of {name[:-4]}", lineterm="")
        if changes:
            self.fail("\n".join(changes) + "\nIf that is meant: tests/cli/cli_test.py --update")

    def test_every_verb_shows_an_example_of_itself(self):
        for verb in verbs():
            with self.subTest(verb):
                self.assertIn(f"Example:\n  underbrush {verb}", call(verb, "--help").stdout)

    def test_version(self):
        done = call("--version")
        self.assertEqual(done.returncode, 0)
        self.assertRegex(done.stdout, r"^underbrush \d+\.\d+\.\d+\n$")

    def test_every_verb_prints_a_configuration(self):
        for verb in verbs():
            if verb not in ("dump-config", "completion"):
                with self.subTest(verb):
                    done = call("dump-config", verb)
                    self.assertEqual((done.returncode, done.stderr), (0, ""))


class Failing(unittest.TestCase):
    def assert_fails(self, done, code, *words):
        """One line on standard error, nothing on standard output, the exit code of the contract."""
        where = " ".join(map(str, done.args[1:]))
        self.assertEqual(done.returncode, code, f"{where}\n{done.stderr}")
        self.assertRegex(done.stderr, r"\Aunderbrush: [^\n]+\n\Z", where)
        self.assertEqual(done.stdout, "", where)
        for word in words:
            self.assertIn(word, done.stderr, where)


class WrongUsage(Failing):
    def test_of_the_root(self):
        for words in ([], ["no-such-verb"], ["--no-such-option"]):
            with self.subTest(words):
                self.assert_fails(call(*words), 2, "--help")

    def test_of_each_verb(self):
        for verb in verbs():
            with self.subTest(verb):
                self.assert_fails(call(verb, "--no-such-option"), 2, f"underbrush {verb} --help")
                if "REQUIRED" in call(verb, "--help").stdout:
                    self.assert_fails(call(verb), 2)

    def test_of_the_common_options(self):
        for verb in verbs():
            if "--threads" in call(verb, "--help").stdout:
                with self.subTest(verb):
                    self.assert_fails(call(verb, "--threads", "-1"), 2)
                    self.assert_fails(call(verb, "--seed", "many"), 2)


# What each verb is told; BAD stands for the bad input. Nothing may stand at `out` afterwards.
READERS = {
    "import": ["BAD", "-o", "out"],
    "info": ["BAD"],
    "split": ["BAD", "--every", "2", "--train", "out", "--test", "out-too"],
    "fit": ["BAD", "-o", "out"],
    "simulate": ["BAD", "--like", "BAD", "-o", "out"],
    "score": ["BAD", "BAD"],
}
HEADER = "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty double x\n"
BAD_INPUTS = {
    "missing.ply": None,
    "empty.ply": b"",
    "noise.ply": bytes(range(256)) * 8,
    "cut.ply": HEADER.format(5).encode(),
    "absurd.ply": HEADER.format(10**18).encode() + b"property double y\nproperty double z\nend_header\n",
    "text.txt": b"not a log\n",
    "folder": "a folder",
}


class BadInput(Failing):
    def test_of_each_reader(self):
        for verb in verbs():
            for name, content in BAD_INPUTS.items() if verb in READERS else ():
                with self.subTest(verb=verb, bad=name), tempfile.TemporaryDirectory() as folder:
                    bad = pathlib.Path(folder, name)
                    if content == "a folder":
                        bad.mkdir()
                    elif content is not None:
                        bad.write_bytes(content)
                    words = [name if word == "BAD" else word for word in READERS[verb]]
                    self.assert_fails(call(verb, *words, cwd=folder), 3, name)
                    left = {p.name for p in pathlib.Path(folder).iterdir()} - {name}
                    self.assertFalse(left, f"{verb} {words} left {left}")


class Sensors(Failing):
    def test_catalogue(self):
        listed = json.loads(call("sensors", "list", "--json", "-").stdout)
        self.assertGreaterEqual(len(listed), 10)
        for name in (sensor["name"] for sensor in listed):
            with self.subTest(name), tempfile.TemporaryDirectory() as folder:
                done = call("sensors", "show", name, "--plot", "p.svg", "--json", "s.json", cwd=folder)
                self.assertEqual((done.returncode, done.stderr), (0, ""))
                shown = json.loads(pathlib.Path(folder, "s.json").read_text())
                self.assertEqual(shown["name"], name)
                self.assertTrue(shown["sources"])
                self.assertTrue(xml.etree.ElementTree.parse(pathlib.Path(folder, "p.svg")))

    def test_echoes_of_two_surfaces_and_their_waveform(self):
        with tempfile.TemporaryDirectory() as folder:
            done = call("sensors", "echo", "ibeo-lux-2010", "--target", "30:leaf:0.4", "--target",
                        "33:soil:0.6", "--csv", "w.csv", "--plot", "w.svg", "--json", "-", cwd=folder)
            echoes = json.loads(done.stdout)["echoes"]
            self.assertEqual([round(e["range_m"]) for e in echoes], [30, 33])
            rows = pathlib.Path(folder, "w.csv").read_text().splitlines()
            self.assertEqual(rows[0], "range_m,signal")
            highest = max(rows[1:], key=lambda row: float(row.split(",")[1]))
            self.assertAlmostEqual(float(highest.split(",")[0]), 30, delta=0.5)

    def test_what_is_wrong(self):
        self.assert_fails(call("sensors", "show", "vlp61"), 2, "'velodyne-vlp16'")
        self.assert_fails(call("sensors", "show"), 2, "sensors list")
        self.assert_fails(call("sensors", "echo", "velodyne-vlp16"), 2, "--target")
        self.assert_fails(call("sensors", "echo", "velodyne-vlp16", "--target", "x"), 2, "RANGE")
        self.assert_fails(call("sensors", "echo", "velodyne-vlp16", "--target", "3:laef"), 2, "'leaf'")
        with tempfile.TemporaryDirectory() as folder:
            self.assert_fails(call("sensors", "show", "velodyne-vlp16", "--plot", "p.png", cwd=folder), 2)
            pathlib.Path(folder, "bad.yaml").write_text("name: [\n")
            self.assert_fails(call("sensors", "show", "bad.yaml", "--plot", "p.svg", cwd=folder), 3,
                              "bad.yaml", "line")
            self.assertEqual({p.name for p in pathlib.Path(folder).iterdir()}, {"bad.yaml"})


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("--program", required=True, type=pathlib.Path)
    parser.add_argument("--update", action="store_true")
    options, rest = parser.parse_known_args()
    PROGRAM = str(options.program.resolve())
    if options.update:
        update()
    else:
        unittest.main(argv=[sys.argv[0], *rest])
