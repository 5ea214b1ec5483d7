#!/usr/bin/env python3
"""Opens each kind of file in Chromium and uses the page: browser.mjs has the steps. Skips (77) where Chromium, node or
the packages of web/package-lock.json are missing."""
import argparse
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

TESTS = pathlib.Path(__file__).resolve().parents[1]
sys.path[:0] = [str(TESTS / "cli"), str(TESTS / "rules")]

import cli_test  # noqa: E402
import serving  # noqa: E402
import web  # noqa: E402

SKIPPED = 77


def packages(build):
    """Fetches the packages into the build folder; returns the folder, or ends the test as skipped."""
    folder = pathlib.Path(build, "web")
    folder.mkdir(parents=True, exist_ok=True)
    for name in ("package.json", "package-lock.json"):
        shutil.copyfile(TESTS.parent / "web" / name, folder / name)
    problem = web.packages(folder)
    if problem:
        print(f"SKIPPED: the packages cannot be fetched: {problem}")
        sys.exit(SKIPPED)
    return folder


def animate(folder, data, pictures):
    """Makes the pictures of the docs of a real scan, every other column of it, and a model of the rest."""
    forest = TESTS.parent / "share/examples/marv_forest.pcd"
    for words in (("import", forest, "--unknown-below-deg", "-13", "-o", "whole.ply"),
                  ("segment", "whole.ply", "-o", "labelled.ply"),
                  ("split", "labelled.ply", "--columns", "16", "--train", "rest.ply", "--test", "forest.ply"),
                  ("fit", "rest.ply", "-o", "model")):
        done = cli_test.call(*words, cwd=data)
        assert done.returncode == 0, done.stderr
    pictures.mkdir(parents=True, exist_ok=True)
    words = ["node", str(TESTS / "web/animate.mjs"), str(folder), shutil.which("chromium"), str(pictures)]
    return subprocess.run(words, env=dict(os.environ, PROGRAM=cli_test.PROGRAM, FOLDER=data), timeout=800,
                          check=False).returncode


def speed(folder, data, log):
    """Measures the page with a log, whose octree is not there at first and is the second time."""
    for _ in range(2):
        server = serving.Server(data, log.resolve())
        try:
            words = ["node", str(TESTS / "web/speed.mjs"), str(folder), shutil.which("chromium"), server.address]
            done = subprocess.run(words, timeout=800, check=False)
        finally:
            server.end()
        if done.returncode != 0:
            break
    return done.returncode


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--program", required=True, type=pathlib.Path)
    parser.add_argument("--build", required=True, type=pathlib.Path)
    parser.add_argument("--pictures", type=pathlib.Path, help="keep the pictures in this folder")
    parser.add_argument("--animate", type=pathlib.Path, help="only make the pictures of the docs in this folder")
    parser.add_argument("--speed", type=pathlib.Path, help="only measure the page with this log")
    parser.add_argument("--update", action="store_true", help="keep the pictures of references/ anew")
    parser.add_argument("--only", default="", help="'labels': only the steps of labels.mjs and "
                        "actors.mjs; 'actors': only those of actors.mjs; 'library': only those of library.mjs")
    options = parser.parse_args()
    cli_test.PROGRAM = str(options.program.resolve())
    for tool in ("node", "npm", "chromium"):
        if not shutil.which(tool):
            print(f"SKIPPED: no {tool}: the page was not opened")
            sys.exit(SKIPPED)
    folder = packages(options.build.resolve())
    with tempfile.TemporaryDirectory() as data:
        if options.animate:
            sys.exit(animate(folder, data, options.animate.resolve()))
        if options.speed:
            sys.exit(speed(folder, data, options.speed))
        serving.make_files(data)
        forest = TESTS.parent / "share/examples/marv_forest.pcd"
        for words in (("import", forest, "-o", "whole.ply"),
                      ("split", "whole.ply", "--columns", "16", "--train", "rest.ply", "--test", "forest.ply"),
                      ("actors", *cli_test.JOBS["actors"])):
            assert cli_test.call(*words, cwd=data).returncode == 0
        info = json.loads(cli_test.call("info", "log.ply", "--json", "-", cwd=data).stdout)
        server = serving.Server(data, "log.ply", "model", "primitives", "scene", "score.json")
        try:
            words = ["node", str(TESTS / "web/browser.mjs"), str(folder), shutil.which("chromium"), server.address]
            words += [str(options.pictures.resolve())] if options.pictures else []
            facts = {"RETURNS": str(info["hits"]), "PROGRAM": cli_test.PROGRAM, "FOLDER": data, "ONLY": options.only,
                     "UPDATE": "1" if options.update else ""}
            done = subprocess.run(words, env=dict(os.environ, **facts), timeout=800, check=False)
        finally:
            server.end()
    sys.exit(done.returncode)


if __name__ == "__main__":
    main()
