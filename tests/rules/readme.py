#!/usr/bin/env python3
"""Runs the commands of one page (--page FILE). A comment before a fenced block says how:

  <!-- run -->         this block, with bash, in one temporary folder for all blocks of the page. The PATH
                       begins with the program's folder, and $SOURCE is the repository.
  <!-- run: make -->   lines `make TARGET`: it is checked that the target exists (make -n)
  <!-- run: hidden     commands on the following lines, which the reader does not see: they put small data
                       where the blocks expect large ones. Exit status 77 skips the rest of the page. -->
  <!-- no run: REASON -->   this block is not run.

Every block of sh or console carries one of these marks."""
import argparse
import os
import pathlib
import re
import subprocess
import sys
import tempfile

import rules

STEP = re.compile(r"<!--\s*(?P<hidden>run: hidden)\n(?P<commands>.*?)-->"
                  r"|(?:<!--\s*(?P<how>run: make|run|no run:[^>]*?)\s*-->\s*)?"
                  r"^```(?:sh|console)\n(?P<block>.*?)^```", re.DOTALL | re.MULTILINE)


def steps(text):
    """Lists [(how, script)] in order; `how` is run, make, none or unmarked."""
    out = []
    for m in STEP.finditer(text):
        if m.group("hidden"):
            out.append(("run", m.group("commands")))
            continue
        how = m.group("how") or "unmarked"
        how = {"run: make": "make"}.get(how, "none" if how.startswith("no run") else how)
        # In a console block only what follows the prompt is typed.
        typed = re.findall(r"^\$ (.*)$", m.group("block"), re.MULTILINE)
        out.append((how, "\n".join(typed) + "\n" if typed else m.group("block")))
    return out


def complaints(text, source, bin_folder, page="the page"):
    found, ran = [], 0
    environment = dict(os.environ, SOURCE=str(source))
    environment["PATH"] = f"{bin_folder}{os.pathsep}{environment['PATH']}"
    for name in ("MAKEFLAGS", "MAKELEVEL", "MFLAGS"):
        environment.pop(name, None)
    with tempfile.TemporaryDirectory() as folder:
        for how, script in steps(text):
            if how == "unmarked":
                found.append(f"a block that nobody runs, mark it:\n{script}")
            elif how == "make":
                for line in script.splitlines():
                    words = line.split("#")[0].split()
                    if words and (words[0] != "make" or subprocess.run(
                            ["make", "-n", *words[1:]], cwd=source, env=environment, check=False,
                            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL).returncode):
                        found.append(f"no such target: {line}")
            elif how == "run":
                ran += 1
                done = subprocess.run(["bash", "-euo", "pipefail", "-x", "-c", script], cwd=folder,
                                      env=environment, text=True, stdin=subprocess.DEVNULL,
                                      stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
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
    options = parser.parse_args()
    bin_folder = options.program.resolve().parent
    for bad, word in BAD:
        if not any(word in line for line in complaints(bad, rules.ROOT, bin_folder)):
            sys.exit(f"this check is dead: no complaint with '{word}' about\n{bad}")
    wrong = complaints(GOOD, rules.ROOT, bin_folder)
    if wrong:
        sys.exit(f"this check is wrong: {wrong}")
    lines = complaints(options.page.read_text(), rules.ROOT, bin_folder, options.page)
    print("\n".join(lines))
    sys.exit(1 if lines else 0)
