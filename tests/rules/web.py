#!/usr/bin/env python3
"""Checks that web/dist, which the program carries, was built from the sources in web/: web/dist/sources.txt holds the
hash of all files that the build reads. --update writes it after `npm run build`. With --build FOLDER, where node and
the packages of web/package-lock.json are at hand (or npm can fetch them), the page is built anew and compared. The
sources import each other without circles, imports of types included."""
import hashlib
import pathlib
import re
import shutil
import subprocess
import sys

import rules

SKIPPED = 77
BUILT = ("index.html", "app.js", "app.css")


def sources(root):
    """Lists the files that the build reads, sorted."""
    fixed = ["web/index.html", "web/package.json", "web/package-lock.json", "web/tsconfig.json", "web/vite.config.ts"]
    return sorted(fixed + [p for p in rules.tracked(root) if p.startswith("web/src/")])


def hash_of(root):
    total = hashlib.sha256()
    for path in sources(root):
        if (root / path).is_file():
            total.update(path.encode() + b"\0" + (root / path).read_bytes() + b"\0")
    return total.hexdigest()


def circle(root):
    """Finds a chain of sources that ends where it begins, each of which imports the next; [] if there is none."""
    imports = {pathlib.PurePath(path).stem: re.findall(r"""from ['"]\./([\w-]+)['"]""", rules.read(root, path))
               for path in rules.tracked(root, ".ts") if path.startswith("web/src/")}
    done = set()

    def walk(name, chain):
        if name in chain:
            return [*chain[chain.index(name):], name]
        if name in done:
            return []
        found = next(filter(None, (walk(n, [*chain, name]) for n in imports.get(name, ()))), [])
        done.add(name)
        return found

    return next(filter(None, (walk(name, []) for name in sorted(imports))), [])


def check(root, options):
    dist = root / "web/dist"
    out = [f"web/dist/{name}: missing" for name in (*BUILT, "sources.txt") if not (dist / name).is_file()]
    if chain := circle(root):
        out.append(f"web/src: a circle of imports: {' -> '.join(chain)}")
    if out:
        return out
    if (dist / "sources.txt").read_text().strip() != hash_of(root):
        return ["web/dist: not built from these sources: in web/, npm ci && npm run dist"]
    script = (dist / "app.js").read_text(encoding="utf-8")
    if root == rules.ROOT and "SPDX-License-Identifier: MIT" not in script:
        out.append("web/dist/app.js: the licence of three.js is not in it")
    if root == rules.ROOT and options.build:
        out += rebuilt(root, options.build)
    return out


def rebuilt(root, build):
    """Builds the page in a folder of its own and lists the files that differ."""
    if not shutil.which("node") or not shutil.which("npm"):
        print("SKIPPED: no node: web/dist was compared with its sources by their hash only")
        return []
    folder = pathlib.Path(build, "web")
    folder.mkdir(parents=True, exist_ok=True)
    for name in ("src", "dist"):
        shutil.rmtree(folder / name, ignore_errors=True)
    for path in sources(root):
        target = folder / pathlib.PurePath(path).relative_to("web")
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(root / path, target)
    problem = packages(folder)
    if problem:
        print(f"SKIPPED: the packages cannot be fetched: {problem}")
        return []
    done = subprocess.run(["npm", "run", "build"], cwd=folder, capture_output=True, text=True, check=False)
    if done.returncode:
        return [f"web: does not build: {line}" for line in (done.stdout + done.stderr).splitlines()[-5:]]
    return [f"web/dist/{name}: another file than the build makes" for name in BUILT
            if (folder / "dist" / name).read_bytes() != (root / "web/dist" / name).read_bytes()]


def packages(folder):
    """Installs the packages of package-lock.json unless they are there; returns what failed, or None."""
    stamp, lock = folder / "installed.txt", (folder / "package-lock.json").read_text()
    if stamp.exists() and stamp.read_text() == lock:
        return None
    done = subprocess.run(["npm", "ci", "--no-audit", "--no-fund"], cwd=folder, capture_output=True, text=True,
                          check=False)
    if done.returncode:
        return (done.stderr or done.stdout).strip().splitlines()[-1]
    stamp.write_text(lock)
    return None


def arguments(parser):
    parser.add_argument("--build", type=pathlib.Path, help="build the page in this folder and compare it")


SOURCE = {"web/src/main.ts": "1;\n", "web/index.html": "<p>"}
WHOLE = {f"web/dist/{name}": "" for name in BUILT}
CIRCLE = {"web/src/a.ts": "import { type B } from './b';", "web/src/b.ts": "import {\n  x,\n} from './c';",
          "web/src/c.ts": "import type { A } from './a';"}
BAD = [({**SOURCE, "web/dist/app.js": ""}, "missing"),
       ({**SOURCE, **WHOLE, **CIRCLE, "web/dist/sources.txt": ""}, "circle of imports: a -> b -> c -> a"),
       ({**SOURCE, **WHOLE, "web/dist/sources.txt": "0" * 64}, "not built from")]

if __name__ == "__main__":
    if "--update" in sys.argv:
        (rules.ROOT / "web/dist/sources.txt").write_text(hash_of(rules.ROOT) + "\n")
        sys.exit(0)
    rules.main(check, BAD, rules.in_tree({**SOURCE, **WHOLE}, lambda r: {
        **SOURCE, **WHOLE, "web/dist/sources.txt": hash_of(r)}), arguments)
