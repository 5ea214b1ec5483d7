#!/usr/bin/env python3
"""Gives the program damaged files of every kind and judges what it does.

  mutate.py --program build/bin/underbrush                        200 mutants a kind
  mutate.py --program build/bin/underbrush --kinds fit.log --first 17 --mutants 1 --keep found

A mutant may be accepted (exit 0) or refused (exit 3, one line that names the file). It fails by a crash, a hang,
another exit code, a message that is not one short printable line of our own words, more than 256 MiB of memory and
twice the size of its files, and by any output that changed or anything left behind though the run failed. Options in a --config file may be wrong usage (exit 2) or ask for more than
the limits allow. The same seed, kind and number give the same mutant."""
import argparse
import collections
import concurrent.futures
import os
import pathlib
import random
import re
import resource
import shlex
import shutil
import sys
import tempfile
import time

import kinds
import mutations
import processes
import seeds

WALL_S, CPU_S, MEMORY, FILE_SIZE = 300, 15, 4 << 30, 512 << 20  # seconds and bytes of a run
ALWAYS = ["--threads", "1", "--force"]  # Not all outputs tell who wrote them.
LONGEST = 600  # bytes of a message
CHUNK = 50  # mutants that a worker takes at once
HELD = 256 << 20  # bytes of memory that any run may hold, besides twice the size of its files
KEPT = 5  # failed mutants of them that are kept
LEAKS = re.compile(
    rb"json\.exception|\[json|nlohmann|basic_\w+|std::|yaml-cpp|bad_alloc|bad conversion|vector::|stoi|stou?l|stod|"
    rb"filesystem error|filesystem::|iostream|what\(\)|terminate|assert|Eigen|\.cpp|\.hpp|map::at|invalid node")
Failure = collections.namedtuple("Failure", "kind number reasons code message command")


def all_files(folder):
    """{path within the folder: identity} of all files; the identity changes whenever somebody writes the file."""
    found, todo = {}, [str(folder)]
    while todo:
        one = todo.pop()
        for entry in os.scandir(one):
            status = entry.stat(follow_symlinks=False)
            name = os.path.relpath(entry.path, folder)
            if entry.is_dir(follow_symlinks=False):
                found[name + "/"] = None
                todo.append(entry.path)
            else:
                found[name] = (status.st_ino, status.st_mtime_ns, status.st_size)
    return found


def top(name):
    return name.split("/")[0]


def limit_resources():
    """Limits this process and those that it starts."""
    for what, most in ((resource.RLIMIT_CORE, 0), (resource.RLIMIT_AS, MEMORY), (resource.RLIMIT_FSIZE, FILE_SIZE)):
        resource.setrlimit(what, (most, resource.getrlimit(what)[1]))


class Scratch:
    """A folder with the seeds of one kind, in which the good command has run once, so that outputs stand there."""
    def __init__(self, kind, options, folder):
        self.kind, self.options = kind, options
        self.folder, self.temporary = pathlib.Path(folder, "run"), pathlib.Path(folder, "tmp")
        self.temporary.mkdir()
        self.folder.mkdir()
        names = {top(part) for word in kind.words + [kind.file] for part in word.split(":")}
        for name in list(names):
            names.update(kinds.NEEDS.get(name, ()))
        for name in sorted(names):
            self.copy_seed(name)
        self.seed = self.path.read_bytes()
        self.size = sum(f.stat().st_size for f in self.folder.rglob("*") if f.is_file())
        words, limits = [options.program, *kind.words, *ALWAYS], (WALL_S, CPU_S)
        environment = {"TMPDIR": str(self.temporary), "PATH": os.defpath}
        self.process = processes.Started(words, self.folder, environment, limits)
        before = set(all_files(self.folder))
        code, out, err = self.process.run()
        if code != 0:
            raise SystemExit(f"mutate: {kind.name}: the good file is refused: {err.decode(errors='replace')}")
        self.outputs = {top(name) for name in set(all_files(self.folder)) - before}
        if "--resume" in kind.words:
            self.outputs.add(kind.file)  # The program goes on writing a checkpoint that it has read.
        self.made = None  # the mutant under another name
        if options.server:
            self.process = processes.Copied(words, self.folder, environment, limits, options.server)

    @property
    def path(self):
        return self.folder / self.kind.file

    def copy_seed(self, name):
        source = pathlib.Path(self.options.seeds, name)
        if source.is_dir():
            shutil.copytree(source, self.folder / name)
        elif source.exists():
            shutil.copy(source, self.folder / name)

    def put(self, number, others):
        """Writes a mutant in the place of the good file."""
        kind, rng = self.kind, random.Random(f"{self.options.seed}/{self.kind.name}/{number}")
        if self.made:
            self.made.unlink()
            self.made = None
        self.path.unlink(missing_ok=True)
        if kind.form != "name":
            self.path.write_bytes(mutations.mutate(self.seed, kind.form, rng, others))
            return
        name = mutations.mutate(self.path.name.encode(), "text", rng, [b"1000000100_5.pcd", b"0000000000.bin"])
        name = name.replace(b"/", b"").replace(b"\0", b"")[:200]
        made = pathlib.Path(os.fsdecode(os.path.join(os.fsencode(self.path.parent), name)))
        self.made = self.path if name in (b"", b".", b"..") or made.exists() else made
        self.made.write_bytes(self.seed)

    def try_mutant(self, number, others):
        """Runs a mutant. Returns its exit code, the reasons why it fails, and its message."""
        self.put(number, others)
        before = all_files(self.folder)
        code, out, err = self.process.run()
        after, left = all_files(self.folder), all_files(self.temporary)
        reasons = list(reasons_of(self.kind, code, out, err))
        if self.process.memory > HELD + 2 * self.size and not self.kind.usage:
            reasons.append(f"held {self.process.memory >> 20} MiB, of files of {self.size >> 10} KiB")
        allowed = self.outputs if code == 0 else ()
        # Who is killed leaves what the next run removes.
        changed = [name for name in set(before) | set(after)
                   if before.get(name) != after.get(name) or (name in before) != (name in after)]
        changed = sorted(name for name in changed if top(name) not in allowed and name not in allowed)
        if (changed or left) and code is not None and code >= 0:
            reasons.append("changed or left: " + ", ".join((changed + sorted(left))[:3]))
        tops = {top(name) for name in before}
        if any(top(name) not in tops for name in after) or left:
            self.clean(before, left)
        return code, reasons, err

    def clean(self, before, left):
        for name in sorted(set(all_files(self.folder)) - set(before), reverse=True):
            path = self.folder / name
            path.rmdir() if name.endswith("/") else path.unlink()
        for entry in self.temporary.iterdir() if left else ():
            shutil.rmtree(entry) if entry.is_dir() else entry.unlink()


def reasons_of(kind, code, out, err):
    """Yields what is wrong with an exit code and a message."""
    if code is None:
        if not kind.usage:
            yield f"ran longer than {WALL_S} s of time or {CPU_S} s of a processor"
        return
    if code < 0 or code > 4 or code == 1:
        yield f"ended by signal {-code}" if code < 0 else f"exit code {code}"
        return
    if code == 0:
        return
    if out:
        yield "wrote to standard output and failed"
    if not err.startswith(b"underbrush: ") or not err.endswith(b"\n") or err.count(b"\n") != 1:
        yield "not one line of ours"
    elif len(err) > LONGEST:
        yield f"a message of {len(err)} bytes"
    try:
        text = err.decode()[:-1]
        if re.search("[\x00-\x1f\x7f-\x9f\u200e\u200f\u2028-\u202e\u2066-\u2069]", text):
            yield "a control character in the message"
    except UnicodeDecodeError:
        yield "the message is not UTF-8"
    leak = LEAKS.search(err)
    if leak:
        yield f"speaks of its inside: {leak.group().decode()}"
    if code == 2 and not kind.usage:
        yield "calls a bad file wrong usage"
    if code == 4 and not kind.usage:
        yield "calls a bad file a failure of the machine"
    if code == 3 and not any(name.encode() in err for name in names_of(kind)):
        yield "does not name the file"


def names_of(kind):
    folder = os.path.dirname(kind.file)
    return [os.path.basename(kind.file), *([top(folder)] if folder else []), *kind.others]


def keep_mutant(scratch, number, reasons, err):
    """Copies the folder of a failed mutant, and writes its command beside it."""
    kept = pathlib.Path(scratch.options.keep, f"{scratch.kind.name}-{scratch.options.seed}-{number}")
    shutil.rmtree(kept, ignore_errors=True)
    shutil.copytree(scratch.folder, kept, symlinks=True)
    line = shlex.join([scratch.options.program, *scratch.kind.words, *ALWAYS])
    (kept / "COMMAND").write_text(line + "\n# " + "; ".join(reasons) + "\n# " + repr(err[:2000])[2:-1] + "\n")


def run_chunk(kind, numbers, options):
    """Runs mutants of a kind one after the other. Returns counts of exit codes and the failures."""
    others = [(pathlib.Path(options.seeds, name)).read_bytes() for name in options.splices]
    codes, failures = collections.Counter(), []
    with tempfile.TemporaryDirectory(prefix="mutate-", dir=options.scratch) as folder:
        scratch = Scratch(kind, options, folder)
        for number in numbers:
            code, reasons, err = scratch.try_mutant(number, others)
            codes["failed" if reasons else None if code and code < 0 else code] += 1
            if reasons:
                again = shlex.join([sys.argv[0], "--program", options.program, "--seed", str(options.seed), "--kinds",
                                    kind.name, "--first", str(number), "--mutants", "1", "--keep", "found"])
                failures.append(Failure(kind.name, number, reasons, code, err[:LONGEST * 2], again))
                if options.keep and len(failures) <= KEPT:
                    keep_mutant(scratch, number, reasons, err)
        scratch.process.close()
    return kind.name, codes, failures


def run_all(chosen, options):
    """Runs all mutants. Returns {kind: counts} and the failures."""
    counts, failures, done = collections.defaultdict(collections.Counter), [], 0
    end = options.first + options.mutants
    chunks = [(kind, range(at, min(at + CHUNK, end))) for at in range(options.first, end, CHUNK) for kind in chosen]
    shown = 0.0
    with concurrent.futures.ProcessPoolExecutor(options.jobs, initializer=limit_resources) as pool:
        futures = [pool.submit(run_chunk, kind, numbers, options) for kind, numbers in chunks]
        for future in concurrent.futures.as_completed(futures):
            name, codes, failed = future.result()
            counts[name] += codes
            failures += failed
            done += sum(codes.values())
            if time.monotonic() - shown > 5:
                shown = time.monotonic()
                print(f"{done} of {len(chosen) * options.mutants} mutants, {len(failures)} failed", file=sys.stderr)
    return counts, failures


COLUMNS = ((0, "accepted"), (3, "refused"), (2, "usage"), (4, "machine"), (None, "slow"), ("failed", "failed"))


def print_table(chosen, counts):
    print(f"{'kind':28} mutants " + " ".join(f"{title:>8}" for _, title in COLUMNS))
    rows = [(kind.name, counts[kind.name]) for kind in chosen]
    for name, count in rows + [(f"{len(chosen)} kinds", sum((c for _, c in rows), collections.Counter()))]:
        print(f"{name:28} {sum(count.values()):7} " + " ".join(f"{count[key]:8}" for key, _ in COLUMNS))


def print_markdown(chosen, counts):
    """Prints the table of docs/results/damaged-files.md: a row a verb."""
    print("| verb | files | mutants | " + " | ".join(title for _, title in COLUMNS) + " |")
    print("|---|---|" + "---|" * (1 + len(COLUMNS)))
    verbs, total = sorted({kind.name.split(".")[0] for kind in chosen}), collections.Counter()
    for verb in verbs + ["all"]:
        kinds_of = [kind.name.split(".")[1] for kind in chosen if verb in ("all", kind.name.split(".")[0])]
        count = total
        if verb != "all":
            count = sum((counts[f"{verb}.{name}"] for name in kinds_of), collections.Counter())
            total = total + count
        files = f"{len(kinds_of)} kinds" if verb == "all" else ", ".join(kinds_of)
        print(f"| {verb} | {files} | {sum(count.values())} | " + " | ".join(str(count[k]) for k, _ in COLUMNS) + " |")


def print_failures(failures):
    """Prints each class of failure with its first mutants."""
    classes = collections.defaultdict(list)
    for failure in sorted(failures):
        classes[failure.kind, re.sub(r"\d+", "N", failure.reasons[0])].append(failure)
    for (kind, reason), found in classes.items():
        print(f"\n{kind}: {reason} ({len(found)} mutants)")
        for failure in found[:2]:
            message = failure.message.decode("utf-8", "backslashreplace")
            print(f"  {'; '.join(failure.reasons)}\n  {message[:300]!r}\n  {failure.command}")


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", help="the program underbrush")
    parser.add_argument("--seed", type=int, default=1, help="seed of all mutations [1]")
    parser.add_argument("--mutants", type=int, default=200, help="mutants of each kind [200]")
    parser.add_argument("--first", type=int, default=0, help="number of the first mutant [0]")
    parser.add_argument("--kinds", nargs="+", default=[], metavar="NAME", help="these kinds, or groups such as fit")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="processes at once [all cores]")
    parser.add_argument("--keep", help="copy the folder of each failed mutant, with its command, into this folder")
    parser.add_argument("--anew", action="store_true", help="start the program anew for each mutant, which takes "
                        "longer, but works with sanitizers")
    parser.add_argument("--markdown", action="store_true", help="print the table of the documentation")
    parser.add_argument("--list", action="store_true", help="list the kinds")
    return parser, parser.parse_args()


def main():
    parser, options = arguments()
    chosen = [kind for kind in kinds.KINDS
              if not options.kinds or kind.name in options.kinds or kind.name.split(".")[0] in options.kinds]
    known = {name for kind in kinds.KINDS for name in (kind.name, kind.name.split(".")[0])}
    if set(options.kinds) - known:
        parser.error("no such kind: " + ", ".join(sorted(set(options.kinds) - known)))
    if options.list:
        for kind in chosen:
            print(f"{kind.name:28} {kind.file:42} underbrush {kind.command}")
        return 0
    if not options.program:
        parser.error("--program is needed")
    options.program = str(pathlib.Path(options.program).resolve())
    began = time.monotonic()
    with tempfile.TemporaryDirectory(prefix="mutate-") as options.scratch:
        options.seeds = os.path.join(options.scratch, "seeds")
        seeds.make(options.seeds, options.program)
        options.server = None if options.anew else processes.build_server(options.scratch)
        options.splices = sorted({kind.file for kind in kinds.KINDS})
        counts, failures = run_all(chosen, options)
    (print_markdown if options.markdown else print_table)(chosen, counts)
    print_failures(failures)
    print(f"\n{len(failures)} failures, {time.monotonic() - began:.0f} s")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
