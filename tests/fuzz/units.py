#!/usr/bin/env python3
"""Gives every option that takes a number wrong values, as of a wrong unit: its default, or 1, times 10^-6, 10^-3, 10^3
and 10^6. The program must answer within a minute and 2 GiB, or refuse in one line. The logs have some 50 000 beams.

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
import subprocess
import sys
import tempfile
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
    "sensors": ("echo spinning.yaml --target 10:leaf:0.4", "show spinning.yaml"),
}
OPTION = re.compile(r"^  (?:-\w, )?(--[a-z-]+) (X|N)(?=\s|$)")
DEFAULT = re.compile(r"\[([-+.\de]+)\]\s*$")


@dataclasses.dataclass
class Run:
    verb: str
    words: list
    must_answer: bool = False
    outcome: str = ""  # "answer", "refusal" or what is wrong
    seconds: float = 0


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


def try_run(program, inputs, number, run):
    """Runs it on links to the inputs, and says what came of it."""
    with tempfile.TemporaryDirectory(dir=inputs.parent) as folder:
        shutil.copytree(inputs, folder, copy_function=os.link, dirs_exist_ok=True)
        words = [word.replace("OUT", f"out{number}") for word in run.words]
        begin = time.monotonic()
        try:
            done = subprocess.run([program, run.verb, *words], cwd=folder, stdin=subprocess.DEVNULL, text=True,
                                  capture_output=True, timeout=WALL_S, preexec_fn=limit_memory, check=False)
        except subprocess.TimeoutExpired:
            run.outcome = f"no answer within {WALL_S} s"
            return run
        finally:
            run.seconds = time.monotonic() - begin
    lines = [line for line in done.stderr.strip().splitlines() if not line.startswith(("note", "warning"))]
    if done.returncode == 0:
        run.outcome = "answer"
    elif done.returncode < 0:
        run.outcome = f"signal {-done.returncode}"
    elif "out of memory" in done.stderr or "bad_alloc" in done.stderr:
        run.outcome = "more than 2 GiB: " + done.stderr.strip()
    elif not 1 <= len(lines) <= 2:
        run.outcome = f"{len(lines)} lines: " + " / ".join(lines[:4])
    elif run.must_answer:
        run.outcome = "refused: " + done.stderr.strip()
    else:
        run.outcome = "refusal"
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
    with tempfile.TemporaryDirectory() as scratch:
        inputs = pathlib.Path(scratch, "inputs")
        inputs.mkdir()
        make_inputs(inputs, program)
        runs = list(runs_of(program, options.only))
        with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
            done = list(pool.map(lambda at: try_run(program, inputs, *at), enumerate(runs)))
    wrong = [run for run in done if run.outcome not in ("answer", "refusal")]
    print("| verb | runs | answers | refusals | wrong | slowest, s |\n|---|---:|---:|---:|---:|---:|")
    for verb in options.only:
        of_verb = [run for run in done if run.verb == verb]
        counts = [sum(run.outcome == what for run in of_verb) for what in ("answer", "refusal")]
        slowest = max((run.seconds for run in of_verb), default=0)
        print(f"| {verb} | {len(of_verb)} | {counts[0]} | {counts[1]} | {len(of_verb) - sum(counts)} | {slowest:.1f} |")
    for run in wrong:
        print(f"{run.verb} {' '.join(run.words)}: {run.outcome}", file=sys.stderr)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
