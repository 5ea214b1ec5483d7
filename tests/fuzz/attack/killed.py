"""Kills each long command at random moments: each of its outputs is then absent, as before, or whole."""
import collections
import os
import pathlib
import random
import shutil
import tempfile
import time

import bounded
from bounded import ANSWER, REFUSAL
from jobs import JOBS, copy_inputs

TEMPORARY = ".underbrush-"


class Killed:
    """A job in a folder of its own, and what undisturbed runs of two seeds write."""

    def __init__(self, options, job):
        self.program, self.job = options.program, job
        self.folder = copy_inputs(options.inputs, pathlib.Path(tempfile.mkdtemp(dir=options.scratch), "at"), job)
        self.inputs = set(os.listdir(self.folder))
        self.old = {} if job.resumed else self.whole_run(2)
        begin = time.monotonic()
        self.good = self.whole_run(1)
        self.took = time.monotonic() - begin

    def words(self, seed=1):
        return [self.program, *self.job.words("out" + self.job.ending, seed)]

    def outputs(self):
        """The contents of each output, by its name."""
        names = set(os.listdir(self.folder)) - self.inputs
        return {name: bounded.contents(self.folder / name) for name in names if not name.startswith(TEMPORARY)}

    def remove_outputs(self):
        for name in set(os.listdir(self.folder)) - self.inputs:
            path = self.folder / name
            shutil.rmtree(path) if path.is_dir() else path.unlink()

    def whole_run(self, seed):
        done = bounded.run(self.words(seed), self.folder)
        if done.code != 0:
            raise SystemExit(f"attack: {self.job.name} fails without an attack: {done.err}")
        found = self.outputs()
        self.remove_outputs()
        return found

    def put(self, outputs):
        for output, files in outputs.items():
            for name, data in files.items():
                path = self.folder / output / name if name else self.folder / output
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_bytes(data)

    def kill_after(self, wait_s):
        """Runs the job, kills it after so many seconds, and returns whether it was still running."""
        process = bounded.start(self.words(), self.folder)
        time.sleep(wait_s)
        running = process.poll() is None
        process.kill()
        bounded.end(process)
        return running

    def temporaries(self):
        return [name for name in bounded.names(self.folder) if TEMPORARY in name]

    def wrong_outputs(self, before):
        """What is neither as before nor as an undisturbed run writes it; a checkpoint grows while the job runs."""
        found = self.outputs()
        return [name for name in {*found, *before} if not name.endswith(".checkpoint") and
                found.get(name) not in (before.get(name), self.good.get(name))]

    def again(self):
        """Runs the job where it was killed, goes on where it can, and says what is wrong, if anything."""
        resumed = self.job.resumed and (self.folder / ("out" + self.job.ending + ".checkpoint")).exists()
        left = os.listdir(self.folder)
        done = bounded.run(self.words() + (["--resume"] if resumed else []), self.folder)
        if done.code != 0:
            return "the next run fails: " + done.err.strip()
        if self.outputs() != self.good:
            return "the next run writes other outputs"
        if self.temporaries():
            return f"the next run leaves {self.temporaries()[:3]}"
        if any(name.startswith(TEMPORARY) for name in left) and "killed run" not in done.err:
            return "the next run does not say what it removed"
        return None


def attack(options, table):
    """Runs that were killed count as refusals; those that had ended by then, as answers."""
    print("| command | killed while running | left temporary files | wrong |\n|---|---:|---:|---:|")
    for job in JOBS:
        one, chance, counts = Killed(options, job), random.Random(f"{options.seed}/{job.name}"), collections.Counter()
        for k in range(options.moments):
            before = one.old if k % 2 else {}
            one.put(before)
            running = one.kill_after(chance.uniform(0, one.took))
            left, half = bool(one.temporaries()), one.wrong_outputs(before)
            wrong = f"half an output: {half}" if half else one.again()
            counts.update(running=running, left=left, wrong=bool(wrong))
            table.add("kill -9", wrong or (REFUSAL if running else ANSWER), f"{job.name}, moment {k}")
            one.remove_outputs()
        print(f"| {job.name} | {counts['running']} | {counts['left']} | {counts['wrong']} |", flush=True)
