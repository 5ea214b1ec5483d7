"""Functions that the rule checks share. A check is a function from a tree of files to a list of complaints. It has
bad examples, and must complain about each of them before it judges the repository."""
import argparse
import os
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]


def tracked(root, *suffixes):
    """Lists the files of the tree (relative, sorted): those known to git in a checkout, else all."""
    if (root / ".git").exists():
        git = ["git", "-c", "safe.directory=*", "-C", str(root), "ls-files", "-z"]
        files = subprocess.run(git + ["--cached", "--others", "--exclude-standard"],
                               check=True, capture_output=True, text=True).stdout.split("\0")
    else:
        files = [str(p.relative_to(root)) for p in root.rglob("*") if p.is_file()]
        files = [f for f in files if not re.match(r"(build|install|demo|\.git)[^/]*/", f)]
    wanted = [f for f in files if f and (not suffixes or f.endswith(suffixes))]
    return sorted(f for f in set(wanted) if (root / f).is_file())


def read(root, path):
    return (root / path).read_text(encoding="utf-8")


_TOKEN = re.compile(r'//[^\n]*|/\*.*?\*/|R"(\w*)\(.*?\)\1"|"(?:\\.|[^"\\\n])*"|' + r"'(?:\\.|[^'\\\n])'",
                    re.DOTALL)


def split_cpp(text):
    """Divides C++ text into (code, comments) and keeps line numbers: in `code` comments and strings are blank, except
    the file name of an #include; in `comments` all but comments is blank."""
    def blank(s):
        return re.sub(r"[^\n]", " ", s)

    code, comments, at = [], [], 0
    for m in _TOKEN.finditer(text):
        before = text[at:m.start()]
        is_comment = m.group().startswith(("//", "/*"))
        is_include = re.search(r"#\s*include\s*$", before.rsplit("\n", 1)[-1])
        code += [before, m.group() if is_include else blank(m.group())]
        comments += [blank(before), m.group() if is_comment else blank(m.group())]
        at = m.end()
    return "".join(code + [text[at:]]), "".join(comments + [blank(text[at:])])


def lines_with(pattern, text):
    """Yields (line number, match) of every match."""
    for m in re.compile(pattern, re.MULTILINE).finditer(text):
        yield text.count("\n", 0, m.start()) + 1, m


def in_tree(files, act):
    """Calls `act(folder)` on a temporary tree of {path: text}."""
    with tempfile.TemporaryDirectory() as folder:
        for path, text in files.items():
            target = pathlib.Path(folder, path)
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_text(text, encoding="utf-8")
        return act(pathlib.Path(folder))


def run_in_parallel(commands):
    """Runs [(name, command)] on all cores and lists (name, output) of those that failed, in order."""
    from concurrent.futures import ThreadPoolExecutor

    def one(item):
        done = subprocess.run(item[1], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        return item[0], done.returncode, done.stdout

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        return [(name, out) for name, code, out in pool.map(one, commands) if code]


def compile_database(build):
    import json
    return json.loads(pathlib.Path(build, "compile_commands.json").read_text())


def main(check, bad=(), good=None, arguments=None):
    """Runs the check. `bad`: pairs ({path: text}, word that the complaint must contain); `good`: a tree
    without complaints. `arguments(parser)` may add options; `check` then takes (root, options)."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--root", type=pathlib.Path, default=ROOT)
    if arguments:
        arguments(parser)
    options = parser.parse_args()

    def complaints(root):
        return check(root, options) if arguments else check(root)

    for files, word in bad:
        found = in_tree(files, complaints)
        if not any(word in line for line in found):
            sys.exit(f"this check is dead: no complaint with '{word}' about {sorted(files)}: {found}")
    if good is not None:
        found = in_tree(good, complaints)
        if found:
            sys.exit(f"this check is wrong: it complains about a good example: {found}")
    found = complaints(options.root)
    for line in found:
        print(line)
    sys.exit(1 if found else 0)
