#!/usr/bin/env python3
"""Tests of the command line as users see it: help texts against golden files, exit codes, one-line errors.

  cli_test.py --program build/bin/underbrush             runs all checks
  cli_test.py --program build/bin/underbrush --update    rewrites tests/cli/golden from the program
"""
import argparse
import difflib
import functools
import json
import math
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

GOLDEN = pathlib.Path(__file__).parent / "golden"
PROGRAM = None

PROGRESS = r"^\[ *[0-9.]+ s\] .*\n"


def call(*words, cwd=None, program=None, timeout=120):
    """Runs the program; progress ("[1.2 s] ...") goes from `stderr` to `progress`."""
    # The texts must not depend on a terminal's width or language.
    environment = {k: v for k, v in os.environ.items() if k not in ("COLUMNS", "LANG", "LC_ALL")}
    done = subprocess.run([program or PROGRAM, *map(str, words)], cwd=cwd, env=environment, text=True,
                          stdin=subprocess.DEVNULL, capture_output=True, check=False, timeout=timeout)
    done.progress = "".join(re.findall(PROGRESS, done.stderr, re.MULTILINE))
    done.stderr = re.sub(PROGRESS, "", done.stderr, flags=re.MULTILINE)
    return done


def verbs():
    """Lists the verbs in the root's help."""
    return re.findall(r"^  ([a-z][a-z-]*) ", call("--help").stdout, re.MULTILINE)


def help_texts():
    """{golden file: help text} of the root and of each verb, and all options of a verb that hides some."""
    texts = {"underbrush.txt": call("--help").stdout}
    for verb in verbs():
        texts[f"{verb}.txt"] = usual = call(verb, "--help").stdout
        if "more options:" in usual:
            texts[f"{verb}.all.txt"] = call(verb, "--help-all").stdout
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
                                            f"golden/{name}", f"help of {name[:-4]}", lineterm="")
        if changes:
            self.fail("\n".join(changes) + "\nIf that is meant: tests/cli/cli_test.py --update")

    def test_help_fits_on_a_screen(self):
        for name, text in help_texts().items():
            with self.subTest(name):
                prose = text.partition("Example:")[0].splitlines()  # commands are not broken
                self.assertLessEqual(max(map(len, prose)), 80)
                if ".all." not in name:
                    self.assertLessEqual(len(text.splitlines()), 66 if name == "underbrush.txt" else 48)
        self.assertLessEqual(len(call("fit", "--help").stdout.splitlines()), 40)

    def test_all_options_are_in_the_help_of_all(self):
        for verb in verbs():
            with self.subTest(verb):
                usual, everything = (set(re.findall(r"^  (?:-\w, )?(--[a-z-]+)", call(verb, h).stdout, re.MULTILINE))
                                     for h in ("--help", "--help-all"))
                self.assertLessEqual(usual, everything)
                hidden = re.search(r"^(\d+) more options", call(verb, "--help").stdout, re.MULTILINE)
                self.assertEqual(len(everything - usual), int(hidden.group(1)) if hidden else 0)

    def test_the_root_groups_its_verbs_by_stage(self):
        stages = re.findall(r"^(\w+):$", call("--help").stdout, re.MULTILINE)
        self.assertEqual(stages, ["Options", "Start", "Logs", "Models", "Scenes", "Simulation", "Jobs", "Help"])

    def test_the_help_of_all_of_the_root_has_the_usage_of_each_verb(self):
        usages = re.findall(r"^Usage: underbrush ([a-z-]+)", call("--help-all").stdout, re.MULTILINE)
        self.assertEqual(usages, verbs())

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
        """A failure gives one line on standard error, nothing on standard output, and its exit code."""
        where = " ".join(map(str, done.args[1:]))
        self.assertEqual(done.returncode, code, f"{where}\n{done.stderr}")
        self.assertRegex(done.stderr, r"\Aunderbrush(-study)?: [^\n]+\n\Z", where)
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
                if not re.search(rf"Usage: underbrush {verb} \[", call(verb, "--help").stdout):
                    self.assert_fails(call(verb), 2)

    def test_of_the_common_options(self):
        for verb in verbs():
            if "--threads" in call(verb, "--help").stdout:
                with self.subTest(verb):
                    self.assert_fails(call(verb, "--threads", "-1"), 2)
                    self.assert_fails(call(verb, "--seed", "many"), 2)


# Arguments of each verb, in which BAD stands for the bad input. No file may be at `out` afterwards.
READERS = {
    "import": ["BAD", "-o", "out"],
    "info": ["BAD"],
    "serve": ["BAD", "--cache", "out"],
    "live": ["BAD", "--sensor", "velodyne-vlp16"],
    "split": ["BAD", "--every", "2", "--train", "out", "--test", "out-too"],
    "actors": ["BAD", "-o", "out"],
    "fit": ["BAD", "-o", "out"],
    "optimize": ["BAD", "-o", "out"],
    "simulate": ["BAD", "--like", "BAD", "-o", "out"],
    "rasters": ["BAD", "-o", "out"],
    "perceive": ["BAD", "--pipeline", "real", "-o", "out.csv"],
    "osi": ["info", "BAD"],
    "score": ["BAD", "BAD"],
    "segment": ["BAD", "-o", "out"],
    "extract": ["BAD", "BAD", "-o", "out"],
    "annotate": ["BAD", "-o", "out"],
    "primitives": ["list", "BAD"],
    "compose": ["BAD", "BAD", "-o", "out"],
    "regions": ["BAD", "-o", "out"],
    "plan": ["BAD", "-o", "out"],
    "run": ["BAD", "--task", "0"],
    "merge": ["BAD"],
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


def write_log(folder, scans=2):
    """A small log `log.ply` in the folder: a turning sensor over flat ground with a few posts."""
    rows = ["x,y,z,time,ox,oy,oz,hit,scan,ring,packet"]
    for k in range(400 * scans):
        scan, beam = divmod(k, 400)
        azimuth, ring = 2 * math.pi * (beam // 8) / 50, beam % 8
        slope = 0.3 - 0.05 * ring  # all but the last rings point downwards
        post = beam // 8 % 10 == 3
        far = 6.6 if post else 2 / slope if slope > 0.05 else 30
        x, y = far * math.cos(azimuth), far * math.sin(azimuth)
        rows.append(f"{x + scan:.4f},{y:.4f},{2 - slope * far:.4f},{0.1 * scan + 1e-3 * (beam // 8):.4f},"
                    f"{scan},0,2,{int(post or slope > 0.05)},{scan},{ring},{beam // 8}")
    pathlib.Path(folder, "log.csv").write_text("\n".join(rows) + "\n")
    pathlib.Path(folder, "tree.obj").write_text("v 0 0 0\nv 2 0 0\nv 0 1 0\nv 0 0 4\nf 1 2 4\nf 2 3 4\n")
    pathlib.Path(folder, "posts.csv").write_text("time,id,class,x,y,z,yaw,length,width,height\n" + "".join(
        f"{0.1 * scan:.1f},1,other,{6.137 + scan},2.43,1.2,0,1,1,2.6\n" for scan in range(scans)))
    done = call("import", "log.csv", "-o", "log.ply", cwd=folder)
    assert done.returncode == 0, done.stderr


# Commands on that log, in an order in which all inputs exist. -o names the output.
JOBS = {
    "import": ["log.csv", "-o", "again.ply"],
    "split": ["log.ply", "--every", "2", "--train", "train.ply", "--test", "test.ply"],
    "movers": ["log.ply", "-o", "marked.ply"],
    "actors": ["log.ply", "--boxes", "posts.csv", "-o", "actors", "--least-returns", "10"],
    "info": ["log.ply"],
    "segment": ["log.ply", "-o", "labelled.ply", "--min-points", "5"],
    "fit": ["log.ply", "-o", "model", "--min-points", "4"],
    "optimize": ["log.ply", "-o", "params.yaml", "--budget", "2"],
    "rasters": ["model", "-o", "maps"],
    "extract": ["model", "labelled.ply", "-o", "primitives"],
    "meshes": ["tree.obj", "-o", "meshes"],
    "annotate": ["labelled.ply", "-o", "site.json"],
    "compose": ["site.json", "primitives", "-o", "scene"],
    "regions": ["scene", "-o", "world"],
    "simulate": ["model", "--like", "log.ply", "-o", "sim.ply"],
    "perceive": ["log.ply", "--pipeline", "real", "-o", "objects.csv"],
    "osi": ["record", "log.ply", "-o", "views.osi"],
    "score": ["log.ply", "sim.ply", "--model", "model", "--report", "report"],
}


def run_jobs(folder, until=None):
    for verb, words in JOBS.items():
        if verb == until:
            return
        done = call(verb, *words, cwd=folder)
        assert done.returncode == 0, done.stderr


@functools.cache
def after_all_jobs():
    folder = tempfile.TemporaryDirectory()
    write_log(pathlib.Path(folder.name))
    run_jobs(folder.name)
    return folder


class OnALog(Failing):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.temporary.name)
        write_log(self.folder)

    def tearDown(self):
        self.temporary.cleanup()

    def run_all(self, until=None):
        """Every job in its order, up to one; all of them are run once, and copied."""
        if until is None:
            shutil.copytree(after_all_jobs().name, self.folder, dirs_exist_ok=True)
        else:
            run_jobs(self.folder, until)

    def left(self):
        return {str(p.relative_to(self.folder)) for p in self.folder.rglob("*")}


class CompactLogs(OnALog):
    def test_every_verb_reads_writes_and_replaces_them(self):
        self.run_all()
        ellipsoids = pathlib.Path(self.folder, "model/ellipsoids.ply").read_bytes()
        for verb, words in [("import", ["log.ply", "-o", "log.ply"]), *JOBS.items()] * 2:
            done = call(verb, words[0] if verb == "import" else words[0].replace(".ply", ".ublog"),
                        *[word.replace(".ply", ".ublog") for word in words[1:]], cwd=self.folder)
            self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(pathlib.Path(self.folder, "model/ellipsoids.ply").read_bytes(), ellipsoids)
        for name in ("log", "sim", "labelled", "marked"):
            told = [json.loads(call("info", name + ending, "--json", "-", cwd=self.folder).stdout)
                    for ending in (".ply", ".ublog")]
            for fact in ("beams", "hits", "misses", "scans"):
                self.assertEqual(told[0][fact], told[1][fact], name)

    def test_a_damaged_one_gives_one_line(self):
        call("import", "log.ply", "-o", "log.ublog", cwd=self.folder)
        whole = pathlib.Path(self.folder, "log.ublog").read_bytes()
        for name, content in (("flipped.ublog", whole[:200] + bytes([whole[200] ^ 1]) + whole[201:]),
                              ("cut.ublog", whole[:-100])):
            pathlib.Path(self.folder, name).write_bytes(content)
            for verb in ("info", "fit", "import"):
                words = [name] if verb == "info" else [name, "-o", "out"]
                self.assert_fails(call(verb, *words, cwd=self.folder), 3, name)


class Configuration(OnALog):
    def test_every_verb_has_a_job_here(self):
        self.assertEqual(set(verbs()) - set(JOBS), {"demo", "serve", "live", "dump-config", "sensors", "completion", "plan", "run", "merge", "primitives"})

    def test_of_the_defaults_changes_nothing(self):
        for verb, words in JOBS.items():
            with self.subTest(verb):
                plain = call(verb, *words, cwd=self.folder)
                before = {p: p.read_bytes() for p in self.folder.rglob("*.ply")}
                pathlib.Path(self.folder, "c.yaml").write_text(call("dump-config", verb).stdout)
                again = call(verb, *words, "--config", "c.yaml", cwd=self.folder)
                self.assertEqual((again.returncode, again.stderr), (0, ""))
                timeless = [re.sub(r"[0-9.]+ (s\b|k? ?beams/s)|[0-9.]+ [kM] beams/s", "", t.stdout)
                            for t in (plain, again)]
                self.assertEqual(*timeless)
                for path, content in before.items():  # only the file's name in the provenance differs
                    tail = len(content) // 2
                    self.assertEqual(path.read_bytes()[-tail:], content[-tail:], path)

    def test_holds_unless_an_option_overrides_it(self):
        config = pathlib.Path(self.folder, "c.yaml")
        config.write_text("tau: 2\n")
        for words, tau in (([], 2), (["--tau", "1.5"], 1.5), (["--tau=1"], 1)):
            call("fit", "log.ply", "-o", "model", "--config", "c.yaml", *words, cwd=self.folder)
            self.assertEqual(json.loads(pathlib.Path(self.folder, "model/model.json").read_text())["tau"], tau)

    def test_is_an_input_in_the_provenance(self):
        config, hashes = pathlib.Path(self.folder, "c.yaml"), []
        for text in ("tau: 2\n", "tau: 2.5\n"):
            config.write_text(text)
            call("fit", "log.ply", "-o", "model", "--config", "c.yaml", cwd=self.folder)
            manifest = json.loads(pathlib.Path(self.folder, "model/model.json").read_text())
            hashes.append(manifest["provenance"]["inputs"]["c.yaml"])
        self.assertNotEqual(*hashes)

    def test_that_is_wrong(self):
        for text in ("no-such-option: 1\n", "tau: [\n", "- tau\n", "tau:\n  a: 1\n"):
            with self.subTest(text):
                pathlib.Path(self.folder, "c.yaml").write_text(text)
                self.assert_fails(call("fit", "log.ply", "-o", "model", "--config", "c.yaml", cwd=self.folder),
                                  3, "c.yaml")
        self.assert_fails(call("fit", "log.ply", "-o", "model", "--config", "none.yaml", cwd=self.folder),
                          3, "none.yaml")
        pathlib.Path(self.folder, "c.yaml").write_text("tau: much\n")
        self.assert_fails(call("fit", "log.ply", "-o", "model", "--config", "c.yaml", cwd=self.folder), 2, "tau")


def main():
    """Runs the tests of the calling file on the binary that `--program` names."""
    global PROGRAM
    parser = argparse.ArgumentParser()
    parser.add_argument("--program", required=True, type=pathlib.Path)
    parser.add_argument("--update", action="store_true")
    options, rest = parser.parse_known_args()
    PROGRAM = str(options.program.resolve())
    if options.update:
        update()
    else:
        unittest.main(argv=[sys.argv[0], *rest])


if __name__ == "__main__":
    main()
