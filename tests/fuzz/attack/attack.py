#!/usr/bin/env python3
"""Attacks the program, its server, its FMUs and its Python module in ways that random damage does not find.

  attack.py --program build/bin/underbrush [--kind files killed] [--moments 100] [--seed 1]

Every run is bounded by a minute and 2 GiB. It must give a right answer, or end with one clear line and an exit code
that is not zero; it must not crash, hang, leave half an output or a temporary file.
"""
import argparse
import importlib
import os
import pathlib
import shutil
import sys
import tempfile
import time

import bounded
import jobs

#: Each is a module with `attack(options, table)`.
KINDS = ("files", "killed", "lies", "server", "live", "fmus", "package")
UNSHARED = "UNDERBRUSH_ATTACK_UNSHARED"


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", required=True, type=pathlib.Path)
    parser.add_argument("--build", type=pathlib.Path, help="its FMUs and its Python package [that of the program]")
    parser.add_argument("--kind", nargs="+", choices=KINDS, default=list(KINDS))
    parser.add_argument("--moments", type=int, default=20, help="at which each command is killed [20]")
    parser.add_argument("--lies", type=int, default=200, help="in each kind of file [200]")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--seed", type=int, default=1)
    return parser.parse_args()


def with_mounts_of_its_own():
    """Starts this program again where its mounts are its own and vanish with it."""
    if UNSHARED not in os.environ and shutil.which("unshare"):
        words = ["unshare", "--mount", *(["--map-root-user"] if os.geteuid() else []), sys.executable, *sys.argv]
        os.execvpe(words[0], words, {**os.environ, UNSHARED: "1"})


def main():
    options = arguments()
    with_mounts_of_its_own()
    options.program = options.program.resolve()
    options.build = (options.build or options.program.parents[1]).resolve()
    wrong = 0
    with tempfile.TemporaryDirectory() as scratch:
        options.scratch, options.inputs = pathlib.Path(scratch), pathlib.Path(scratch, "inputs")
        options.inputs.mkdir()
        jobs.make_inputs(options.inputs, options.program)
        for kind in options.kind:
            table, begin = bounded.Table(), time.monotonic()
            importlib.import_module(kind).attack(options, table)
            table.print()
            print(f"{kind}: {time.monotonic() - begin:.0f} s", file=sys.stderr)
            print("\n".join(table.wrong), file=sys.stderr, flush=True)
            wrong += len(table.wrong)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
