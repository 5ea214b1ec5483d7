#!/usr/bin/env python3
"""The pages of docs/reference that the program's tables make are what the program prints.

  reference.py --program build/bin/underbrush-reference             compares
  reference.py --program build/bin/underbrush-reference --update    writes them anew
"""
import argparse
import difflib
import pathlib
import subprocess
import sys

import rules

PAGES = ("command-line", "materials", "parameters", "sensor-catalogue")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", required=True)
    parser.add_argument("--update", action="store_true")
    options = parser.parse_args()
    changes = []
    for name in PAGES:
        page = pathlib.Path(rules.ROOT, "docs/reference", f"{name}.md")
        made = subprocess.run([options.program, name], check=True, capture_output=True, text=True).stdout
        if options.update:
            page.write_text(made)
        written = page.read_text() if page.is_file() else ""
        changes += difflib.unified_diff(written.splitlines(), made.splitlines(), f"docs/reference/{name}.md",
                                        "as the program prints it", lineterm="")
    manual = subprocess.run([options.program, "man"], check=True, capture_output=True, text=True).stdout
    if not manual.startswith(".TH underbrush 1"):
        changes.append("the manual page does not begin with .TH underbrush 1")
    if subprocess.run([options.program, "no-such-page"], capture_output=True, check=False).returncode != 2:
        changes.append("a page that is not there is not refused")
    if changes:
        sys.exit("\n".join(changes) + "\nIf that is meant: tests/rules/reference.py --program ... --update")


if __name__ == "__main__":
    main()
