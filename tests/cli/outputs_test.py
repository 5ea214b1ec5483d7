#!/usr/bin/env python3
"""Tests of runs that cannot write or are interrupted: they give one line and the right exit code, and neither leave
nor lose a file."""
import os
import pathlib
import resource
import signal
import subprocess
import tempfile
import time

import cli_test


class Outputs(cli_test.OnALog):
    """An output that cannot be written gives exit 4 and one line at once, and no file is left or lost."""
    def writers(self):
        for verb, words in cli_test.JOBS.items():
            for option in ("-o", "--train", "--test", "--report"):
                if option in words:
                    yield verb, words, words.index(option) + 1

    def check(self, where, code=4):
        for verb, words, at in self.writers():
            with self.subTest(verb=verb, out=where):
                words = [*words[:at], where, *words[at + 1:]]
                before = self.left()
                self.assert_fails(cli_test.call(verb, *words, cwd=self.folder), code, where.split("/")[0])
                self.assertEqual(self.left(), before)

    def test_in_no_folder(self):
        self.run_all()
        pathlib.Path(self.folder, "file").write_text("")
        self.check("file/log.ply")
        self.check("file/model/log.ply")

    def test_devices_and_pipes_are_not_replaced(self):
        self.run_all()
        pipe = pathlib.Path(self.folder, "pipe")
        os.mkfifo(pipe)
        for verb, words, at in self.writers():
            with self.subTest(verb):
                done = cli_test.call(verb, *words[:at], "pipe", *words[at + 1:], cwd=self.folder)
                self.assert_fails(done, 4, "pipe")
        self.assertTrue(pipe.is_fifo())

    def test_other_peoples_folders_stay(self):
        self.run_all()
        mine = pathlib.Path(self.folder, "mine")
        mine.mkdir()
        (mine / "thesis.tex").write_text("years")
        for verb, words, at in self.writers():
            if words[at - 1] == "-o":
                with self.subTest(verb):
                    done = cli_test.call(verb, *words[:at], "mine", *words[at + 1:], cwd=self.folder)
                    self.assert_fails(done, 4, "mine")
        self.assertEqual((mine / "thesis.tex").read_text(), "years")

    def test_a_full_standard_output(self):
        self.run_all()
        with open("/dev/full", "w") as full:
            for verb, words in cli_test.JOBS.items():
                with self.subTest(verb):
                    done = subprocess.run([cli_test.PROGRAM, verb, *words], cwd=self.folder, stdout=full, text=True,
                                          stderr=subprocess.PIPE, timeout=60, check=False)
                    self.assertEqual((done.returncode, done.stderr),
                                     (4, "underbrush: standard output: cannot write\n"))
        for verb, words in cli_test.JOBS.items():
            self.assert_full_json(verb, words)

    def assert_full_json(self, verb, words):
        done = cli_test.call(verb, *words, "--json", "/dev/full", cwd=self.folder)
        self.assertEqual((done.returncode, done.stderr), (4, "underbrush: /dev/full: cannot write\n"))

    def test_a_full_disk(self):
        self.run_all()
        for limit in (8, 40):  # KiB
            self.check_full_disk(limit)

    def check_full_disk(self, limit):
        for verb, words, at in self.writers():
            with self.subTest(verb=verb, limit=limit):
                target = "new.ply" if words[at].endswith(".ply") else "new"
                if verb == "import":
                    words = ["log.ply", *words[1:]]
                words = [*words[:at], target, *words[at + 1:]]
                before = self.left()
                # The system reports a file beyond the size limit as it reports a full disk.
                done = subprocess.run(
                    [cli_test.PROGRAM, verb, *words], cwd=self.folder, text=True, capture_output=True, timeout=60,
                    check=False, preexec_fn=lambda: (
                        signal.signal(signal.SIGXFSZ, signal.SIG_IGN),
                        resource.setrlimit(resource.RLIMIT_FSIZE, (limit << 10, limit << 10))))
                if done.returncode == 0:
                    continue  # its outputs are smaller than the limit
                self.assert_fails(done, 4, "cannot write")
                allowed = before | {"new"} if verb == "score" else before
                self.assertLessEqual(self.left(), allowed)


class Interrupted(cli_test.OnALog):
    def test_leaves_nothing_and_says_so_in_one_line(self):
        self.run_all()
        interrupted = set()
        for verb in ("import", "split", "segment", "fit", "extract", "annotate", "compose",
                     "simulate", "score"):
            for wait in (0.002, 0.004, 0.008, 0.016, 0.03, 0.06, 0.12):
                with self.subTest(verb=verb, wait=wait), tempfile.TemporaryDirectory() as scratch:
                    before = self.left()
                    environment = dict(os.environ, TMPDIR=scratch)
                    process = subprocess.Popen([cli_test.PROGRAM, verb, *cli_test.JOBS[verb]], cwd=self.folder,
                                               env=environment, text=True, stdout=subprocess.PIPE,
                                               stderr=subprocess.PIPE)
                    time.sleep(wait)
                    process.send_signal(signal.SIGINT)
                    _, errors = process.communicate(timeout=60)
                    self.assertEqual(self.left(), before)
                    self.assertEqual(os.listdir(scratch), [])
                    if process.returncode == -signal.SIGINT:  # 130 to a shell
                        # The system ends a process without a line before main has begun.
                        self.assertIn(errors, ("", "underbrush: interrupted\n"))
                        interrupted |= {verb} if errors else set()
                    else:
                        self.assertEqual((process.returncode, errors), (0, ""))
        self.assertTrue(interrupted, "no run was interrupted in its work")

    def test_in_the_middle_of_the_demo(self):
        with tempfile.TemporaryDirectory() as scratch:
            process = subprocess.Popen([cli_test.PROGRAM, "demo", "-o", "demo"], cwd=scratch, text=True,
                                       stdout=subprocess.PIPE, stderr=subprocess.PIPE)
            for _ in range(600):  # until it writes its first log
                if list(pathlib.Path(scratch).glob("demo/*.part-*")):
                    break
                time.sleep(0.05)
            else:
                self.fail("the demo writes nothing")
            process.send_signal(signal.SIGINT)
            _, errors = process.communicate(timeout=60)
            *progress, last = errors.splitlines()
            self.assertEqual((process.returncode, last), (-signal.SIGINT, "underbrush: interrupted"))
            self.assertTrue(all(line.startswith("[") for line in progress), errors)
            self.assertEqual(os.listdir(pathlib.Path(scratch, "demo")), [])


if __name__ == "__main__":
    cli_test.main()
