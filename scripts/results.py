#!/usr/bin/env python3
"""Makes the tables of the documentation anew and compares every figure with the one that is printed.

    scripts/results.py --data DATA --work WORK [--bin build/bin] [--only NAME ...] [--list] [--update]

A mark before each table (`<!-- results: NAME -->`, scripts/documented/tables.py) names its commands and claims;
scripts/documented/registry.py has the commands, the cells and the tolerances, claims.txt beside it the claims. A figure may differ from the measured
one by half a unit of its last digit and the tolerance of its column. Jobs that are done and newer than their programs
are not run again, so that an interrupted run goes on. Tables whose data is absent are skipped with a line. All tables
take some hours. Exit status 1: a figure or a claim is beyond its tolerance, or a command failed. With --update the
measured figures take the place of those that are beyond; the text around a table is left to its author.
"""
import argparse
import importlib.util
import os
import pathlib
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from documented import jobs, registry, tables  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parents[1]
PAGES = ("README.md", "docs/*.md", "docs/results/*.md", "docs/how-to/*.md", "docs/tutorial/*.md",
         "docs/explanation/*.md")


def with_numpy():
    """The jobs need NumPy. Debian's Python has it after the set-up; the first one of the PATH may be another."""
    if importlib.util.find_spec("numpy"):
        return
    debian = "/usr/bin/python3"
    if sys.executable == debian or subprocess.run([debian, "-c", "import numpy"], check=False).returncode:
        sys.exit("results: NumPy is missing: scripts/setup.sh build test results")
    os.execv(debian, [debian, *sys.argv])


def documented(root):
    """{name: (page, table)} of all tables that are marked `results`."""
    out, claims = {}, tables.claims_of(root)
    for pattern in PAGES:
        for page in sorted(root.glob(pattern)):
            for table in tables.tables(page.read_text(encoding="utf-8"), claims):
                if table.kind == "results":
                    out[table.name] = page.relative_to(root), table
    return out


def print_list(found, measured, runner):
    for name, (page, table) in found.items():
        parts = measured[name].parts
        wanted = {job.name: job for part in parts for job in part.jobs}.values()
        done = sum(not runner.absent(job) and runner.is_done(job) for job in wanted)
        tolerances = [f"{column}: {value:.0%} of the value" for column, value in measured[name].relative.items()]
        tolerances += [f"{column}: {value:g}" for column, value in measured[name].absolute.items()]
        print(f"{name}: {page}:{table.line}, {len(wanted)} jobs, {done} done, {len(table.claims)} claims, tolerance "
              f"{', '.join(tolerances) or 'the last digit'}")
        for words, reason in measured[name].uncompared.items():
            print(f"  not compared, {words}: {reason}")


def main(measured, root=ROOT, arguments=None):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=pathlib.Path, default=root.parent / "shared/data", help="the real logs")
    parser.add_argument("--work", type=pathlib.Path, default=root / "build/results", help="receives all results")
    parser.add_argument("--bin", type=pathlib.Path, default=root / "build/bin", help="the folder of the programs")
    parser.add_argument("--only", nargs="+", metavar="NAME", help="tables; default: all")
    parser.add_argument("--update", action="store_true", help="write the measured figures into the tables")
    parser.add_argument("--list", action="store_true", help="list the tables and run nothing")
    options = parser.parse_args(arguments)
    found = documented(root)
    unknown = sorted(set(options.only or ()) - set(found)) + sorted(set(found) - set(measured))
    if unknown:
        parser.error(f"no such table: {', '.join(unknown)}")
    runner = jobs.Runner(root, options.bin.resolve(), options.data.resolve(), options.work.resolve())
    if options.list:
        print_list(found, measured, runner)
        return 0
    wrong = 0
    for name in options.only or found:
        page, table = found[name]
        verdict = jobs.judge(table, measured[name], runner)
        wrong += len(verdict.beyond) + len(verdict.failed)
        print(f"{name} ({page}:{table.line}): {verdict.compared} figures and {len(table.claims)} claims compared, "
              f"{len(verdict.beyond)} beyond tolerance", flush=True)
        if options.update and verdict.cells:
            text = (root / page).read_text(encoding="utf-8")
            (root / page).write_text(tables.with_cells(text, table, verdict.cells), encoding="utf-8")
        for line in verdict.skipped:
            print(f"  skipped: {line}")
        for line in verdict.beyond + verdict.failed:
            print(f"  {line}", flush=True)
    return 1 if wrong else 0


if __name__ == "__main__":
    with_numpy()
    sys.exit(main(registry.MEASURED))
