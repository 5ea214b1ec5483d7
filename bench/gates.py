#!/usr/bin/env python3
"""Counts the instructions of fixed pieces of work by callgrind, and fails where one takes more than its limit in
gates.txt. Instructions are the same on a busy machine as on an idle one.

  gates.py --bin build/bin                  all gates (minutes)
  gates.py --bin build/bin --only fit       those whose names begin so
  gates.py --bin build/bin --for test       those of `make test`"""
import argparse
import collections
import functools
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


class Calls:
    """The call graph that callgrind wrote: {function: name} and edges [(caller, callee, inclusive cost)]."""

    def __init__(self, file):
        names, edges, self.total = {}, collections.Counter(), 0
        caller = callee = None
        with open(file) as lines:
            for line in lines:
                if match := re.match(r"(c?)fn=\((\d+)\)(?: (.*))?$", line):
                    if match[3]:
                        names[match[2]] = re.sub(r"'\d+$", "", match[3])
                    if match[1]:
                        callee = match[2]
                    else:
                        caller = match[2]
                elif line.startswith("calls="):
                    edges[names[caller], names[callee]] += int(next(lines).split()[1])
                elif line.startswith("summary: "):
                    self.total = int(line.split()[1])
        self.edges = [(a, b, n) for (a, b), n in edges.items() if a != b]

    def inside(self, pattern):
        """The cost of the functions that match, and of what they call. A function that is called from inside and
        from outside them is shared out by the costs of its calls, as in gprof."""
        match = {name: re.search(pattern, name) is not None for a, b, _ in self.edges for name in (a, b)}
        calls_of = collections.defaultdict(list)
        for caller, callee, n in self.edges:
            calls_of[callee].append((caller, n))
        outside = {name: float(not is_one) for name, is_one in match.items()}
        for _ in range(60):   # deeper than any stack of calls
            for name, calls in calls_of.items():
                if not match[name]:
                    outside[name] = sum(n * outside[caller] for caller, n in calls) / max(1, sum(n for _, n in calls))
        return sum(n * outside[caller] for caller, callee, n in self.edges if match[callee])


PARALLEL = r"^underbrush::(parallel_\w+|sort_keys)\("


def run_under_callgrind(command, work, *options):
    counts = work / "callgrind"
    done = subprocess.run(["valgrind", "--tool=callgrind", f"--callgrind-out-file={counts}", *options, *command],
                          capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(command)}\n{done.stderr}")
    return Calls(counts), done.stdout


@functools.lru_cache(maxsize=1)
def run_verb(command, work):
    """A command with one thread. Gates of the same command follow each other and share a run."""
    return run_under_callgrind([*command, "--threads", "1"], work)


def count(gate, bin_folder, work):
    command = gate.command.format(work=work).split()
    command[0] = str(bin_folder / command[0])
    if gate.part == "counted_pass":   # of a benchmark
        calls, out = run_under_callgrind(command, work, "--collect-atstart=no", f"--toggle-collect=*{gate.part}*")
        return calls.total / units_in(gate, command, out)
    calls, out = run_verb(tuple(command), work)
    if gate.part == "*":
        instructions = calls.total
    elif gate.part == "serial":
        instructions = calls.total - calls.inside(PARALLEL)
    else:
        instructions = calls.inside(rf"^underbrush::(\w+::)*({gate.part})\(")
    return instructions / units_in(gate, command, out)


def prepare(program, work, gates):
    """Makes the inputs that the commands of the gates name."""
    commands = " ".join(g.command for g in gates)
    steps = []
    if "{work}/real" in commands:
        steps.append("demo --only real -o {work}")
    if "{work}/site" in commands:
        steps += ["demo --only site -o {work}/site",
                  "split {work}/site/train.ply --time 0 3 --train {work}/site/first.ply --test {work}/site/rest.ply",
                  "split {work}/site/test.ply --time 0 3 --train {work}/site/held_out.ply --test {work}/site/last.ply"]
    if "{work}/site/simulated" in commands:
        steps.append("simulate {work}/site/likelihood --like {work}/site/last.ply -o {work}/site/simulated.ply")
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
    parser.add_argument("--only", metavar="GATE", help="the gates whose names begin so")
    parser.add_argument("--for", dest="run_by", metavar="WHO", help="only the gates of this column")
    options = parser.parse_args()
    gates = [g for g in read_gates(HERE / "gates.txt")
             if (options.only is None or g.name.startswith(options.only)) and options.run_by in (None, g.run_by)]
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
            print(f"{gate.name:18} {each:10.0f} instructions per {gate.unit:6} limit {gate.limit}"
                  f"{'  OVER' if over else ''}", flush=True)
    sys.exit(failed > 0)


if __name__ == "__main__":
    main()
