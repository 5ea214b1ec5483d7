#!/usr/bin/env python3
"""The ways of four new users: what they type is in a script of each, which is run in an empty folder.

  users_test.py --build build WAY...           in the tests' environment, with the package of the build folder
  users_test.py --installed --build build ...  with the commands of the PATH, as on a bare Debian (scripts/check_users.sh)

WAY is perception, validation, forester or browser. One that needs what is absent says so and ends with status 77.
"""
from __future__ import annotations

import argparse
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path[:0] = [str(ROOT / "python/tests"), str(ROOT / "tests/rules"), str(HERE)]

import environment  # noqa: E402
import web  # noqa: E402

FMPY = ["fmpy", "osi-python", "numpy"]  # As for the tests of the FMU.
PLOTS = (("1", "lidr_MixedConifer.laz"), ("2", "lidr_Topography.laz"))  # About 4 points a cell.
TRACES = ("20240618T122540Z_sv_370_244_20_minimal_valid_example.osi",
          "sl-1-3_smoke_20230621T111704Z_sv_350_32112_100.osi")


class Skipped(Exception):
    """Something that a way needs is absent."""


def there(*paths: pathlib.Path) -> None:
    for path in paths:
        if not path.exists():
            raise Skipped(f"{path.name} is absent" + (": set UNDERBRUSH_DATA" if "build" not in str(path) else ""))


def validation(given: argparse.Namespace, variables: dict[str, str]) -> None:
    traces = [given.data / "osi" / name for name in TRACES]
    there(given.build / "underbrush.fmu", *traces)
    variables |= {"FMU": str(given.build / "underbrush.fmu"), "TRACES": " ".join(map(str, traces))}


def forester(given: argparse.Namespace, variables: dict[str, str]) -> None:
    there(*(given.data / "trees_laz" / name for _, name in PLOTS))
    variables["PLOTS"] = " ".join(f"{cell}={given.data / 'trees_laz' / name}" for cell, name in PLOTS)


def browser(given: argparse.Namespace, variables: dict[str, str]) -> None:
    for tool in ("node", "npm", "chromium"):
        if not shutil.which(tool):
            raise Skipped(f"no {tool}")
    folder = given.build / "web"
    folder.mkdir(parents=True, exist_ok=True)
    for name in ("package.json", "package-lock.json"):
        shutil.copyfile(ROOT / "web" / name, folder / name)
    problem = web.packages(folder)
    if problem:
        raise Skipped(f"the packages cannot be fetched: {problem}")
    variables |= {"SOURCE": str(ROOT), "PAGES": str(folder)}


#: What each way needs, given as variables of its script.
WAYS = {"perception": lambda *_: None, "validation": validation, "forester": forester, "browser": browser}


def commands(way: str, given: argparse.Namespace, folder: pathlib.Path) -> dict[str, str]:
    """Variables with which a shell finds `underbrush` and `python3` of the build folder."""
    if way == "validation":
        python = environment.environment(given.build / "fmu_venv", FMPY, compiled=False)
    else:
        python = environment.of_tests(given.build)
    program = given.build / "bin/underbrush"
    command = f'"{program}"' if way == "validation" else f'"{python}" -m underbrush.cli'
    bin_folder = folder / "bin"
    bin_folder.mkdir()
    for name, words in (("underbrush", command), ("python3", f'"{python}"')):
        (bin_folder / name).write_text(f'#!/bin/sh\nexec {words} "$@"\n', encoding="utf-8")
        (bin_folder / name).chmod(0o755)
    return {"PATH": f"{bin_folder}{os.pathsep}{os.environ['PATH']}", "PYTHONPATH": str(given.build / "python/package")}


def walk(way: str, given: argparse.Namespace) -> int:
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        variables = {} if given.installed else commands(way, given, folder)
        variables["XDG_CACHE_HOME"] = str(folder / "cache")
        WAYS[way](given, variables)
        (folder / "work").mkdir()
        began = time.monotonic()
        code = subprocess.run(["bash", HERE / f"{way}.sh"], cwd=folder / "work", env={**os.environ, **variables},
                              check=False).returncode
        print(f"{way}: {'passed' if code == 0 else f'failed with {code}'} after {time.monotonic() - began:.0f} s",
              flush=True)
        return code


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", required=True, type=pathlib.Path)
    parser.add_argument("--installed", action="store_true")
    parser.add_argument("--data", type=pathlib.Path,
                        default=pathlib.Path(os.environ.get("UNDERBRUSH_DATA") or ROOT.parent / "shared/data"))
    parser.add_argument("ways", metavar="WAY", nargs="*", help=", ".join(WAYS))
    given = parser.parse_args()
    given.build, given.data = given.build.resolve(), given.data.resolve()
    codes = []
    for way in given.ways or WAYS:
        try:
            codes.append(walk(way, given))
        except (Skipped, environment.Missing) as missing:
            print(f"{way}: SKIPPED: {missing}", flush=True)
            codes.append(77)
    return max((code for code in codes if code != 77), default=0) or (77 if set(codes) == {77} else 0)


if __name__ == "__main__":
    sys.exit(main())
