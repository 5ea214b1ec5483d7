#!/usr/bin/env python3
"""The steps of the Containerfile install the package of the build folder on a bare Debian."""
import os
import pathlib
import shutil
import subprocess
import unittest

import cli_test

ROOT = pathlib.Path(__file__).resolve().parents[2]


class Container(unittest.TestCase):
    """Needs root, debootstrap, a mirror of Debian, and a package (`make deb`)."""

    def test_the_steps_install_the_program(self):
        packages = list(pathlib.Path(cli_test.PROGRAM).resolve().parents[1].glob("underbrush_*.deb"))
        if len(packages) != 1:
            self.skipTest("the build folder has no package: make deb")
        if os.geteuid() or not shutil.which("debootstrap"):
            self.skipTest("a bare Debian needs root and debootstrap")
        done = subprocess.run([ROOT / "scripts" / "check_deb.sh", packages[0]], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)


if __name__ == "__main__":
    cli_test.main()
