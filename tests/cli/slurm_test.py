#!/usr/bin/env python3
"""A plan runs on Slurm: the printed script submits its stages and the merge to the daemons of Debian's slurm-wlm, which
the test starts on this machine as root with a configuration of their own.

  slurm_test.py --program build/bin/underbrush --kills 100 Slurm     kills nodes at half as many moments
"""
import json
import pathlib
import random
import shutil
import sys
import time

import cli_test
import faults_test
import jobs_test

sys.path.insert(0, str(pathlib.Path(__file__).parents[2] / "scripts"))
import local_slurm  # noqa: E402

class Slurm(jobs_test.JobFolder):
    """One machine that is the controller and the only node."""

    def setUp(self):
        super().setUp()
        if lacking := local_slurm.lacking():
            self.skipTest(lacking)
        self.slurm = local_slurm.LocalSlurm(self.folder, cli_test.PROGRAM)
        self.addCleanup(self.slurm.stop)
        self.slurmd = self.slurm.start_all()

    def submit(self, waiting=lambda: None):
        """Submits the plan, waits until the queue is empty, and returns what all jobs printed."""
        return self.slurm.submit(self.ok("plan", "--slurm", "plan"), waiting)

    def test_the_printed_script_runs_stages_and_merge(self):
        """A task that is killed is run again."""
        program = self.folder / "bin" / "underbrush"
        program.rename(program.with_name("whole"))
        program.write_text(f"""#!/bin/sh
case "$*" in *"--task 2 "*) ! mkdir {self.folder}/killed 2> /dev/null || kill -9 $$ ;; esac
exec {program.with_name("whole")} "$@"
""")
        program.chmod(0o755)
        self.ok(*jobs_test.SENSED.split(), "--range-noise", 0.02, "-o", "seen.ublog")
        command = "fit seen.ublog --rounds 1 -o {}"
        tasks = self.plan(command.format("joined"), pieces=3)
        self.assertEqual(tasks, 5)
        printed = self.submit()
        self.assertTrue((self.folder / "killed").exists())
        self.assertEqual(printed.count("done: "), tasks, printed)
        self.ok(*command.format("whole").split())
        self.assertEqual(self.files_of("joined"), self.files_of("whole"))

    def test_three_failures_are_reported_and_other_commands_go_on(self):
        self.ok(*jobs_test.SENSED.split(), "--range-noise", 0.02, "-o", "a.ublog")
        damaged = bytearray(self.bytes_of("a.ublog"))
        damaged[5000:5100] = bytes(100)
        (self.folder / "b.ublog").write_bytes(damaged)
        tasks = self.plan("fit {log}.ublog --rounds 1 -o {log}", over={"log": ["a", "b"]}, pieces=2)
        printed = self.submit()
        status = json.loads(self.ok("plan", "--status", "plan", "--json", "-"))
        (failure,) = status["failed"].values()
        self.assertEqual((len(status["done"]), failure["times"]), (tasks / 2, 3), printed)
        self.assertRegex(printed, r"failed 3 times, with exit code 3:\n.*b\.ublog")
        self.assertRegex(printed, r"underbrush: plan: task \d: failed")
        self.assertFalse((self.folder / "a").exists())

    def test_nodes_that_are_killed(self):
        """The node's daemon starts again; a job that it lost is queued or submitted again."""
        chance, killed = random.Random(53), 0

        def kill_one():
            nonlocal killed
            time.sleep(chance.uniform(0, 3))
            self.slurmd.kill()
            self.slurmd.wait()
            self.slurmd = self.slurm.start("slurmd", "-D")
            killed += 1

        self.ok(*jobs_test.SENSED.split(), "--range-noise", 0.02, "-o", "seen.ublog")
        command = "fit seen.ublog --rounds 1 -o {}"
        self.ok(*command.format("whole").split())
        while killed < faults_test.KILLS / 2:
            shutil.rmtree(self.folder / "plan", ignore_errors=True)
            shutil.rmtree(self.folder / "joined", ignore_errors=True)
            self.plan(command.format("joined"), pieces=3)
            while not (self.folder / "joined").exists():
                moments = iter(range(2))
                self.submit(lambda: next(moments, None) is not None and kill_one())
            self.assertEqual(self.files_of("joined"), self.files_of("whole"))


if __name__ == "__main__":
    faults_test.main()
