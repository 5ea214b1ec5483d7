#!/usr/bin/env python3
"""Gives every option that takes a number wrong values, as of a wrong unit: its default, or 1, times 10^-6, 10^-3, 10^3
and 10^6. The program must answer within a minute and 2 GiB, or refuse in one line. The logs have some 50 000 beams.
`live` has answered when it serves; it is left out where its server was not built (`make live`).

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
import subprocess
import sys
import tempfile
import threading
import time

import seeds

WALL_S, MEMORY = 60, 2 << 30
FACTORS = (1e-6, 1e-3, 1e3, 1e6)
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
}
OPTION = re.compile(r"^  (?:-\w, )?(--[a-z-]+) (X|N)(?=\s|$)")
#: A parameter of `fit` on the page that is made of their table, also one that the help leaves out.
PARAMETER = re.compile(r"^\| `([\w-]+)` \| [^|]* \| ([\d.e+-]+) \|", re.MULTILINE)
PARAMETERS = pathlib.Path(__file__).parents[2] / "docs/reference/parameters.md"
DEFAULT = re.compile(r"\[([-+.\de]+)\]\s*$")


@dataclasses.dataclass
class Run:
    verb: str
    words: list
    must_answer: bool = False
    outcome: str = ""  # "answer", "refusal" or what is wrong
    seconds: float = 0
    memory: int = 0  # bytes


def options_of(program, verb):
    """[(option, whether it is a whole number, default or None)] from the verb's help."""
    text = subprocess.run([program, verb, "--help-all"], capture_output=True, text=True, check=True).stdout
    entries, found = [], []
    for line in text.splitlines():
        if re.match(r"^  -", line):
            entries.append(line)
        elif entries and re.match(r"^ {10}", line):
            entries[-1] += " " + line.strip()
    for entry in entries:
        option, default = OPTION.match(entry), DEFAULT.search(entry)
        if option:
            found.append((option[1], option[2] == "N", float(default[1]) if default else None))
    if verb == "fit":
        known = {name for name, _, _ in found}
        found += [("--" + name, False, float(default)) for name, default in PARAMETER.findall(PARAMETERS.read_text())
                  if "--" + name not in known]
    return found


def values_of(whole, default):
    for factor in FACTORS:
        value = (default or 1) * factor
        yield str(round(value)) if whole else f"{value:g}"


def runs_of(program, verbs):
    """The commands as they are, which must be answered, and with each value of each option."""
    for verb in verbs:
        yield from (Run(verb, command.split(), must_answer=True) for command in COMMANDS[verb])
        for option, whole, default in options_of(program, verb):
            values = dict.fromkeys(values_of(whole, default))
            for command in COMMANDS[verb]:
                if option not in command.split():
                    yield from (Run(verb, [*command.split(), option, value]) for value in values)


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
    while run.verb == "live" and not ended(process.pid) and not os.path.getsize(said):
        time.sleep(0.02)
    if run.verb == "live":
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
            process = subprocess.Popen([program, run.verb, *words], cwd=folder, stdin=subprocess.DEVNULL, stdout=out,
                                       stderr=errors, preexec_fn=limit_memory)
            in_time = finish(run, process, said)
        serves, text = run.verb == "live" and said.stat().st_size > 0, complained.read_text().strip()
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


def make_inputs(folder, program):
    seeds.make(folder, program)
    (folder / "big.csv").write_text(seeds.csv(seeds.beams(scans=4, columns=400, rings=32)))
    for command in ("import big.csv -o big.ply", "annotate --generate forest --size 60 60 -o forest.json"):
        subprocess.run([program, *command.split()], cwd=folder, check=True, capture_output=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", required=True, type=pathlib.Path)
    parser.add_argument("--only", nargs="+", choices=COMMANDS, default=list(COMMANDS), help="these verbs")
    parser.add_argument("--jobs", type=int, default=1)
    options = parser.parse_args()
    program = options.program.resolve()
    if not (program.parents[1] / "lib/underbrush/live_grpc.so").exists() and "live" in options.only:
        print("live is left out: its server is not built (make live)", file=sys.stderr)
        options.only.remove("live")
    with tempfile.TemporaryDirectory() as scratch:
        inputs = pathlib.Path(scratch, "inputs")
        inputs.mkdir()
        make_inputs(inputs, program)
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
