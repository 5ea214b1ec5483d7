"""Packages from PyPI in a virtual environment of one script, in the versions of a file."""
import pathlib
import shutil
import subprocess
import sys
import typing


def make_venv(folder: pathlib.Path, requirements: pathlib.Path) -> typing.Optional[str]:
    """Installs the packages of `requirements` into `folder` where they are not installed yet; returns the last line of
    what failed, or None."""
    stamp = folder / "installed.txt"
    wanted = requirements.read_text(encoding="utf-8")
    if stamp.exists() and stamp.read_text(encoding="utf-8") == wanted:
        return None
    shutil.rmtree(folder, ignore_errors=True)
    for command in ([sys.executable, "-m", "venv", str(folder)],
                    [str(folder / "bin/python"), "-m", "pip", "install", "--quiet", "--disable-pip-version-check",
                     "--no-deps", "-r", str(requirements)]):
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode:
            return (done.stderr or done.stdout).strip().splitlines()[-1]
    stamp.write_text(wanted, encoding="utf-8")
    return None
