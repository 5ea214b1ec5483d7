"""Runs a command within bounds of time and memory, and says what came of it."""
import collections
import dataclasses
import os
import pathlib
import re
import resource
import subprocess

WALL_S, MEMORY = 60, 2 << 30
ANSWER, REFUSAL = "answer", "refusal"
PROGRESS = re.compile(r"^(\[ *[0-9.]+ s\] .*|note: .*|warning: .*)\n", re.MULTILINE)


@dataclasses.dataclass
class Done:
    """A run that has ended: `code` is None where it was still running after a minute."""
    code: int | None
    out: str
    err: str


@dataclasses.dataclass
class Table:
    """What came of each attack."""
    counts: dict = dataclasses.field(default_factory=dict)
    wrong: list = dataclasses.field(default_factory=list)

    def add(self, attack, outcome, what="", count=1):
        """Counts an answer or a refusal; any other outcome is wrong, and is kept with the words of the run."""
        good = outcome in (ANSWER, REFUSAL)
        self.counts.setdefault(attack, collections.Counter())[outcome if good else "wrong"] += count
        if not good:
            self.wrong.append(f"{attack}: {what}: {outcome}")

    def print(self):
        print("| attack | runs | answers | refusals | wrong |\n|---|---:|---:|---:|---:|")
        for attack, of in self.counts.items():
            print(f"| {attack} | {of.total()} | {of[ANSWER]} | {of[REFUSAL]} | {of['wrong']} |", flush=True)


def limit():
    """Limits the memory of this process; called in the child."""
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def start(words, folder, **more):
    """Starts a command whose output is not shown."""
    return subprocess.Popen([str(word) for word in words], cwd=folder, stdin=subprocess.DEVNULL,
                            stdout=subprocess.PIPE, stderr=subprocess.PIPE, preexec_fn=limit, **more)


def end(process, seconds=WALL_S):
    """Waits for it, and kills it where it takes too long."""
    try:
        out, err = process.communicate(timeout=seconds)
        code = process.returncode
    except subprocess.TimeoutExpired:
        process.kill()
        out, err = process.communicate()
        code = None
    return Done(code, out.decode(errors="replace"), PROGRESS.sub("", err.decode(errors="replace")))


def run(words, folder, **more):
    return end(start(words, folder, **more))


def judged(done, codes=(2, 3, 4)):
    """ANSWER, REFUSAL (one line and one of the codes), or what is wrong with the run."""
    lines = done.err.splitlines()
    if done.code is None:
        return f"no answer within {WALL_S} s"
    if done.code < 0:
        return f"signal {-done.code}"
    if done.code == 0:
        return ANSWER
    if len(lines) != 1 or not lines[0].startswith("underbrush: "):
        return f"exit code {done.code} and {len(lines)} lines: {done.err[:300]!r}"
    if "bad_alloc" in done.err:
        return "words of a library: " + lines[0]
    return REFUSAL if done.code in codes else f"exit code {done.code}: {lines[0]}"


def contents(path):
    """{name: bytes} of a file or of all files of a folder; empty where nothing stands there."""
    path = pathlib.Path(path)
    if path.is_file():
        return {"": path.read_bytes()}
    return {str(one.relative_to(path)): one.read_bytes() for one in sorted(path.rglob("*")) if one.is_file()}


def names(folder):
    """The names of all that is in a folder, below it too."""
    return {os.path.relpath(os.path.join(at, name), folder)
            for at, folders, files in os.walk(folder) for name in folders + files}
