#!/usr/bin/env python3
"""Tests of shell completion in a real bash, and in zsh and fish where they are installed."""
import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

import cli_test


def bash(folder, *words):
    """Gives what bash offers for the last of `words`."""
    line = " ".join(words)
    script = """
source <("$PROGRAM" completion bash)
COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); COMP_LINE=$LINE; COMP_POINT=${#LINE}
_underbrush
printf '%s\\n' "${COMPREPLY[@]}"
"""
    done = subprocess.run(["bash", "--norc", "-c", script, "bash", *words], cwd=folder, text=True, check=False,
                          capture_output=True, timeout=60,
                          env=dict(os.environ, PROGRAM=str(pathlib.Path(cli_test.PROGRAM).resolve()), LINE=line))
    assert done.returncode == 0 and done.stderr == "", done.stderr
    return [w for w in done.stdout.split("\n") if w]


class Completion(cli_test.Failing):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.addCleanup(self.temporary.cleanup)
        self.folder = pathlib.Path(self.temporary.name)
        (self.folder / "log one.ply").touch()
        (self.folder / "model").mkdir()

    def test_bash_offers_verbs(self):
        offered = bash(self.folder, "underbrush", "")
        self.assertLessEqual(set(cli_test.verbs()), set(offered))
        self.assertEqual(bash(self.folder, "underbrush", "sim"), ["simulate"])

    def test_bash_offers_the_options_of_the_verb(self):
        self.assertEqual(bash(self.folder, "underbrush", "fit", "--fitt"), ["--fitter"])
        self.assertEqual(bash(self.folder, "underbrush", "fit", "log.ply", "--conf"), ["--config"])
        self.assertEqual(bash(self.folder, "underbrush", "score", "--fitt"), [])
        everything = cli_test.call("fit", "--help-all").stdout
        for option in bash(self.folder, "underbrush", "fit", "--"):
            self.assertIn(option, everything)

    def test_bash_offers_the_words_of_a_choice(self):
        self.assertEqual(bash(self.folder, "underbrush", "fit", "--fitter", "su"), ["surface"])
        self.assertEqual(sorted(bash(self.folder, "underbrush", "completion", "")), ["bash", "fish", "zsh"])
        self.assertEqual(bash(self.folder, "underbrush", "fit", "--fitter", "=", "su"), ["surface"])
        self.assertIn("surface", bash(self.folder, "underbrush", "fit", "--fitter", "="))

    def test_bash_offers_the_sensors_of_the_catalogue_and_files(self):
        self.assertEqual(bash(self.folder, "underbrush", "import", "a.bin", "--infer-misses", "velodyne-vlp1"),
                         ["velodyne-vlp16"])
        self.assertEqual(bash(self.folder, "underbrush", "simulate", "--sensor", "lo"), ["log one.ply"])

    def test_bash_offers_files_elsewhere(self):
        self.assertEqual(bash(self.folder, "underbrush", "fit", "lo"), ["log one.ply"])
        self.assertEqual(bash(self.folder, "underbrush", "fit", "a.ply", "-o", "mo"), ["model"])

    def test_zsh_and_fish_read_their_scripts(self):
        for shell in ("zsh", "fish"):
            script = cli_test.call("completion", shell).stdout
            self.assertIn("--fitter" if shell == "zsh" else "-l fitter", script)
            if not shutil.which(shell):
                continue
            done = subprocess.run([shell, "-n"], input=script, text=True, capture_output=True, check=False, timeout=60)
            self.assertEqual((done.returncode, done.stderr), (0, ""), shell)

    def test_another_shell(self):
        self.assert_fails(cli_test.call("completion", "tcsh"), 2, "SHELL")


if __name__ == "__main__":
    cli_test.main()
