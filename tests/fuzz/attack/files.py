"""Attacks by what stands where a file is read or written: full disks, devices, pipes, links, other processes."""
import contextlib
import os
import pathlib
import shutil
import subprocess
import tempfile
import threading

import bounded
from bounded import ANSWER, REFUSAL
from jobs import JOBS, copy_inputs, good_run

ROUNDS = 4  # of two processes with one output


@contextlib.contextmanager
def mounted(place, options):
    """A file system in memory; `attack.py` gives this process mounts of its own."""
    place.mkdir()
    subprocess.run(["mount", "-t", "tmpfs", "-o", options, "none", place], check=True)
    try:
        yield place
    finally:
        subprocess.run(["umount", "-l", place], check=True)
        place.rmdir()


def remove(out):
    """Removes an output, whatever it is, if there is one."""
    shutil.rmtree(out) if out.is_dir() and not out.is_symlink() else out.unlink(missing_ok=True)


def whole(done, place, old, good, allowed=(ANSWER, REFUSAL)):
    """What came of a run: its output must be whole after an answer and as before after a refusal."""
    outcome = bounded.judged(done, codes=(2, 3, 4))
    found = bounded.contents(place)
    if outcome == ANSWER and found != good:
        return "an answer, but the output is another one"
    if outcome == REFUSAL and found != old:
        return "refused, but the output changed: " + done.err.strip()
    left = [name for name in bounded.names(place.parent) if ".underbrush-" in name]
    if left:
        return f"left {left[:3]}"
    return outcome if outcome in allowed or outcome not in (ANSWER, REFUSAL) else "an " + outcome + ": " + done.err


class Try:
    """A job in a folder of its own with its inputs, and what it writes without an attack."""
    def __init__(self, program, inputs, scratch, job):
        self.program, self.job = program, job
        self.folder = copy_inputs(inputs, pathlib.Path(tempfile.mkdtemp(dir=scratch), "at"), job)
        self.good = good_run(program, self.folder, job)
        self.size = sum(map(len, self.good.values()))

    def run(self, out, replaced=(), **more):
        return bounded.run([self.program, *self.job.words(out, **dict(replaced))], self.folder, **more)


def full_disk(one):
    """Disks of all sizes up to one that is large enough, and disks with too few inodes; with an old output or none."""
    size, sizes = 4, []
    while size << 10 < 4 * one.size + (64 << 10):
        sizes.append(f"size={size}k")
        size *= 2
    for options in [*sizes, *(f"nr_inodes={n}" for n in range(1, 10, 2))]:
        with mounted(one.folder / "disk", options) as disk:
            out = disk / ("out" + one.job.ending)
            # The provenance names the output as it was given, so that its bytes are not compared here.
            done = one.run(f"disk/{out.name}")
            outcome = bounded.judged(done, codes=(4,))
            # The answer of a search is kept where only its checkpoint found no room.
            known = {out.name, out.name + ".checkpoint"} if one.job.resumed else set()
            if outcome == REFUSAL and bounded.names(disk) - known:
                outcome = f"left {sorted(bounded.names(disk))[:3]}"
            if outcome == ANSWER and len(bounded.contents(out)) != len(one.good):
                outcome = "an answer without all of its files"
            yield outcome, options


def full_disk_of_temporaries(one):
    """No room for what the run itself puts aside."""
    out = one.folder / ("out" + one.job.ending)
    with mounted(one.folder / "tmp", "size=4k,nr_inodes=1") as place:
        done = one.run(out.name, env={**os.environ, "TMPDIR": str(place), "XDG_CACHE_HOME": str(place)})
        yield whole(done, out, {}, one.good), "TMPDIR"
    remove(out)


def devices(one):
    """Devices, pipes and folders where an output should stand."""
    os.mkfifo(one.folder / "pipe")
    (one.folder / "folder.x").mkdir()
    (one.folder / "folder.x/thesis.tex").write_text("years")
    for place in ("/dev/full", "/dev/null", "/dev/stdout", "/dev/zero", "pipe", "folder.x", "/proc/self/mem",
                  "/proc/out" + one.job.ending):
        kind = os.stat(place).st_mode if place.startswith("/dev") else 0
        done = one.run(place)
        same = not kind or os.stat(place).st_mode == kind
        thesis = (one.folder / "folder.x/thesis.tex").exists()
        yield (bounded.judged(done) if same and thesis else "replaced"), place


def feed(path, data):
    """Writes to a pipe once somebody reads it."""
    with contextlib.suppress(OSError):
        with open(path, "wb") as pipe:
            pipe.write(data)


def odd_inputs(one):
    """Pipes that nobody feeds or that are fed, devices, folders and sockets in the place of inputs."""
    files = [name for name in one.job.inputs if (one.folder / name).is_file()]
    inside = [f"{name}/{part}" for name in one.job.inputs for part in bounded.contents(one.folder / name) if part]
    for name in files + inside:
        path, kept = one.folder / name, one.folder / "kept"
        path.rename(kept)
        for what in ("unfed", "fed", "closed", "/dev/zero", "/dev/urandom", "/dev/null", "/proc/self/mem", "folder"):
            if what.startswith("/"):
                path.symlink_to(what)
            elif what == "folder":
                path.mkdir()
            else:
                os.mkfifo(path)
            if what in ("fed", "closed"):
                data = kept.read_bytes() if what == "fed" else b""
                threading.Thread(target=feed, args=(path, data), daemon=True).start()
            done = one.run("out" + one.job.ending)
            yield bounded.judged(done), f"{name} is {what}"
            if what in ("fed", "closed"):
                with contextlib.suppress(OSError):
                    os.close(os.open(path, os.O_RDONLY | os.O_NONBLOCK))  # lets the writer go
            path.rmdir() if what == "folder" else path.unlink()
            remove(one.folder / ("out" + one.job.ending))
        kept.rename(path)


def links(one):
    """An output that is a link to an input, to itself, to nothing, or to a file elsewhere."""
    out = one.folder / ("out" + one.job.ending)
    for name in one.job.inputs:
        before = bounded.contents(one.folder / name)
        ways = [("symbolic link", os.symlink, name), ("hard link", os.link, one.folder / name)]
        for what, link, target in ways[:1] if (one.folder / name).is_dir() else ways:
            link(target, out)
            done = one.run(out.name)
            same = bounded.contents(one.folder / name) == before
            outcome = bounded.judged(done)
            yield (outcome if same else "the input changed"), f"{what} to {name}"
            remove(out)
    for what, target in (("link to itself", out.name), ("link to nothing", "nothing"), ("link out", "../elsewhere")):
        out.symlink_to(target)
        done = one.run(out.name)
        yield bounded.judged(done), what
        remove(out)


def two_processes(one):
    """Two runs with one output and different seeds: what stands at the end is the output of one of them."""
    out = one.folder / ("out" + one.job.ending)
    other = good_run(one.program, one.folder, one.job, seed=2) if one.job.seeded else one.good
    for k in range(ROUNDS):
        runs = [bounded.start([one.program, *one.job.words(out.name, seed)], one.folder) for seed in (1, 2)]
        for done in [bounded.end(each) for each in runs]:
            outcome = bounded.judged(done)
            if outcome == ANSWER and bounded.contents(out) not in (one.good, other):
                outcome = "the output is of neither run"
            left = [name for name in bounded.names(one.folder) if ".underbrush-" in name]
            yield (f"left {left[:3]}" if left else outcome), f"round {k}"
        if one.job.resumed:
            (one.folder / (out.name + ".checkpoint")).unlink(missing_ok=True)


def read_only(one):
    """A folder, on a disk, that may not be written to; and inputs on one, which is no hindrance."""
    with mounted(one.folder / "disk", "size=1m") as disk:
        subprocess.run(["mount", "-o", "remount,ro", disk], check=True)
        yield bounded.judged(one.run("disk/out" + one.job.ending), codes=(4,)), "output"


ATTACKS = {"disk full": full_disk, "no room for temporary files": full_disk_of_temporaries,
           "output is a device": devices, "input is a pipe or a device": odd_inputs, "output is a link": links,
           "two processes, one output": two_processes, "read-only disk": read_only}


def attack(options, table):
    """Tries every attack with every job."""
    for job in JOBS:
        one = Try(options.program, options.inputs, options.scratch, job)
        for name, tries in ATTACKS.items():
            for outcome, what in tries(one):
                table.add(name, outcome, f"{job.name}, {what}")
