"""Kills each long command at random moments: its output is then absent, as before, or whole."""
import os
import pathlib
import random
import signal
import tempfile
import time

import bounded
from bounded import ANSWER, REFUSAL
from jobs import JOBS, copy_inputs, good_run


def remove(folder, name):
    """Removes an output and what stands beside it."""
    for one in sorted(bounded.names(folder), reverse=True):
        if one.split("/")[0].startswith(name) or one.startswith("second"):
            path = folder / one
            path.rmdir() if path.is_dir() and not path.is_symlink() else path.unlink()


def kill_at(program, folder, job, out, wait_s, seed):
    """Runs the job, kills it after so many seconds, and returns whether it was still running."""
    process = bounded.start([program, *job.words(out, seed)], folder)
    time.sleep(wait_s)
    running = process.poll() is None
    os.kill(process.pid, signal.SIGKILL) if running else None
    bounded.end(process)
    return running


def again(program, folder, job, out, good):
    """Runs the job once more where it was killed, goes on where it can, and says what is wrong, if anything."""
    more = ["--resume"] if job.resumed and (folder / (out + ".checkpoint")).exists() else []
    done = bounded.run([program, *job.words(out), *more], folder)
    if done.code != 0:
        return "the next run fails: " + done.err.strip()
    if bounded.contents(folder / out) != good:
        return "the next run writes another output"
    left = [name for name in bounded.names(folder) if ".underbrush-" in name]
    return f"the next run leaves {left[:3]}" if left else None


def kill_job(options, job, table):
    folder = copy_inputs(options.inputs, pathlib.Path(tempfile.mkdtemp(dir=options.scratch), "at"), job)
    chance = random.Random(f"{options.seed}/{job.name}")
    begin = time.monotonic()
    good = good_run(options.program, folder, job)
    took, out = time.monotonic() - begin, "out" + job.ending
    for k in range(options.moments):
        old = {}
        if k % 2 and not job.resumed:  # an output of another seed stands there
            bounded.run([options.program, *job.words(out, 2)], folder)
            old = bounded.contents(folder / out)
        running = kill_at(options.program, folder, job, out, chance.uniform(0, took), 1)
        found = bounded.contents(folder / out)
        wrong = None if found in (old, good) else f"half an output: {sorted(found)[:5]}"
        wrong = wrong or again(options.program, folder, job, out, good)
        table.add("kill -9", wrong or (REFUSAL if running else ANSWER), f"{job.name}, moment {k}")
        remove(folder, out)


def attack(options, table):
    """Runs that were killed count as refusals; those that had ended by then, as answers."""
    for job in JOBS:
        kill_job(options, job, table)
