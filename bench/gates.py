#!/usr/bin/env python3
"""Counts the instructions of fixed pieces of work by callgrind, and fails where one takes more than its limit in
gates.txt. Instructions are the same on a busy machine as on an idle one.

  gates.py --bin build/bin                  all gates (minutes)
  gates.py --bin build/bin --only trace     one of them
  gates.py --bin build/bin --for test       those of `make test`"""
import argparse
import collections
import pathlib
import re
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
Gate = collections.namedtuple("Gate", "name run_by limit unit part command")


def read_gates(file):
    rows = [line for line in file.read_text().splitlines() if line and not line.startswith("#")]
    return [Gate(*row.split(None, 5)) for row in rows]


def beams_of(log):
    """The number of beams that a ray cloud's header names."""
    with open(log, "rb") as f:
        for line in f:
            if match := re.match(rb"element vertex (\d+)", line):
                return int(match[1])
    sys.exit(f"{log}: no vertices in its header")


def units_in(gate, command, out):
    """The amount of work: what the program says, or the beams of the first log named."""
    if match := re.search(r"^(\d+) (?:rays|beams|objects)", out, re.MULTILINE):
        return int(match[1])
    return beams_of(next(word for word in command[2:] if word.endswith(".ply")))


def count(gate, bin_folder, work):
    command = gate.command.format(work=work).split()
    command[0] = str(bin_folder / command[0])
    if gate.part == "*":
        command += ["--threads", "1"]
        part = []
    else:
        part = ["--collect-atstart=no", f"--toggle-collect=*{gate.part}*"]
    counts = work / "callgrind"
    done = subprocess.run(["valgrind", "--tool=callgrind", f"--callgrind-out-file={counts}", *part, *command],
                          capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{gate.name}: {' '.join(command)}\n{done.stderr}")
    total = int(re.search(r"^summary: (\d+)", counts.read_text(), re.MULTILINE)[1])
    return total / units_in(gate, command, done.stdout)


def prepare(program, work, gates):
    """Makes the inputs that the commands of the gates name."""
    commands = " ".join(g.command for g in gates)
    steps = []
    if "{work}" in commands:
        steps.append("demo --only real -o {work}")
    if "{work}/forest.json" in commands:
        steps += ["segment {work}/real/train.ply -o {work}/labelled.ply",
                  "extract {work}/real/likelihood {work}/labelled.ply -o {work}/primitives",
                  "annotate --generate forest --density 0.1 --size 500 500 --ground-spacing 5 -o {work}/forest.json"]
    for step in steps:
        done = subprocess.run([program, *step.format(work=work).split()], capture_output=True, text=True)
        if done.returncode != 0:
            sys.exit(f"{step}\n{done.stderr}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", type=pathlib.Path, default=pathlib.Path("build/bin"), help="folder of the programs")
    parser.add_argument("--only", metavar="GATE", help="one gate")
    parser.add_argument("--for", dest="run_by", metavar="WHO", help="only the gates of this column")
    options = parser.parse_args()
    gates = [g for g in read_gates(HERE / "gates.txt")
             if options.only in (None, g.name) and options.run_by in (None, g.run_by)]
    if not gates:
        sys.exit("no such gate")
    failed = 0
    with tempfile.TemporaryDirectory() as folder:
        work = pathlib.Path(folder)
        prepare(options.bin / "underbrush", work, gates)
        for gate in gates:
            each = count(gate, options.bin, work)
            over = each > float(gate.limit)
            failed += over
            print(f"{gate.name:14} {each:10.0f} instructions per {gate.unit:6} limit {gate.limit}"
                  f"{'  OVER' if over else ''}", flush=True)
    sys.exit(failed > 0)


if __name__ == "__main__":
    main()
