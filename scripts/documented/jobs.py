"""Makes documented tables anew: jobs are commands with result files, a measured table says which figure of a result
stands in which cell, and within which tolerance."""
import dataclasses
import json
import os
import pathlib
import shutil
import subprocess
import sys
import time
import typing

from . import tables


@dataclasses.dataclass(frozen=True)
class Job:
    """Commands for bash that run one after the other in a folder of their own. They may use $DATA, $WORK, $SOURCE
    (the repository), $PYTHON, $BIN (the folder of the programs, which also begins the PATH) and $JOBS/NAME, the
    folder of each job in `after`, which ran before. `needs` are paths below $DATA; `programs` are files of $BIN."""
    name: str
    commands: str
    needs: tuple = ()
    after: tuple = ()
    programs: tuple = ("underbrush",)


@dataclasses.dataclass(frozen=True)
class Part:
    """Cells that are made of the results of some jobs: `cells(folder of the first job, of the second ...)` yields
    (row, column, list of figures)."""
    jobs: tuple
    cells: typing.Callable


@dataclasses.dataclass(frozen=True)
class Measured:
    """A documented table. Figures must be equal to the last printed digit, and may differ beyond it by the tolerance
    of their row or column: a fraction of the value, as `relative`, or `absolute`. `uncompared` has the labels of rows
    and columns whose figures are not made here, with the reason."""
    parts: tuple
    relative: dict = dataclasses.field(default_factory=dict)
    absolute: dict = dataclasses.field(default_factory=dict)
    uncompared: dict = dataclasses.field(default_factory=dict)


class Absent(Exception):
    """Data or a program that a job needs is not there."""


class Failed(Exception):
    """A command ended with an error."""


class Runner:
    """Runs jobs, each at most once, below work/jobs. A job whose `done` is newer than its programs, and whose
    commands are those it was made by, is not run again."""

    def __init__(self, source, bin_folder, data, work, say=lambda line: print(line, file=sys.stderr, flush=True)):
        self.source, self.bin, self.data, self.work, self.say = source, bin_folder, data, work, say
        self.ran = {}

    def folder(self, job):
        return self.work / "jobs" / job.name

    def absent(self, job):
        """What the job or one before it lacks, or None."""
        for path in job.needs:
            if not (self.data / path).exists():
                return f"{path} is not in {self.data}"
        for program in job.programs:
            if not (self.bin / program).exists():
                return f"{program} is not in {self.bin}"
        return next(filter(None, map(self.absent, job.after)), None)

    def is_done(self, job):
        done = self.folder(job) / "done"
        if not done.exists() or done.read_text() != job.commands:
            return False
        newest = max((self.bin / program).stat().st_mtime for program in job.programs)
        return done.stat().st_mtime > newest and all(
            self.is_done(before) and (self.folder(before) / "done").stat().st_mtime <= done.stat().st_mtime
            for before in job.after)

    def result(self, job):
        """The folder of the job's results; raises Absent or Failed."""
        if job.name not in self.ran:
            try:
                self.ran[job.name] = self._run(job)
            except (Absent, Failed) as error:
                self.ran[job.name] = error
        if isinstance(self.ran[job.name], Exception):
            raise self.ran[job.name]
        return self.ran[job.name]

    def _run(self, job):
        lacking = self.absent(job)
        if lacking:
            raise Absent(lacking)
        for before in job.after:
            self.result(before)
        folder = self.folder(job)
        if self.is_done(job):
            self.say(f"{job.name}: done before")
            return folder
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        environment = dict(os.environ, DATA=str(self.data), UNDERBRUSH_DATA=str(self.data), WORK=str(self.work),
                           SOURCE=str(self.source), BIN=str(self.bin), JOBS=str(self.work / "jobs"),
                           PYTHON=sys.executable, PYTHONDONTWRITEBYTECODE="1",
                           PATH=f"{self.bin}{os.pathsep}{os.environ['PATH']}")
        begin = time.monotonic()
        self.say(f"{job.name} ...")
        with open(folder / "log", "wb") as log:
            done = subprocess.run(["bash", "-euo", "pipefail", "-c", job.commands], cwd=folder, env=environment,
                                  stdin=subprocess.DEVNULL, stdout=log, stderr=subprocess.STDOUT, check=False)
        if done.returncode:
            last = (folder / "log").read_text(errors="replace").strip().splitlines()[-1:]
            raise Failed(f"{job.name}: exit status {done.returncode}: {' '.join(last)} ({folder / 'log'})")
        (folder / "done").write_text(job.commands)
        self.say(f"{job.name}: {time.monotonic() - begin:.0f} s")
        return folder


def read_json(path):
    return json.loads(pathlib.Path(path).read_text())


def read_rows(path):
    """The first table of a Markdown file as a list of {heading: cell}."""
    table = tables.tables(pathlib.Path(path).read_text())[0]
    return [dict(zip(table.headings, row)) for row in table.rows]


def tolerance_of(measured, table, row, column):
    """(relative, absolute) of a cell."""
    def of(tolerances):
        return max((value for words, value in tolerances.items()
                    if words == "*" or table.column(words) == column or table.row(words) == row), default=0.0)
    return of(measured.relative), of(measured.absolute)


@dataclasses.dataclass
class Verdict:
    """What came of a table."""
    compared: int = 0
    beyond: list = dataclasses.field(default_factory=list)
    skipped: list = dataclasses.field(default_factory=list)
    failed: list = dataclasses.field(default_factory=list)
    cells: dict = dataclasses.field(default_factory=dict)  # {(row, column): text} of cells that are beyond


def _compare(table, measured, cells, verdict, values):
    for row_words, column_words, numbers in cells:
        row, column = table.row(row_words), table.column(column_words)
        if row is None or column is None:
            verdict.failed.append(f"the table has no cell {row_words} | {column_words}")
            continue
        printed = tables.figures(table.cell(row, column))
        if row < 0 or column == 0:
            printed = printed[-len(numbers):] if row >= 0 else printed[:len(numbers)]
        place = table.place(row, column)
        values[row, column] = numbers
        if len(printed) != len(numbers):
            verdict.beyond.append(f"{place}: {len(printed)} figures documented, {len(numbers)} measured: "
                                  f"{', '.join(f'{number:.6g}' for number in numbers)}")
            continue
        relative, absolute = tolerance_of(measured, table, row, column)
        beyond = len(verdict.beyond)
        for figure, number in zip(printed, numbers):
            verdict.compared += 1
            allowed = figure.half_unit * (1 + 1e-6) + absolute + relative * abs(number)
            if not abs(figure.value - number) <= allowed:
                verdict.beyond.append(f"{place}: {figure.text} -> {number:.6g}")
        if row >= 0 and len(verdict.beyond) > beyond:
            verdict.cells[row, column] = tables.with_numbers(table.cell(row, column), numbers)


def judge(table, measured, runner):
    """Makes a table anew and compares it."""
    verdict, values = Verdict(), {}
    for part in measured.parts:
        try:
            folders = [runner.result(job) for job in part.jobs]
        except Absent as error:
            if str(error) not in verdict.skipped:
                verdict.skipped.append(str(error))
            continue
        except Failed as error:
            if str(error) not in verdict.failed:
                verdict.failed.append(str(error))
            continue
        _compare(table, measured, part.cells(*folders), verdict, values)
    exempt = {(table.row(words), table.column(words)) for words in measured.uncompared}
    if not verdict.skipped and not verdict.failed:
        for row, column in table.cells_with_figures():
            if (row, column) not in values and not any(row == r or column == c for r, c in exempt):
                verdict.failed.append(f"no command makes the figure in {table.place(row, column)}")

    def value_of(row, column, n):
        if (row, column) in values and n < len(values[row, column]):
            return values[row, column][n]
        printed = tables.figures(table.cell(row, column))
        if n >= len(printed):
            raise tables.Unknown(f"{table.place(row, column)} has no figure {n + 1}")
        return printed[n].value

    verdict.beyond += tables.broken_claims(table, value_of)
    return verdict
