#!/usr/bin/env python3
"""The documentation as a site: build/docs/site/index.html, readable and searchable without a server.

    scripts/build_site.py [--build build] [--no-cpp] [--site FOLDER]

mkdocs-material comes from PyPI into build/docs-venv, in the versions of docs/requirements.txt. The pages of docs/ are
joined by those that underbrush-reference prints (a target of the build) and by Doxygen's C++ reference."""
import argparse
import os
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "scripts"))
from packages import make_venv  # noqa: E402

REQUIREMENTS = ROOT / "docs/requirements.txt"
NO_VENV = 77   # exit status: the packages are not here and cannot be fetched


def build_site(venv, root, site, environment):
    """Runs mkdocs, which takes every warning for an error; returns its status and its complaints."""
    done = subprocess.run([str(venv / "bin/mkdocs"), "build", "--strict", "--config-file",
                           str(root / "mkdocs.yml"), "--site-dir", str(site)],
                          env=dict(os.environ, NO_MKDOCS_2_WARNING="1", DISABLE_MKDOCS_2_WARNING="true",
                                   PYTHONDONTWRITEBYTECODE="1", **environment),
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    return done.returncode, "\n".join(line for line in done.stdout.splitlines() if not line.startswith("INFO "))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build")
    parser.add_argument("--site", type=pathlib.Path, help="where the site goes; docs/site of the build")
    parser.add_argument("--no-cpp", action="store_true", help="leave the C++ reference out")
    options = parser.parse_args()
    build = options.build.resolve()
    if failed := make_venv(build / "docs-venv", REQUIREMENTS):
        print(f"skipped: mkdocs-material cannot be installed: {failed}")
        sys.exit(NO_VENV)
    environment = {"UNDERBRUSH_REFERENCE": str(build / "bin/underbrush-reference")}
    if not options.no_cpp:
        doxygen = subprocess.run([sys.executable, str(ROOT / "tests/rules/docs.py"), "--html", str(build / "docs")],
                                 capture_output=True, text=True, check=False)
        if doxygen.returncode:
            sys.exit(doxygen.stdout + doxygen.stderr)
        environment["UNDERBRUSH_CPP"] = str(build / "docs/html")
    site = (options.site or build / "docs/site").resolve()
    status, text = build_site(build / "docs-venv", ROOT, site, environment)
    if status:
        sys.exit(text + "\nthe site has faults, see above")
    print(f"written {site}/index.html")


if __name__ == "__main__":
    main()
