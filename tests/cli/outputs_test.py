#!/usr/bin/env python3
"""Tests of runs that cannot write or are interrupted: they give one line and the right exit code, and neither leave
nor lose a file."""
import itertools
import os
import pathlib
import resource
import shutil
import signal
import subprocess
import tempfile
import time

import cli_test

SENSOR = pathlib.Path(__file__).resolve().parents[2] / "share/sensors/velodyne-vlp16.yaml"


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

    def test_pipes_are_no_inputs(self):
        self.run_all()
        os.mkfifo(self.folder / "pipe")
        for verb, words in cli_test.JOBS.items():
            for at, word in enumerate(words):
                if (self.folder / word).is_file() and not words[at - 1].startswith("-"):
                    with self.subTest(verb=verb, input=word):
                        done = cli_test.call(verb, *words[:at], "pipe", *words[at + 1:], cwd=self.folder)
                        self.assert_fails(done, 3, "pipe")

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
                    last = done.stderr.splitlines()[-1]
                    self.assertEqual(done.returncode, 4)
                    self.assertRegex(last, "^underbrush: standard output: cannot write")
        for verb, words in cli_test.JOBS.items():
            self.assert_full_json(verb, words)

    def assert_full_json(self, verb, words):
        """The line names the outputs that are written, which are whole."""
        done = cli_test.call(verb, *words, "--json", "/dev/full", cwd=self.folder)
        written = words[words.index("-o") + 1] if "-o" in words else "cannot write"
        self.assertEqual((done.returncode, done.stderr.count("\n")), (4, 1), done.stderr)
        self.assertRegex(done.stderr, "^underbrush: /dev/full: cannot write")
        self.assertIn(written, done.stderr)
        self.assertEqual("; whole are: " in done.stderr, verb != "info")

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
                self.assertLessEqual(self.left(), before)


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
                if list(pathlib.Path(scratch).glob("demo/.underbrush-*")):
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


class Distinct(cli_test.OnALog):
    """Outputs differ from each other and from the inputs, and what others wrote is not replaced."""
    NO_WRITERS = {"demo", "info", "serve", "live", "dump-config", "completion", "run", "merge"}
    #: Commands beside those of `cli_test.JOBS` or in their place.
    COMMANDS = {
        "sensors": ["echo", "own.yaml", "--target", "9"],
        "simulate": ["model", "--like", "log.ply", "--sensor", "own.yaml", "--super-sample", "2x2", "-o", "sim.ply"],
        "perceive": ["log.ply", "--pipeline", "real", "--truth", "posts.csv", "--sensor-height", "2", "-o", "objects.csv"],
        "primitives": ["merge", "primitives", "-o", "library"],
        "plan": ["job.yaml", "-o", "plan"],
    }
    NEEDED = ("-o", "--train", "--test")
    #: The other outputs, and names of theirs.
    MORE_OUTPUTS = {
        "movers": {"--only": "only.ply"},
        "actors": {"--marked": "marked.ply", "--met": "met.ply"},
        "fit": {"--export-splat": "splat.ply", "--export-ground": "ground.ply"},
        "optimize": {"--checkpoint": "state.json", "--report": "report"},
        "sensors": {"--csv": "echo.csv", "--plot": "echo.svg"},
        "simulate": {"--waveforms": "all.waves"},
        "perceive": {"--write-truth": "truth.csv", "--grid": "grid.json", "--report": "report"},
        "score": {"--report": "report"},
    }

    def setUp(self):
        super().setUp()
        self.run_all()
        self.known = None  # The contents after the last command that was refused.
        shutil.copy(SENSOR, self.folder / "own.yaml")
        (self.folder / "job.yaml").write_text("command: simulate model --like log.ply -o planned.ply\n")
        os.symlink("log.ply", self.folder / "link.ply")
        os.link(self.folder / "log.ply", self.folder / "hard.ply")

    def commands(self):
        """The words of each command that writes, without its outputs, and {option of an output: its name}."""
        for verb, words in {**cli_test.JOBS, **self.COMMANDS}.items():
            outputs = {option: words[words.index(option) + 1] for option in self.NEEDED if option in words}
            outputs.update(self.MORE_OUTPUTS.get(verb, {}))
            places = {*outputs, *outputs.values()}
            yield [verb, *(word for word in words if word not in places)], {**outputs, "--json": "result.json"}

    def with_outputs(self, words, outputs, named):
        """The words of a command with the outputs that it needs, and with those that are named."""
        needed = {option: name for option, name in outputs.items() if option in self.NEEDED}
        return [*words, *(word for pair in {**needed, **named}.items() for word in pair)]

    def assert_refused(self, *words, reason=""):
        with self.subTest(" ".join(words)):
            before = self.known or self.contents()
            self.assert_fails(cli_test.call(*words, cwd=self.folder), 2, reason)
            self.known = self.contents()
            self.assertEqual(self.known, before)

    def test_of_every_verb_that_writes(self):
        self.assertEqual({words[0] for words, _ in self.commands()} | self.NO_WRITERS, set(cli_test.verbs()))

    def test_from_inputs(self):
        for words, outputs in self.commands():
            inputs = [word for word in words[1:] if (self.folder / word).exists()]
            for option, place in itertools.product(outputs, inputs):
                for name in (place, f"maps/../{place}", *(("link.ply", "hard.ply") if place == "log.ply" else ())):
                    self.assert_refused(*self.with_outputs(words, outputs, {option: name}), reason="would replace the input")

    def test_from_each_other(self):
        for words, outputs in self.commands():
            for one, other in itertools.combinations(outputs, 2):
                for name in ("twice", "maps/../twice"):
                    self.assert_refused(*self.with_outputs(words, outputs, {one: "twice", other: name}),
                                        reason="name the same place")

    def test_from_what_no_option_names(self):
        fit, site = ["fit", "hard.ply", "-o", "model"], ["annotate", "--ground-spacing", "2", "-o"]
        self.assertEqual(cli_test.call(*site, "site.json", "--generate", "forest", cwd=self.folder).returncode, 0)
        for words in (
                [*fit, "--json", "model/ground.ply"],
                [*fit, "--export-splat", "model/model.json"],
                ["fit", "log.ply", "-o", "-"],
                ["simulate", "model", "--like", "log.ply", "-o", "model/ground.ply"],
                ["optimize", "log.ply", "-o", "c.yaml", "--json", "c.yaml.checkpoint"],
                [*site, "site.new", "--generate", "--like", "site.json"],  # site.ground is the ground of both
        ):
            self.assert_refused(*words)

    def test_a_model_that_holds_the_log_is_not_replaced(self):
        os.rename(self.folder / "log.ply", self.folder / "model/log.ply")
        self.assert_refused("fit", "model/log.ply", "-o", "model", reason="model/log.ply")

    def test_what_a_run_wrote_is_replaced_by_the_next_one(self):
        for words, outputs in self.commands():
            for _ in range(1 if words[0] == "plan" else 2):  # A plan is kept, as what its tasks made.
                with self.subTest(words[0]):
                    done = cli_test.call(*self.with_outputs(words, outputs, outputs), cwd=self.folder)
                    self.assertEqual(done.returncode, 0, done.stderr)

    def test_files_of_others_stay_unless_forced(self):
        (self.folder / "mine").mkdir()
        for words, outputs in self.commands():
            for option, name in outputs.items():
                mine = self.folder / "mine" / ("index.html" if option == "--report" else name)
                named = self.with_outputs(words, outputs, {option: "mine" if option == "--report" else f"mine/{name}"})
                with self.subTest(" ".join(named)):
                    mine.write_text("years")
                    self.assert_fails(cli_test.call(*named, cwd=self.folder), 4, "--force")
                    self.assertEqual(mine.read_text(), "years")
                    done = cli_test.call(*named, "--force", cwd=self.folder)
                    folder = option == "-o" and "." not in name
                    # A checkpoint is read before it is written, and nothing moves in this log.
                    self.assertEqual(done.returncode, 4 if folder else 3 if option == "--checkpoint" else 0, done.stderr)
                    kept = folder or option in ("--checkpoint", "--only")
                    self.assertEqual(mine.read_bytes() == b"years", kept)

    def contents(self):
        paths = (os.path.join(folder, name) for folder, _, names in os.walk(self.folder) for name in names)
        return {path: pathlib.Path(path).read_bytes() for path in paths if os.path.isfile(path)}


if __name__ == "__main__":
    cli_test.main()
