#!/usr/bin/env python3
"""Collects the licences of what a wheel holds beside Underbrush, a file for each Debian package.

    collect_licenses.py --library _core.abi3.so --library underbrush --header libeigen3-dev --python nanobind --output F

`--library` is a file whose shared libraries a repaired wheel bundles, as the dynamic linker finds them; `--header` a
package whose headers are compiled in; `--python` a Python package whose sources are. The texts are those of
`/usr/share/doc/PACKAGE/copyright`, with the common licences to which they refer at their end. Without dpkg nothing is
collected, and one line says so: such a wheel is for the machine that built it.
"""
from __future__ import annotations

import argparse
import importlib.metadata
import pathlib
import re
import shutil
import subprocess
import sys

#: Libraries that every Linux has, which no wheel bundles (manylinux policy), and the kernel's.
SYSTEM = re.compile(r"^(linux-vdso|ld-linux.*|lib(c|m|dl|rt|pthread|stdc\+\+|gcc_s))\.so")
DOCS = pathlib.Path("/usr/share/doc")
COMMON = re.compile(r"/usr/share/common-licenses/([A-Za-z0-9.+-]*[A-Za-z0-9])")


def libraries_of(file: pathlib.Path) -> dict[str, pathlib.Path]:
    """The shared libraries that a file needs, by name, without the system's. Raises `ValueError` for a lost one."""
    listed = subprocess.run(["ldd", str(file)], check=True, capture_output=True, text=True).stdout
    found = {}
    for line in listed.splitlines():
        name, _, place = line.strip().partition(" => ")
        if not place or SYSTEM.match(name):
            continue
        if place.startswith("not found"):
            raise ValueError(f"{file}: {name} is not found")
        found[name] = pathlib.Path(place.split(" (")[0])
    return found


def package_of(library: pathlib.Path) -> str:
    """The Debian package of a file. Raises `ValueError` where there is none."""
    # dpkg knows either the path below /lib or that below /usr/lib, which are one folder.
    for path in (library, library.resolve(), pathlib.Path("/usr") / library.relative_to("/")):
        asked = subprocess.run(["dpkg-query", "-S", str(path)], check=False, capture_output=True, text=True)
        if asked.returncode == 0:
            return asked.stdout.split(":")[0]
    raise ValueError(f"{library}: of no Debian package")


def text_of(package: str) -> str:
    """The copyright file of a package with the common licences that it names. Raises `OSError`."""
    text = (DOCS / package / "copyright").read_text(encoding="utf-8", errors="replace")
    for name in sorted(set(COMMON.findall(text))):
        common = pathlib.Path("/usr/share/common-licenses") / name
        if common.exists():
            text += f"\n\n---- {name} ----\n\n" + common.read_text(encoding="utf-8", errors="replace")
    return text


def text_of_python(name: str) -> str:
    """The licence files of an installed Python package. Raises `ValueError` where it has none."""
    files = [file for file in importlib.metadata.files(name) or []
             if re.search(r"\.dist-info/(licenses/.*|LICEN[CS]E.*)$", str(file))]
    if not files:
        raise ValueError(f"{name}: no licence in its package")
    return "\n".join(file.read_text(encoding="utf-8") for file in files)


def main() -> int:
    """Writes the files and returns the exit code."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--library", action="append", default=[], type=pathlib.Path)
    parser.add_argument("--header", action="append", default=[])
    parser.add_argument("--python", action="append", default=[])
    parser.add_argument("--output", required=True, type=pathlib.Path)
    options = parser.parse_args()
    shutil.rmtree(options.output, ignore_errors=True)
    options.output.mkdir(parents=True)
    texts = {name: text_of_python(name) for name in options.python}
    if shutil.which("dpkg-query"):
        packages = {package_of(path) for file in options.library for path in libraries_of(file).values()}
        texts |= {package: text_of(package) for package in sorted(packages | set(options.header))}
    else:
        print("collect_licenses: not a Debian system, so the wheel lacks the licences of its libraries")
    for name, text in texts.items():
        (options.output / f"{name}.txt").write_text(text, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
