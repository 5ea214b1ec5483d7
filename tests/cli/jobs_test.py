#!/usr/bin/env python3
"""Tests of jobs: whatever the number of tasks, their order, repeats and kills, the results have the bytes of one run,
or the failure is named."""
import json
import os
import pathlib
import random
import re
import shutil
import signal
import subprocess
import tempfile
import time

import cli_test

FIELD = "v -50 -50 0\nv 50 -50 0\nv 50 50 0\nv -50 50 0\nv 9 -3 0\nv 9 3 0\nv 9 0 3\nf 1 2 3\nf 1 3 4\nf 5 6 7\n"
POSES = "0 0 0 1.8 0 0 0 1\n0.1 0.5 0 1.8 0 0 0 1\n"
RIG = ("name: rig\nsensors:\n  - {name: a, sensor: velodyne-vlp16, position_m: [1, 0, 0.5]}\n"
       "  - {name: b, sensor: velodyne-hdl32e, position_m: [-1, 0, 0.2]}\n")
SENSED = "simulate field.obj --sensor velodyne-vlp16 --trajectory poses.txt"


SCHEMA = json.loads((pathlib.Path(__file__).parents[2] / "share" / "schemas" / "plan.json").read_text())
TYPES = {"object": dict, "array": list, "string": str, "integer": int, "number": (int, float)}


def faults(value, schema, place="plan"):
    """Where a value is not as a schema says, by the words that the plan's schema uses."""
    if "$ref" in schema:
        schema = {**SCHEMA["$defs"][schema["$ref"].rpartition("/")[2]], **schema}
    unknown = set(schema) - {"$ref", "$schema", "$id", "$defs", "title", "description", "type", "const", "pattern", "minimum",
                             "minItems", "required", "properties", "additionalProperties", "items"}
    if unknown or not isinstance(value, TYPES.get(schema.get("type"), object)):
        return [f"{place}: {sorted(unknown) or 'type'}"]
    out = [place] if value != schema.get("const", value) or ("pattern" in schema and not re.search(schema["pattern"], value)) else []
    if isinstance(value, list):
        out += [place] if len(value) < schema.get("minItems", 0) else []
        return out + [f for k, item in enumerate(value) for f in faults(item, schema["items"], f"{place}[{k}]")]
    if isinstance(value, dict):
        out += [f"{place}.{name} is missing" for name in schema.get("required", []) if name not in value]
        rest = schema.get("additionalProperties", True)
        for name, member in value.items():
            kind = schema.get("properties", {}).get(name, rest)
            out += [f"{place}.{name}"] if kind is False else faults(member, kind, f"{place}.{name}")
    elif not isinstance(value, str) and value < schema.get("minimum", value):
        out.append(place)
    return out


class JobFolder(cli_test.Failing):
    """Each test has a folder with a mesh and poses."""

    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)
        (self.folder / "field.obj").write_text(FIELD)
        (self.folder / "poses.txt").write_text(POSES)

    def call(self, *words):
        return cli_test.call(*words, cwd=self.folder)

    def ok(self, *words):
        done = self.call(*words)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def plan(self, command, name="plan", **keys):
        """Makes a plan, and returns the number of its tasks."""
        (self.folder / "job.yaml").write_text(json.dumps({"command": command, **keys}))
        self.ok("plan", "job.yaml", "-o", name)
        made = json.loads((self.folder / name / "plan.json").read_text())
        self.assertEqual(faults(made, SCHEMA), [])
        return len(made["tasks"])

    def run_tasks(self, tasks, name="plan"):
        for task in tasks:
            self.ok("run", name, "--task", task)

    def bytes_of(self, name):
        return (self.folder / name).read_bytes()

    def record(self, task, name="plan"):
        return self.folder / name / "records" / f"{task}.json"

    def made(self, task):
        return self.folder / "plan" / json.loads(self.record(task).read_text())["outputs"][0]["path"]

    def files_of(self, name):
        """The bytes of all files of a folder."""
        folder = self.folder / name
        return {path.relative_to(folder): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


class Jobs(JobFolder):
    """Plans, their tasks and their results."""

    def test_pieces_have_the_bytes_of_one_run(self):
        self.ok(*SENSED.split(), "--seed", 5, "-o", "seen.ply")
        (self.folder / "rig.yaml").write_text(RIG)
        self.ok(*SENSED.split(), "--seed", 5, "-o", "seen.ublog")
        echoes = "--super-sample 2x2 --returns 2 --rain 20 --material unknown=asphalt --seed 7"
        commands = {f"{SENSED} --range-noise 0.02 --seed 3 -o {{}}.ply": 3, f"{SENSED} {echoes} -o {{}}.ply": 4,
                    f"{SENSED} {echoes} --element-ids -o {{}}.ublog": 2, f"{SENSED} -o {{}}.csv": 2,
                    "simulate field.obj --like seen.ply --beam random --seed 2 -o {}.ply": 5,
                    "simulate field.obj --like seen.ublog --range-noise 0.1 -o {}.pcd": 3,
                    "simulate field.obj --rig rig.yaml --trajectory poses.txt --range-noise 0.1 -o {}.ublog": 5}
        for k, (command, pieces) in enumerate(commands.items()):
            with self.subTest(command):
                self.assertEqual(self.plan(command.format("joined"), f"plan{k}", pieces=pieces), pieces)
                order = random.Random(k).sample(range(pieces), pieces)
                self.run_tasks([*order, order[0]], f"plan{k}")
                self.ok("merge", f"plan{k}")
                self.ok(*command.format("whole").split())
                end = command.rpartition(".")[2]
                self.assertEqual(self.bytes_of(f"joined.{end}"), self.bytes_of(f"whole.{end}"))

    def test_sweeps(self):
        command = f"{SENSED.replace('velodyne-vlp16', '{sensor}')} --seed {{seed}} -o {{sensor}}-{{seed}}.ply"
        sensors = ["velodyne-vlp16", "velodyne-hdl32e"]
        self.assertEqual(self.plan(command, over={"sensor": sensors, "seed": [1, 2]}, pieces=2), 8)
        self.run_tasks(range(8))
        self.ok("merge", "plan")
        for sensor in sensors:
            for seed in (1, 2):
                self.ok(*command.format(sensor=sensor, seed=seed).replace("-o ", "-o one-").split())
                self.assertEqual(self.bytes_of(f"{sensor}-{seed}.ply"), self.bytes_of(f"one-{sensor}-{seed}.ply"))
        self.plan("score velodyne-vlp16-1.ply velodyne-vlp16-{seed}.ply --json {seed}.json --report page{seed}/", "scores",
                  over={"seed": [1, 2]})
        self.run_tasks((1, 0), "scores")
        self.ok("merge", "scores")
        self.ok("score", "velodyne-vlp16-1.ply", "velodyne-vlp16-2.ply", "--json", "one.json")
        self.assertEqual(self.bytes_of("2.json"), self.bytes_of("one.json"))
        self.assertIn(b"<html", self.bytes_of("page2/index.html"))
        self.plan("import velodyne-vlp16-{seed}.ply -o again{seed}.ply", "imports", over={"seed": [1, 2]})
        self.run_tasks((0, 1), "imports")
        self.ok("merge", "imports")
        self.ok("import", "velodyne-vlp16-2.ply", "-o", "one.ply")
        self.assertEqual(self.bytes_of("again2.ply"), self.bytes_of("one.ply"))

    def test_worlds_of_regions(self):
        """A site in parts is composed to a world, through which pieces of a drive go, as in one run."""
        (self.folder / "plant.obj").write_text("v 0 0 0\nv 1 0 0\nv 0.5 0.5 6\nf 1 2 3\n")
        self.ok("meshes", "plant.obj", "-o", "primitives", "--sizes", 1, "--up", "z")
        self.ok("annotate", "--generate", "forest", "--size", 150, 90, "--ground-spacing", 3, "--parts", 40, "-o", "site")
        self.plan("compose site primitives --seed {seed} -o world{seed}", "compositions", over={"seed": [1, 2]})
        self.run_tasks((1, 0), "compositions")
        self.ok("merge", "compositions")
        self.ok("compose", "site", "primitives", "--seed", 2, "-o", "one")
        self.assertEqual(self.bytes_of("world2/index.json").splitlines()[-5:], self.bytes_of("one/index.json").splitlines()[-5:])
        command = "simulate world2 --sensor velodyne-vlp16 --trajectory poses.txt --memory 10MiB -o {}.ply"
        self.plan(command.format("joined"), pieces=3)
        tasks = json.loads((self.folder / "plan/plan.json").read_text())["tasks"]
        self.assertLessEqual(tasks[0]["memory_bytes"], (256 + 10 + 1) << 20)
        self.run_tasks((2, 0, 1))
        self.ok("merge", "plan")
        self.ok(*command.format("whole").split())
        self.assertEqual(self.bytes_of("joined.ply"), self.bytes_of("whole.ply"))
        told = json.loads(self.ok("info", "world2", "--json", "-"))
        self.assertEqual((told["kind"], told["regions"], told["side_m"]), ("scene", 12, 39))
        self.assertEqual(told["bytes"], sum(f.stat().st_size for f in (self.folder / "world2").rglob("*") if f.is_file()))
        self.assertGreater(told["instances"], 100)
        self.assertIn("12 of 39 m", self.ok("info", "world2"))

    def test_fits_in_stages(self):
        """The passes of a fit are summed up by tasks, in any order and some twice; the model is that of one run."""
        self.ok(*SENSED.split(), "--range-noise", 0.02, "--seed", 3, "-o", "seen.ublog")
        command = "fit seen.ublog --rounds 2 --seed 4 -o {}"
        pieces = 3
        self.assertEqual(self.plan(command.format("joined"), pieces=pieces), 1 + 2 * (pieces + 1))
        tasks = json.loads((self.folder / "plan/plan.json").read_text())["tasks"]
        self.assert_fails(self.call("run", "plan", "--task", 2), 3, "task 0", "was not run")
        chance = random.Random(8)
        for stage in range(5):
            numbers = [k for k, task in enumerate(tasks) if task["stage"] == stage]
            chance.shuffle(numbers)
            self.run_tasks([*numbers, numbers[0]])
            again = self.record(numbers[0])
            before = json.loads(again.read_text())["outputs"]
            again.unlink()
            self.ok("run", "plan", "--task", numbers[0], "--threads", 1)
            self.assertEqual(json.loads(again.read_text())["outputs"], before)
        self.ok("merge", "plan")
        self.ok(*command.format("whole").split())
        self.assertEqual(self.files_of("joined"), self.files_of("whole"))
        self.assertGreater(len(self.files_of("whole")), 4)
        other = json.loads(self.record(4).read_text())
        other["earlier"][2] = other["earlier"][3]
        self.record(4).write_text(json.dumps(other))
        self.assert_fails(self.call("merge", "plan"), 3, "task 4", "another output of task 1")

    def test_sums_that_lie(self):
        """Sums of a fit's pass that cannot be are refused by the name of their file, or change nothing that matters."""
        self.ok(*SENSED.split(), "--range-noise", 0.02, "--seed", 3, "-o", "seen.ply")
        fit = ("fit", "seen.ply", "--rounds", 1, "--force", "-o")
        self.ok(*fit, "start", "--stage", "begin")
        self.ok(*fit, "sums.bin", "--stage", "sum:0:20000", "--from", "start")
        sums, refused = self.bytes_of("sums.bin"), 0
        begin = sums.index(b"\n") + 1
        for at in (*range(begin, begin + 80, 16), *range(begin + 4, len(sums) - 8, len(sums) // 20 // 4 * 4)):
            (self.folder / "sums.bin").write_bytes(sums[:at] + b"\xff" * 7 + b"\x7f" + sums[at + 8:])
            done = self.call(*fit, "model", "--stage", "end", "--from", "start", "--from", "start", "--from", "sums.bin")
            refused += done.returncode != 0
            if done.returncode:
                self.assert_fails(done, 3, "sums.bin")
        self.assertGreater(refused, 0)

    def test_settings_of_a_file(self):
        settings = self.ok("dump-config", "simulate").replace("range-noise: 0\n", "range-noise: 0.02\n")
        settings = settings.replace("seed: 1\n", "seed: 9\n").replace("# sensor: ", "sensor: velodyne-vlp16")
        settings = settings.replace("# mover: ", "mover: [field.obj:poses.txt]").replace("rain: 0\n", "rain: 20\n")
        self.ok(*SENSED.split(), "--range-noise", 0.02, "--seed", 3, "-o", "seen.ublog")
        fit = self.ok("dump-config", "fit").replace("\nrounds: 5\n", "\nrounds: 1\n")
        for k, (command, text, tasks, seed) in enumerate((
                ("simulate field.obj --config set.yaml --trajectory poses.txt --rain 0 -o {}.ply", settings, 3, 9),
                ("fit seen.ublog --config=set.yaml --seed 4 -o {}", fit, 5, 4))):
            with self.subTest(command):
                (self.folder / "set.yaml").write_text(text)
                self.assertEqual(self.plan(command.format(f"joined{k}"), f"plan{k}", pieces=3), tasks)
                planned = json.loads((self.folder / f"plan{k}/plan.json").read_text())
                self.assertEqual({task["seed"] for task in planned["tasks"]}, {seed})
                self.assertIn("set.yaml", planned["inputs"])
                self.run_tasks(range(tasks), f"plan{k}")
                self.ok("merge", f"plan{k}")
                self.ok(*command.format(f"whole{k}").split())
        self.assertEqual(self.bytes_of("joined0.ply"), self.bytes_of("whole0.ply"))
        self.assertEqual(self.files_of("joined1"), self.files_of("whole1"))
        (self.folder / "set.yaml").write_text("[a\n")
        self.assert_fails(self.call("plan", "job.yaml", "-o", "bad"), 3, "set.yaml", "line")

    def test_estimates(self):
        """Memory and bytes are estimated within 30 % from small parts of a job; times are on the page of performance."""
        (self.folder / "poses.txt").write_text(POSES.replace("0.1 0.5", "0.4 2"))
        self.ok(*SENSED.split(), "--range-noise", 0.02, "--seed", 3, "-o", "seen.ply")
        jobs = {f"{SENSED} --range-noise 0.02 --seed {{seed}} -o {{seed}}.ply": {"over": {"seed": [1, 2]}, "pieces": 2},
                "fit seen.ply -o model": {}, "import seen.ply -o seen.ublog": {}}
        for k, (command, keys) in enumerate(jobs.items()):
            with self.subTest(command):
                (self.folder / "job.yaml").write_text(json.dumps({"command": command, **keys}))
                told = json.loads(self.ok("plan", "job.yaml", "-o", f"plan{k}", "--estimate", "--json", "-"))
                self.run_tasks(range(told["tasks"]), f"plan{k}")
                status = json.loads(self.ok("plan", "--status", f"plan{k}", "--json", "-"))
                estimate = told["estimate"]
                self.assertEqual(estimate["guessed_tasks"], 0)
                self.assertGreater(estimate["processor_s"], 0)
                self.assertLess(abs(estimate["output_bytes"] / status["output_bytes"] - 1), 0.3)
                self.assertLess(abs(estimate["memory_bytes"] / status["peak_memory_bytes"] - 1), 0.3)
                planned = json.loads((self.folder / f"plan{k}/plan.json").read_text())
                self.assertEqual(faults(planned, SCHEMA), [])
                self.assertEqual(sum(task["output_bytes"] for task in planned["tasks"]), estimate["output_bytes"])
        (self.folder / "job.yaml").write_text("command: regions field.obj -o world\n")
        self.assertIn("1 tasks only guessed", self.ok("plan", "job.yaml", "-o", "guessed", "--estimate"))

    def test_a_task_is_run_once(self):
        self.plan(f"{SENSED} -o sim.ply", pieces=2)
        self.assertIn("task 1 done", self.ok("run", "plan", "--task", 1))
        before = self.record(1).read_bytes()
        self.assertIn("done already", self.ok("run", "plan", "--task", 1))
        self.assertEqual(self.record(1).read_bytes(), before)
        status = json.loads(self.ok("plan", "--status", "plan", "--json", "-"))
        self.assertEqual((status["done"], status["missing"], status["failed"]), ([1], [0], {}))
        self.assertGreater(status["peak_memory_bytes"], 1 << 20)
        self.assert_fails(self.call("merge", "plan"), 3, "task 0", "was not run")
        self.assertFalse((self.folder / "sim.ply").exists())
        with open(self.made(1), "r+b") as file:
            file.truncate(100)
        self.assert_fails(self.call("merge", "plan"), 3, "task 0")
        self.ok("run", "plan", "--task", 0)
        self.assert_fails(self.call("merge", "plan"), 3, "piece.ublog", "was changed")
        self.assertIn("task 1 done", self.ok("run", "plan", "--task", 1))
        self.ok("merge", "plan")
        self.assert_fails(self.call("run", "plan", "--task", 2), 2, "no task")

    def test_kills(self):
        poses = POSES.replace("0.1 0.5", "0.4 2")
        (self.folder / "poses.txt").write_text(poses)
        command = f"{SENSED} --super-sample 3x3 -o {{}}.ply"
        self.plan(command.format("sim"), pieces=2)
        start = time.monotonic()
        self.ok(*command.format("whole").split())
        took = time.monotonic() - start
        chance = random.Random(49)
        for _ in range(6):
            started = subprocess.Popen([cli_test.PROGRAM, "run", "plan", "--task", "0"], cwd=self.folder,
                                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            time.sleep(chance.uniform(0, took / 2))
            started.send_signal(signal.SIGKILL)
            started.wait()
            self.assertIn(self.call("merge", "plan").returncode, (3,))
            self.assertFalse((self.folder / "sim.ply").exists())
        self.run_tasks((1, 0))
        self.ok("merge", "plan")
        self.assertEqual(self.bytes_of("sim.ply"), self.bytes_of("whole.ply"))
        left = {path.name for path in (self.folder / "plan").iterdir()}
        self.assertEqual(left, {"plan.json", "outputs", "records"})

    def test_failures_are_named(self):
        self.ok(*SENSED.split(), "-o", "seen.ply")
        for name in "abc":
            shutil.copy(self.folder / "seen.ply", self.folder / f"{name}.ply")
        self.bytes = self.bytes_of("b.ply")
        (self.folder / "b.ply").write_bytes(self.bytes[:-500])
        self.plan("import {log}.ply -o new/{log}.ply", over={"log": ["a", "b", "c"]})
        self.run_tasks((0, 2))
        for times in (1, 2, 3):
            self.assert_fails(self.call("run", "plan", "--task", 1), 4, "task 1", "b.ply")
            failed = json.loads(self.ok("plan", "--status", "plan", "--json", "-"))["failed"]["1"]
            self.assertEqual((failed["times"], failed["exit_code"]), (times, 3))
            self.assertIn("b.ply", failed["last_lines"])
        self.assert_fails(self.call("merge", "plan"), 3, "task 1", "failed")
        (self.folder / "b.ply").write_bytes(self.bytes)
        self.assert_fails(self.call("run", "plan", "--task", 1), 3, "b.ply", "hash differs")

    def test_records_that_lie(self):
        self.plan(f"{SENSED} --seed 1 -o sim.ply", pieces=2)
        self.plan(f"{SENSED} --seed 2 -o other.ply", "others", pieces=2)
        self.run_tasks((0, 1))
        self.run_tasks((0, 1), "others")
        true = json.loads(self.record(0).read_text())
        other = json.loads(self.record(0, "others").read_text())
        shutil.copytree(self.folder / "others" / "outputs", self.folder / "plan" / "outputs", dirs_exist_ok=True)
        second = json.loads(self.record(1).read_text())
        lies = {"another plan": {**true, "plan": other["plan"]}, "version": {**true, "program": "underbrush 0.0.9"},
                "another command": {**true, "command": second["command"]},
                "inputs": {**true, "inputs": {**true["inputs"], "field.obj": "xxh3:" + "0" * 32}},
                "was changed": {**true, "outputs": [{**true["outputs"][0], "path": other["outputs"][0]["path"]}]},
                "not among": {**true, "outputs": [{**true["outputs"][0], "path": "../sim.ply"}]},
                "'seconds'": {k: v for k, v in true.items() if k != "seconds"}, "missing": {
                    **true, "outputs": [{**true["outputs"][0], "path": "outputs/0-1/piece.ublog"}]}}
        for reason, lie in lies.items():
            with self.subTest(reason):
                self.record(0).write_text(json.dumps(lie))
                self.assert_fails(self.call("merge", "plan"), 3, reason)
                self.assertIn("1 wrong" if reason != "was changed" else "0 wrong", self.ok("plan", "--status", "plan"))
        self.record(0).write_text(json.dumps(true)[:-20])
        self.assert_fails(self.call("merge", "plan"), 3, "0.json")
        self.assertFalse((self.folder / "sim.ply").exists())
        self.ok("run", "plan", "--task", 0)
        self.ok("merge", "plan")

    def test_bad_jobs(self):
        good = {"command": f"{SENSED} -o {{k}}.ply", "over": {"k": [1]}}
        for change, words in (({"command": ""}, ("command", "missing")), ({"colour": 1}, ("colour", "unknown key")),
                              ({"pieces": 0}, ("pieces",)), ({"over": {"k": []}}, ("over",)), ({"over": {}}, ("{k}",)),
                              ({"over": {"k": [1], "j": [1]}}, ("j",)), ({"over": {"k": [1, 1]}}, ("two results",)),
                              ({"command": "info {k}"}, ("not of",)), ({"command": f"{SENSED} --seed {{k}}"}, ("no output",)),
                              ({"command": "score {k}.ply a.ply --json a.json", "pieces": 2}, ("pieces",)),
                              ({"command": "fit {k}.ply -o {k}", "pieces": 2}, ("names its log",)),
                              ({"command": "fit seen.ply --fitter voxel -o {k}", "pieces": 2}, ("likelihood",)),
                              ({"command": "fit seen.ply --echoes all -o {k}", "pieces": 2}, ("all echoes",)),
                              ({"command": "fit seen.ply --rounds 0 -o {k}", "pieces": 2}, ("--rounds",)),
                              ({"command": f"{SENSED} --rig r.yaml -o {{k}}.ply", "pieces": 2}, ("or --rig",)),
                              ({"command": f"{SENSED} --profile ouster -o {{k}}/", "pieces": 2}, ("--profile",)),
                              ({"command": f"{SENSED} -o {{k}}.ply --json a.json", "pieces": 2}, ("one output",))):
            with self.subTest(change):
                (self.folder / "job.yaml").write_text(json.dumps({**good, **change}))
                self.assert_fails(self.call("plan", "job.yaml", "-o", "plan"), 3, "job.yaml", *words)
                self.assertFalse((self.folder / "plan").exists())
        (self.folder / "job.yaml").write_text("command: [a\n")
        self.assert_fails(self.call("plan", "job.yaml", "-o", "plan"), 3, "line")
        for words in (["plan"], ["plan", "job.yaml"], ["plan", "--status", "p", "--make", "p"]):
            self.assert_fails(self.call(*words), 2, "plan")
        self.assert_fails(self.call("plan", "--status", "nowhere"), 3, "nowhere")

    def test_scripts_run(self):
        tasks = self.plan(f"{SENSED} --seed {{seed}} -o {{seed}}.ply", over={"seed": [1, 2]}, pieces=2)
        shutil.copytree(self.folder / "plan", self.folder / "other")
        bin_folder = self.folder / "bin"
        bin_folder.mkdir()
        (bin_folder / "underbrush").symlink_to(pathlib.Path(cli_test.PROGRAM).resolve())
        # As Slurm does it: the job's script comes on standard input, and runs once for each number of the array.
        (bin_folder / "sbatch").write_text(f"""#!/bin/sh
cat > job.sh
case "$*" in
*--array=0-{tasks - 1}*) for k in $(seq 0 {tasks - 1}); do SLURM_ARRAY_TASK_ID=$k sh job.sh >&2; done; echo 17 ;;
*--dependency=afterany:17*) sh job.sh ;;
*) exit 1 ;;
esac
""")
        (bin_folder / "sbatch").chmod(0o755)
        environment = dict(os.environ, PATH=f"{bin_folder}{os.pathsep}{os.environ['PATH']}")
        for name in ("MAKEFLAGS", "MAKELEVEL", "MFLAGS"):
            environment.pop(name, None)
        results = []
        for name, option, command in (("plan", "--slurm", ["sh", "script"]), ("other", "--make", ["make", "-j2", "-f", "script"])):
            (self.folder / "script").write_text(self.ok("plan", option, name))
            done = subprocess.run(command, cwd=self.folder, env=environment, capture_output=True, text=True, check=False)
            self.assertEqual(done.returncode, 0, done.stderr)
            results.append([self.bytes_of(f"{seed}.ply") for seed in (1, 2)])
            for seed in (1, 2):
                (self.folder / f"{seed}.ply").unlink()
        self.ok(*SENSED.split(), "--seed", 2, "-o", "one.ply")
        self.assertEqual(results[0], results[1])
        self.assertEqual(results[0][1], self.bytes_of("one.ply"))


if __name__ == "__main__":
    cli_test.main()
