#!/usr/bin/env python3
"""Gives every option that takes a number wrong values, as of a wrong unit: its default, or 1, times 10^-6, 10^-3, 10^3
and 10^6. The program must answer within a minute and 2 GiB, or refuse in one line. The logs have some 50 000 beams.
Options of several numbers have the same wrong unit in each. `live` and `serve` have answered when they serve; `live` is
left out where its server was not built (`make live`), and the front door of Python where the package was not.

  units.py --program build/bin/underbrush [--only fit simulate] [--jobs 2]
"""
import argparse
import concurrent.futures
import dataclasses
import os
import pathlib
import re
import resource
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import threading
import time

import seeds

WALL_S, MEMORY = 60, 2 << 30
FACTORS = (1e-6, 1e-3, 1e3, 1e6)
RECORDING = "import of a recording"  # by the front door of Python
SERVERS = ("live", "serve")
# The commands of each verb, in a folder with the inputs. OUT is a new name.
COMMANDS = {
    "import": ("big.csv -o OUT.ply", "marv_forest.pcd -o OUT.ply --unknown-below-deg -13", "drive -o OUT.ply"),
    "info": ("big.ply",),
    "split": ("big.ply --every 2 --train OUT.ply --test OUT2.ply",
              "big.ply --columns 2 --train OUT.ply --test OUT2.ply"),
    "movers": ("big.ply -o OUT.ply",),
    "actors": ("passing.ply --boxes van.csv --least-returns 10 -o OUT",),
    "fit": tuple(f"big.ply -o OUT --fitter {name}" for name in
                 ("likelihood", "voxel", "surface", "ground_mesh", "top_down", "bottom_up", "rimls")),
    "optimize": ("log.ply -o OUT.yaml --budget 2",),
    "rasters": ("model -o OUT",),
    "segment": ("big.ply -o OUT.ply",),
    "extract": ("model labelled.ply -o OUT",),
    "meshes": ("generated -o OUT",),
    "annotate": ("labelled.ply -o OUT.json", "--generate forest -o OUT.json",
                 "--generate forest --parts 20 -o OUT", "--like forest.json -o OUT.json"),
    "primitives": ("merge primitives -o OUT", "list primitives"),
    "regions": ("model -o OUT",),
    "compose": ("site.json primitives -o OUT",),
    "simulate": ("model --like big.ply -o OUT.ply",
                 "model --sensor spinning.yaml --trajectory poses.txt --super-sample sensor -o OUT.ply"),
    "perceive": ("big.ply -o OUT.csv --pipeline real", "big.ply -o OUT.csv --truth boxes.csv"),
    "score": ("log.ply simulated.ply --model model --train log.ply", "objects.csv objects.json"),
    "osi": ("replay views_sv_.osi -o OUT.osi",),
    "live": ("model --sensor spinning.yaml",),
    "sensors": ("echo spinning.yaml --target 10:leaf:0.4", "show spinning.yaml"),
    "serve": ("log.ply --cache OUT",),
    "demo": ("-o OUT --only real", "-o OUT --only site --sensor small.yaml"),
    "plan": ("job.yaml -o OUT",),
    "run": ("plan --task 1", "plan"),
    "merge": ("plan",),
    RECORDING: ("flight.las -o OUT.ply --position 5,0,100",),
}
#: Commands that fail as they are, since the option that they lack is among those that are tried.
INCOMPLETE = ("plan",)
OPTION = re.compile(r"^  (?:-\w, )?(--[a-z-]+) (\S+(?: [A-Z][A-Z0-9]*)*)(?=  |\s*$)")
#: Names of values that are numbers, as the help gives them; the number of words is that of the numbers.
NUMBERS = ("X", "N", "M", "F", "K", "X Y", "FROM TO", "X0 Y0 X1 Y1")
#: Values with a number in them: how they are written, and the right number.
AROUND = {"--memory": ("{}GiB", 2), "--beams": ("0:{:.0f}", 1000), "--frames": ("0:{:.0f}", 2), "--returns": ("{:.0f}", 2),
          "--super-sample": ("{:.0f}", 4), "--target": ("{}:leaf:0.4", 10), "--class-density": ("large_shrub={}", 1),
          "--strategy": ("tracking:gain={}", 0.3), "--position": ("{0},{0},{0}", 10)}
#: A parameter of `fit` on the page that is made of their table, also one that the help leaves out.
PARAMETER = re.compile(r"^\| `([\w-]+)` \| [^|]* \| ([\d.e+-]+) \|", re.MULTILINE)
PARAMETERS = pathlib.Path(__file__).parents[2] / "docs/reference/parameters.md"
DEFAULT = re.compile(r"\[([-+.\de ]+)\]\s*$")


@dataclasses.dataclass
class Run:
    verb: str
    words: list
    must_answer: bool = False
    outcome: str = ""  # "answer", "refusal" or what is wrong
    seconds: float = 0
    memory: int = 0  # bytes


def start_of(program, verb):
    """The words that begin a command of the verb."""
    return [*program[RECORDING], "import"] if verb == RECORDING else [program["underbrush"], verb]


def options_of(program, verb):
    """[(option, its numbers and how they are written, whether they are whole)] from the verb's help."""
    text = subprocess.run([*start_of(program, verb), "--help-all"], capture_output=True, text=True, check=True,
                          env=program["environment"]).stdout
    entries, found = [], []
    for line in text.splitlines():
        if re.match(r"^  -", line):
            entries.append(line)
        elif entries and re.match(r"^ {10}", line):
            entries[-1] += "  " + line.strip()
    for entry in entries:
        option, default = OPTION.match(entry), DEFAULT.search(entry)
        if not option:
            continue
        name, kind = option.groups()
        if name in AROUND:
            form, number = AROUND[name]
            found.append((name, [number], form, False))
        elif kind in NUMBERS:
            count = len(kind.split())
            given = [float(word) for word in default[1].split()] if default else []
            numbers = [x or 1 for x in given] if len(given) == count else list(range(1, count + 1))
            found.append((name, numbers, None, kind in "NK"))
    if verb == "fit":
        known = {name for name, *_ in found}
        found += [("--" + name, [float(default) or 1], None, False)
                  for name, default in PARAMETER.findall(PARAMETERS.read_text()) if "--" + name not in known]
    return found


def values_of(numbers, form, whole):
    """The words of an option's value in each wrong unit."""
    for factor in FACTORS:
        if form:
            yield (form.format(numbers[0] * factor),)
        else:
            yield tuple(str(round(x * factor)) if whole else f"{x * factor:g}" for x in numbers)


def without(words, option):
    """The words without the option and its value."""
    at = words.index(option) if option in words else len(words)
    return words[:at] + words[at + 2:]


def runs_of(program, verbs):
    """The commands as they are, which must be answered, and with each value of each option."""
    for verb in verbs:
        yield from (Run(verb, command.split(), must_answer=command not in INCOMPLETE or verb == "merge")
                    for command in COMMANDS[verb])
        for option, *of_option in options_of(program, verb):
            values = dict.fromkeys(values_of(*of_option))
            for command in COMMANDS[verb]:
                if option not in command.split() or option in AROUND:
                    words = without(command.split(), option)
                    yield from (Run(verb, [*words, option, *value]) for value in values)


def limit_memory():
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def ended(pid):
    return os.waitid(os.P_PID, pid, os.WEXITED | os.WNOHANG | os.WNOWAIT) is not None


def finish(run, process, said):
    """Waits for its end, a server's after its first line; notes time and memory. Returns whether it was in time.
    `Popen` may wait for a process wherever it signals it, and the memory of that would be lost."""
    begin = time.monotonic()
    timer = threading.Timer(WALL_S, os.kill, (process.pid, signal.SIGKILL))
    timer.start()
    while run.verb in SERVERS and not ended(process.pid) and not os.path.getsize(said):
        time.sleep(0.02)
    if run.verb in SERVERS:
        os.kill(process.pid, signal.SIGTERM)
    _, status, used = os.wait4(process.pid, 0)
    timer.cancel()
    process.returncode = os.waitstatus_to_exitcode(status)
    run.seconds, run.memory = time.monotonic() - begin, used.ru_maxrss * 1024
    return run.seconds < WALL_S


def try_run(program, inputs, number, run):
    """Runs it on links to the inputs, and says what came of it."""
    with tempfile.TemporaryDirectory(dir=inputs.parent) as folder:
        shutil.copytree(inputs, folder, copy_function=os.link, dirs_exist_ok=True)
        words = [word.replace("OUT", f"out{number}") for word in run.words]
        said, complained = pathlib.Path(folder, ".said"), pathlib.Path(folder, ".complained")
        with said.open("w") as out, complained.open("w") as errors:
            process = subprocess.Popen([*start_of(program, run.verb), *words], cwd=folder, stdin=subprocess.DEVNULL, stdout=out,
                                       stderr=errors, preexec_fn=limit_memory, env=program["environment"])
            in_time = finish(run, process, said)
        serves, text = run.verb in SERVERS and said.stat().st_size > 0, complained.read_text().strip()
    lines = [line for line in text.splitlines() if not line.startswith(("note", "warning"))]
    if not in_time:
        run.outcome = f"no answer within {WALL_S} s"
    elif process.returncode == 0 or serves and process.returncode in (143, -signal.SIGTERM):
        run.outcome = "answer"
    elif process.returncode < 0:
        run.outcome = f"signal {-process.returncode}"
    elif "out of memory" in text or "bad_alloc" in text:
        run.outcome = "more than 2 GiB: " + text
    elif len(lines) != 1:
        run.outcome = f"{len(lines)} lines: " + " / ".join(lines[:4])
    else:
        run.outcome = "refused: " + text if run.must_answer else "refusal"
    return run


def las(rows):
    """A file of LAS 1.2 with the returns among the rows of a log."""
    points = [(x, y, z, t) for x, y, z, t, _, _, _, hit, *_ in rows if hit]
    low, high = (tuple(pick(p[k] for p in points) for k in range(3)) for pick in (min, max))
    bounds = [bound for k in range(3) for bound in (high[k], low[k])]
    head = struct.pack("<4sHH16sBB32s32sHHHIIBHI5I12d", b"LASF", 0, 0, b"", 1, 2, b"", b"", 1, 2026, 227, 227, 0, 1, 28,
                       len(points), len(points), 0, 0, 0, 0, *[0.001] * 3, *[0.0] * 3, *bounds)
    return head + b"".join(struct.pack("<3iHBBbBHd", *(round(1000 * v) for v in p[:3]), 100, 0b00001001, 2, 0, 0, 1, p[3])
                           for p in points)


def python_of(build):
    """The words that begin a command of the package in a build folder, and its environment; no words without it."""
    python = build / "python/venv/bin/python"
    environment = {**os.environ, "PYTHONPATH": str(build / "python/package"), "OPENBLAS_NUM_THREADS": "1"}
    return ([python, "-m", "underbrush"] if python.exists() else []), environment


def make_inputs(folder, program):
    seeds.make(folder, program)
    (folder / "big.csv").write_text(seeds.csv(seeds.beams(scans=4, columns=400, rings=32)))
    (folder / "flight.las").write_bytes(las(seeds.beams()))
    sensor = (seeds.SHARE / "sensors/velodyne-vlp16.yaml").read_text()
    for key, value in (("name", "small"), ("rate_hz", "2"), ("firing_period_us", "2000")):
        sensor = re.sub(f"^{key}: .*", f"{key}: {value}", sensor, flags=re.MULTILINE)
    (folder / "small.yaml").write_text(sensor)
    for command in ("import big.csv -o big.ply", "annotate --generate forest --size 60 60 -o forest.json",
                    *(f"run plan --task {k}" for k in range(4))):
        subprocess.run([program, *command.split()], cwd=folder, check=True, capture_output=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", required=True, type=pathlib.Path)
    parser.add_argument("--build", type=pathlib.Path, help="its Python package [that of the program]")
    parser.add_argument("--only", nargs="+", choices=COMMANDS, default=list(COMMANDS), help="these verbs")
    parser.add_argument("--jobs", type=int, default=1)
    options = parser.parse_args()
    path = options.program.resolve()
    build = (options.build or path.parents[1]).resolve()
    door, environment = python_of(build)
    program = {"underbrush": path, RECORDING: door, "environment": environment}
    for verb, there, reason in (("live", (path.parents[1] / "lib/underbrush/live_grpc.so").exists(), "its server (make live)"),
                                (RECORDING, door, "Python's package")):
        if verb in options.only and not there:
            print(f"{verb} is left out: {reason} is not built", file=sys.stderr)
            options.only.remove(verb)
    with tempfile.TemporaryDirectory() as scratch:
        inputs = pathlib.Path(scratch, "inputs")
        inputs.mkdir()
        make_inputs(inputs, path)
        runs = list(runs_of(program, options.only))
        with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
            done = list(pool.map(lambda at: try_run(program, inputs, *at), enumerate(runs)))
    wrong = [run for run in done if run.outcome not in ("answer", "refusal")]
    print("| verb | runs | answers | refusals | wrong | slowest, s | most memory, MiB |\n" + "|---|" + "---:|" * 6)
    for verb in options.only:
        of_verb = [run for run in done if run.verb == verb]
        counts = [sum(run.outcome == what for run in of_verb) for what in ("answer", "refusal")]
        slowest, most = (max((getattr(run, what) for run in of_verb), default=0) for what in ("seconds", "memory"))
        print(f"| {verb} | {len(of_verb)} | {counts[0]} | {counts[1]} | {len(of_verb) - sum(counts)} | {slowest:.1f} | "
              f"{most / 2**20:.0f} |")
    for run in wrong:
        print(f"{run.verb} {' '.join(run.words)}: {run.outcome}", file=sys.stderr)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
