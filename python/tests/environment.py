#!/usr/bin/env python3
"""Runs the package's tests in virtual environments under the build folder, whose packages pip fetches by name.

    environment.py maker --build build   makes the environment that builds the module, and prints its Python
    environment.py tests --build build   runs python/tests on the module of the build folder
    environment.py wheel --build build   packs a wheel of it, installs that into a fresh environment and runs there the
                                         Python lines of README.md and the guide, without a compiler on the PATH
"""
from __future__ import annotations

import argparse
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import venv

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGES = ("README.md", "docs/how-to/python.md")


def environment(folder: pathlib.Path, packages: list[str]) -> pathlib.Path:
    """Makes a virtual environment unless it stands there, installs packages, and returns its Python."""
    python = folder / "bin" / "python"
    if not python.exists():
        venv.create(folder, with_pip=True)
    subprocess.run([python, "-m", "pip", "install", "-q", "--disable-pip-version-check", *packages], check=True)
    return python


def extra(name: str) -> list[str]:
    """The packages of an extra in pyproject.toml."""
    found = re.search(rf"^{name} = \[(.*?)\]", (ROOT / "pyproject.toml").read_text(encoding="utf-8"), re.M | re.S)
    assert found, name
    return re.findall(r'"([^"]+)"', found.group(1))


def run_tests(build: pathlib.Path, words: list[str]) -> int:
    """Runs pytest on the module of the build folder."""
    python = environment(build / "python" / "venv", ["numpy", "nanobind-backend", *extra("test")])
    paths = os.pathsep.join(filter(None, [str(build / "python" / "package"), os.environ.get("PYTHONPATH")]))
    tests = str(ROOT / "python" / "tests")
    return subprocess.run([python, "-m", "pytest", "-q", "-p", "no:cacheprovider", tests, *words],
                          env=dict(os.environ, PYTHONPATH=paths), cwd=build, check=False).returncode


def python_lines(page: pathlib.Path) -> str:
    """The lines of the page's blocks of Python that are run: those after a comment <!-- run: python -->."""
    return "\n".join(re.findall(r"<!-- run: python -->\n```python\n(.*?)^```", page.read_text(encoding="utf-8"),
                                re.M | re.S))


def maker_in(build: pathlib.Path) -> pathlib.Path:
    """The environment with what builds the module and packs the wheel."""
    return environment(build / "python" / "maker", ["scikit-build-core", "nanobind", "nanobind-backend", "numpy"])


def run_wheel(build: pathlib.Path) -> int:
    """Packs the wheel, installs it alone, and runs the pages' lines."""
    maker = maker_in(build)
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        subprocess.run([maker, "-m", "pip", "wheel", "-q", "--no-deps", "--no-build-isolation", "-w", folder, str(ROOT),
                        f"-Ccmake.define.UNDERBRUSH_PYTHON_FROM={build.resolve()}",
                        f"-Cbuild-dir={folder / 'pack'}"], check=True,
                       env=dict(os.environ, PATH=f"{maker.parent}{os.pathsep}{os.environ['PATH']}"))
        wheel = next(folder.glob("*.whl"))
        python = environment(folder / "bare", [str(wheel)])
        work = folder / "work"
        work.mkdir()
        tools = folder / "tools"  # all that the lines may call besides the package's own command
        tools.mkdir()
        (tools / "env").symlink_to(shutil.which("env") or "/usr/bin/env")
        clean = {"PATH": f"{python.parent}{os.pathsep}{tools}", "HOME": str(work), "TMPDIR": str(work)}
        subprocess.run([python, ROOT / "python" / "tests" / "small_log.py", work / "log.ply"], check=True, cwd=work,
                       env=clean)
        subprocess.run(["underbrush", "info", "log.ply"], check=True, cwd=work, env=clean, stdout=subprocess.DEVNULL)
        for page in PAGES:
            lines = python_lines(ROOT / page)
            if not lines:
                print(f"{page}: no line of Python is run")
                return 1
            done = subprocess.run([python, "-c", lines], cwd=work, env=clean, check=False)
            if done.returncode:
                print(f"{page}: its lines of Python fail")
                return 1
        print(f"{wheel.name}: {wheel.stat().st_size / 1e6:.1f} MB, installed and run")
    return 0


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=["maker", "tests", "wheel"])
    parser.add_argument("--build", required=True, type=pathlib.Path)
    parser.add_argument("words", nargs="*", help="words for pytest")
    given = parser.parse_args()
    if given.what == "maker":
        print(maker_in(given.build))
        sys.exit(0)
    sys.exit(run_tests(given.build, given.words) if given.what == "tests" else run_wheel(given.build))
