#!/usr/bin/env python3
"""A plan runs on Slurm: the printed script submits its stages and the merge to the daemons of Debian's slurm-wlm, which
the test starts on this machine as root with a configuration of their own.

  slurm_test.py --program build/bin/underbrush --kills 100 Slurm     kills nodes at half as many moments
"""
import json
import os
import pathlib
import random
import shutil
import socket
import subprocess
import time

import cli_test
import faults_test
import jobs_test

DAEMONS = ("munged", "slurmctld", "slurmd", "sbatch")


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


class Slurm(jobs_test.JobFolder):
    """One machine that is the controller and the only node."""

    def setUp(self):
        super().setUp()
        self.path = os.environ["PATH"] + ":/usr/sbin:/sbin"
        absent = [name for name in DAEMONS if not shutil.which(name, path=self.path)]
        if absent:
            self.skipTest(f"no {absent[0]}: install slurm-wlm")
        if os.geteuid():
            self.skipTest("slurmd runs as root")
        self.state = self.folder / "slurm"
        self.state.mkdir(mode=0o755)
        self.folder.chmod(0o755)
        bin_folder = self.folder / "bin"
        bin_folder.mkdir()
        (bin_folder / "underbrush").symlink_to(pathlib.Path(cli_test.PROGRAM).resolve())
        host = socket.gethostname().partition(".")[0]
        memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") >> 20
        (self.state / "key").write_bytes(os.urandom(1024))
        (self.state / "key").chmod(0o400)
        (self.state / "slurm.conf").write_text(f"""ClusterName=underbrush
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={free_port()}
SlurmdPort={free_port()}
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket={self.state}/munge
StateSaveLocation={self.state}/state
SlurmdSpoolDir={self.state}/spool
SlurmctldPidFile={self.state}/slurmctld.pid
SlurmdPidFile={self.state}/slurmd.pid
SlurmctldLogFile={self.state}/slurmctld.log
SlurmdLogFile={self.state}/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
MpiDefault=none
ReturnToService=2
SchedulerParameters=sched_interval=1,batch_sched_delay=0,sched_min_interval=0
SelectType=select/cons_tres
SelectTypeParameters=CR_Core_Memory
NodeName={host} NodeAddr=127.0.0.1 CPUs={os.cpu_count()} RealMemory={memory} State=UNKNOWN
PartitionName=all Nodes={host} Default=YES State=UP
""")
        self.environment = dict(os.environ, PATH=f"{bin_folder}:{self.path}", SLURM_CONF=str(self.state / "slurm.conf"))
        self.start("munged", "--foreground", "--force", f"--socket={self.state}/munge", f"--key-file={self.state}/key",
                   f"--pid-file={self.state}/munged.pid", f"--log-file={self.state}/munged.log",
                   f"--seed-file={self.state}/seed")
        self.wait_for(lambda: (self.state / "munge").exists())
        self.start("slurmctld", "-D", "-i")
        self.slurmd = self.start("slurmd", "-D")
        self.wait_for(lambda: "idle" in self.say("sinfo", "--noheader", "--format=%t"))

    def start(self, *words):
        daemon = subprocess.Popen(words, env=self.environment, cwd=self.folder, stdout=subprocess.DEVNULL,
                                  stderr=subprocess.DEVNULL)
        self.addCleanup(daemon.wait)
        self.addCleanup(daemon.terminate)
        return daemon

    def say(self, *words):
        return subprocess.run(words, env=self.environment, cwd=self.folder, capture_output=True, text=True, check=False).stdout

    def wait_for(self, done, seconds=60):
        end = time.monotonic() + seconds
        while not done():
            if time.monotonic() > end:
                logs = "".join(file.read_text()[-2000:] for file in self.state.glob("*.log"))
                self.fail(self.say("squeue", "--long") + logs)
            time.sleep(0.1)

    def submit(self, waiting=lambda: None):
        """Submits the plan, waits until the queue is empty, and returns what all jobs printed."""
        script = self.ok("plan", "--slurm", "plan")
        submitted = subprocess.run(["sh"], input=script, env=self.environment, cwd=self.folder, capture_output=True, text=True,
                                   check=False)
        self.assertEqual(submitted.returncode, 0, submitted.stderr)
        self.wait_for(lambda: waiting() or not self.say("squeue", "--noheader").strip(), 240)
        return "".join(file.read_text() for file in sorted(self.folder.glob("slurm-*.out")))

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
            self.slurmd = self.start("slurmd", "-D")
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
