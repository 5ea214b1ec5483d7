#!/usr/bin/env python3
"""Tests of what happens to a job on bad days: workers that are killed, a full disk, too little memory, a truncated input,
records that lie. The result is that of one run, or the failure is named; nothing half-written is merged.

  faults_test.py --program build/bin/underbrush --kills 100     kills at so many moments of each kind of job
"""
import argparse
import json
import random
import resource
import shutil
import signal
import subprocess
import sys
import time

import cli_test
import jobs_test

KILLS = 4  # moments at which a worker is killed, of each kind of job
FIT, COMPOSE, SIMULATE = ("fit seen.ublog --rounds 1 --seed 4 -o {}", "compose site primitives --seed {{seed}} -o {}",
                          "simulate world --sensor velodyne-vlp16 --trajectory poses.txt --memory 10MiB -o {}.ply")


class Faults(jobs_test.JobFolder):
    """Jobs whose tasks meet faults."""

    @classmethod
    def setUpClass(cls):
        cls.random = random.Random(52)

    def make_world(self):
        (self.folder / "plant.obj").write_text("v 0 0 0\nv 1 0 0\nv 0.5 0.5 6\nf 1 2 3\n")
        self.ok("meshes", "plant.obj", "-o", "primitives", "--sizes", 1, "--up", "z")
        self.ok("annotate", "--generate", "forest", "--size", 150, 90, "--ground-spacing", 3, "--parts", 40, "-o", "site")
        self.ok(*COMPOSE.format("world").format(seed=1).split())

    def start(self, *words, **keys):
        return subprocess.Popen([cli_test.PROGRAM, *map(str, words)], cwd=self.folder, stdout=subprocess.DEVNULL,
                                stderr=subprocess.DEVNULL, **keys)

    def missing(self):
        status = json.loads(self.ok("plan", "--status", "plan", "--json", "-"))
        self.assertEqual(status["wrong"], {})
        return status["missing"] + [int(task) for task in status["failed"]]

    def run_with_kills(self, results):
        """Runs all tasks of `plan`, some at once, and kills at random moments until enough have been killed."""
        tasks = json.loads((self.folder / "plan/plan.json").read_text())["tasks"]
        killed = 0
        while (missing := self.missing()) or killed < KILLS:
            if not missing:  # A task whose record is lost is run again.
                self.record(self.random.randrange(len(tasks))).unlink()
                continue
            stage = min(tasks[k]["stage"] for k in missing)
            ready = [k for k in missing if tasks[k]["stage"] == stage]
            begin = time.monotonic()
            if killed >= KILLS:
                self.ok("run", "plan", "--task", ready[0])
                continue
            # Two workers run the same task at once; the moment is any up to twice the time that a task takes.
            workers = [self.start("run", "plan", "--task", self.random.choice(ready[:1])) for _ in range(2)]
            time.sleep(self.random.uniform(0, self.took * 2))
            for worker in workers[:self.random.choice((1, 2))]:
                killed += worker.poll() is None
                worker.send_signal(signal.SIGKILL)
            for worker in workers:
                worker.wait()
            self.took = max(self.took, (time.monotonic() - begin) / 8)
            if self.missing():
                self.assertEqual(self.call("merge", "plan").returncode, 3)
                for result in results:
                    self.assertFalse((self.folder / result).exists())
        # A scheduler that dies while it merges leaves no half of a result.
        for _ in range(KILLS):
            merging = self.start("merge", "plan")
            time.sleep(self.random.uniform(0, 0.05))
            merging.send_signal(signal.SIGKILL)
            merging.wait()
        self.ok("merge", "plan")
        left = {path.name for path in (self.folder / "plan").iterdir()}
        self.assertEqual(left, {"plan.json", "outputs", "records"})

    def assert_same(self, a, b):
        if (self.folder / a).is_dir():
            self.assertEqual(self.files_of(a), self.files_of(b))
        else:
            self.assertEqual(self.bytes_of(a), self.bytes_of(b))

    def test_kills(self):
        self.make_world()
        self.ok(*jobs_test.SENSED.split(), "--range-noise", 0.02, "-o", "seen.ublog")
        for command, over, pieces in ((SIMULATE, {}, 2), (FIT, {}, 2), (COMPOSE.replace("{}", "{}{{seed}}"), {"seed": [2, 3]}, 1)):
            with self.subTest(command):
                shutil.rmtree(self.folder / "plan", ignore_errors=True)
                tasks = self.plan(command.format("joined"), over=over, pieces=pieces)
                begin = time.monotonic()
                for values in [{"seed": seed} for seed in over.get("seed", [0])]:
                    self.ok(*command.format("whole").format(**values).split())
                self.took = (time.monotonic() - begin) / tasks
                results = [result["path"] for result in json.loads(self.bytes_of("plan/plan.json"))["results"]]
                self.run_with_kills(results)
                for result in results:
                    self.assert_same(result, result.replace("joined", "whole"))

    def test_a_truncated_input_among_64(self):
        self.ok(*jobs_test.SENSED.split(), "--beams", "0:2000", "-o", "seen.ply")
        for k in range(64):
            shutil.copy(self.folder / "seen.ply", self.folder / f"{k}.ply")
        (self.folder / "17.ply").write_bytes(self.bytes_of("seen.ply")[:9999])
        self.plan("import {log}.ply -o new/{log}.ublog", over={"log": list(range(64))})
        status = json.loads(self.ok("plan", "--status", "plan", "--json", "-"))
        self.assertEqual(len(status["missing"]), 64)
        for task in range(64):
            self.assertEqual(self.call("run", "plan", "--task", task).returncode, 4 if task == 17 else 0)
        status = json.loads(self.ok("plan", "--status", "plan", "--json", "-"))
        self.assertEqual((len(status["done"]), list(status["failed"])), (63, ["17"]))
        self.assertIn("17.ply", status["failed"]["17"]["last_lines"])
        self.assert_fails(self.call("merge", "plan"), 3, "task 17", "failed")
        self.assertFalse((self.folder / "new").exists())

    def test_a_full_disk(self):
        """The plan lies on a disk that is full, and then on one that is large enough; so does the result."""
        small = self.folder / "small"
        small.mkdir()
        if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=12k", "none", small], capture_output=True, check=False).returncode:
            self.skipTest("no tmpfs can be mounted here")
        self.addCleanup(subprocess.run, ["umount", small], check=True)
        self.plan(f"{jobs_test.SENSED} -o small/sim.ply", name="small/plan", pieces=2)
        self.assert_fails(self.call("run", "small/plan", "--task", 0), 4, "small/plan")
        self.assert_fails(self.call("merge", "small/plan"), 3, "task 0")
        for size in ("200k", "20m"):
            subprocess.run(["mount", "-o", f"remount,size={size}", small], check=True)
            self.run_tasks((0, 1), "small/plan")
            if size == "200k":
                self.assert_fails(self.call("merge", "small/plan"), 4, "small")
                self.assertEqual([path.name for path in small.iterdir()], ["plan"])
        self.ok("merge", "small/plan")
        self.ok(*jobs_test.SENSED.split(), "-o", "one.ply")
        self.assert_same("small/sim.ply", "one.ply")

    def test_too_little_memory(self):
        self.plan(f"{jobs_test.SENSED} -o sim.ply", pieces=2)

        def limit():
            resource.setrlimit(resource.RLIMIT_AS, (40 << 20, 40 << 20))

        starved = subprocess.run([cli_test.PROGRAM, "run", "plan", "--task", "0", "--threads", "1"], cwd=self.folder,
                                 preexec_fn=limit, capture_output=True, text=True, check=False)
        self.assertNotEqual(starved.returncode, 0, starved.stdout)
        self.assertTrue(starved.stderr.strip())
        self.assert_fails(self.call("merge", "plan"), 3, "task 0")
        self.run_tasks((0, 1))
        self.ok("merge", "plan")
        self.ok(*jobs_test.SENSED.split(), "-o", "one.ply")
        self.assertEqual(self.bytes_of("sim.ply"), self.bytes_of("one.ply"))


def main():
    global KILLS
    parser = argparse.ArgumentParser(add_help=False)
    parser.add_argument("--kills", type=int, default=KILLS)
    options, rest = parser.parse_known_args()
    KILLS = options.kills
    sys.argv[1:] = rest
    cli_test.main()


if __name__ == "__main__":
    main()
