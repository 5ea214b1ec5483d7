#!/usr/bin/env python3
"""Runs the commands of one page (--page FILE). A comment before a fenced block says how:

  <!-- run -->         this block, with bash, in one temporary folder for all blocks of the page. The PATH
                       begins with the program's folder, and $SOURCE is the repository.
  <!-- run: make -->   lines `make TARGET`: it is checked that the target exists (make -n)
  <!-- run: hidden     commands on the following lines, which the reader does not see: they put small data
                       where the blocks expect large ones. Exit status 77 skips the rest of the page. -->
  <!-- run: demo -->   the reader has run `make demo`: demo/ is that of a sensor of few beams, small.yaml. It is
                       made once for all pages (--kept FOLDER).
  <!-- no run: REASON -->   this block is not run.

Every block of sh or console carries one of these marks."""
import argparse
import fcntl
import hashlib
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

import rules

DEMO = r"""sed -e 's/^name: .*/name: small/' -e 's/^rate_hz: .*/rate_hz: 2/' \
  -e 's/^firing_period_us: .*/firing_period_us: 4000/' "$SOURCE/share/sensors/velodyne-vlp16.yaml" > small.yaml
underbrush demo -o demo --sensor small.yaml --sub-rays 1
"""
STEP = re.compile(r"<!--\s*(?P<demo>run: demo)\s*-->"
                  r"|<!--\s*(?P<hidden>run: hidden)\n(?P<commands>.*?)-->"
                  r"|(?:<!--\s*(?P<mark>run: make|run|no run:[^>]*?)\s*-->\s*)?"
                  r"^```(?:sh|console)\n(?P<block>.*?)^```", re.DOTALL | re.MULTILINE)


def steps(text):
    """Lists [(mark, script)] in order; `mark` is demo, run, make, none or unmarked."""
    out = []
    for m in STEP.finditer(text):
        if m.group("demo"):
            out.append(("demo", DEMO))
            continue
        if m.group("hidden"):
            out.append(("run", m.group("commands")))
            continue
        mark = m.group("mark") or "unmarked"
        mark = {"run: make": "make"}.get(mark, "none" if mark.startswith("no run") else mark)
        # In a console block only what follows the prompt is typed.
        typed = re.findall(r"^\$ (.*)$", m.group("block"), re.MULTILINE)
        out.append((mark, "\n".join(typed) + "\n" if typed else m.group("block")))
    return out


def run(script, folder, environment):
    return subprocess.run(["bash", "-euo", "pipefail", "-x", "-c", script], cwd=folder, env=environment, text=True,
                          stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)


def run_demo(script, folder, environment, kept):
    """Takes the demo of this program from a folder where it is kept, or makes it there."""
    program = shutil.which("underbrush", path=environment["PATH"])
    if kept is None or program is None:
        return run(script, folder, environment)
    kept.mkdir(parents=True, exist_ok=True)
    key = hashlib.sha256(script.encode() + pathlib.Path(program).read_bytes()).hexdigest()[:16]
    with open(kept / "lock", "w", encoding="utf-8") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not (kept / key).exists():
            for old in kept.glob("????????????????"):
                shutil.rmtree(old)
            new = kept / "new"
            shutil.rmtree(new, ignore_errors=True)
            new.mkdir()
            done = run(script, new, environment)
            if done.returncode:
                return done
            new.rename(kept / key)
        shutil.copytree(kept / key, folder, dirs_exist_ok=True)
    return run("true", folder, environment)


def complaints(text, source, bin_folder, page="the page", kept=None):
    found, ran = [], 0
    environment = dict(os.environ, SOURCE=str(source))
    environment["PATH"] = f"{bin_folder}{os.pathsep}{environment['PATH']}"
    for name in ("MAKEFLAGS", "MAKELEVEL", "MFLAGS"):
        environment.pop(name, None)
    with tempfile.TemporaryDirectory() as folder:
        for mark, script in steps(text):
            if mark == "unmarked":
                found.append(f"a block that nobody runs, mark it:\n{script}")
            elif mark == "make":
                for line in script.splitlines():
                    words = line.split("#")[0].split()
                    if words and (words[0] != "make" or subprocess.run(
                            ["make", "-n", *words[1:]], cwd=source, env=environment, check=False,
                            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL).returncode):
                        found.append(f"no such target: {line}")
            elif mark in ("run", "demo"):
                ran += mark == "run"
                done = (run(script, folder, environment) if mark == "run" else
                        run_demo(script, folder, environment, kept))
                if done.returncode == 77:
                    print(f"skipped: the commands of {page} from here on:\n{done.stdout}")
                    sys.exit(77)
                if done.returncode:
                    found.append(f"exit status {done.returncode}:\n{done.stdout}")
                    break
    return found if ran or found else ["nothing in it is run"]


BAD = [("```sh\ntrue\n```\n", "nobody runs"), ("<!-- run -->\n```sh\nfalse\n```\n", "exit status 1"),
       ("<!-- run -->\n```console\n$ cat missing\n```\n", "exit status 1"), ("No block.\n", "nothing"),
       ("<!-- run: make -->\n```sh\nmake no-such-target\n```\n", "no such target"),
       ("<!-- run: hidden\nexit 3\n-->\n<!-- run -->\n```sh\ntrue\n```\n", "exit status 3")]
GOOD = ("<!-- run: hidden\necho 1 > a\n-->\n<!-- run: make -->\n```sh\nmake help   # lists\n```\n"
        "<!-- run -->\n```console\n$ test -s a\nwhat it printed\n```\n")

if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("--program", required=True, type=pathlib.Path)
    parser.add_argument("--page", default=rules.ROOT / "README.md", type=pathlib.Path)
    parser.add_argument("--kept", type=pathlib.Path, help="folder in which the demo is kept for other pages")
    options = parser.parse_args()
    bin_folder = options.program.resolve().parent
    for bad, word in BAD:
        if not any(word in line for line in complaints(bad, rules.ROOT, bin_folder)):
            sys.exit(f"this check is dead: no complaint with '{word}' about\n{bad}")
    wrong = complaints(GOOD, rules.ROOT, bin_folder)
    if wrong:
        sys.exit(f"this check is wrong: {wrong}")
    lines = complaints(options.page.read_text(), rules.ROOT, bin_folder, options.page, options.kept)
    print("\n".join(lines))
    sys.exit(1 if lines else 0)
