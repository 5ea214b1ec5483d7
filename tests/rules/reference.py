#!/usr/bin/env python3
"""The pages of docs/reference that the program's tables make are what the program prints.

  reference.py --program build/bin/underbrush-reference             compares
  reference.py --program build/bin/underbrush-reference --update    writes them anew

With `--fmu build/bin/underbrush-fmu-description`, the page of the FMU's variables is among them.
"""
import argparse
import difflib
import pathlib
import subprocess
import sys
import xml.etree.ElementTree

import rules

PAGES = ("command-line", "materials", "parameters", "sensor-catalogue", "strategies")


FMU = "# Variables of the FMU\n\nThis page is made from the model description; [OSI](osi.md#the-fmu) describes the FMU.\n\n"


def printed(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def variables_page(description):
    """Returns the table of the variables of an FMU 3.0."""
    rows = [("variable", "kind", "start", "meaning"), ("---",) * 4]
    for v in xml.etree.ElementTree.fromstring(description).find("ModelVariables"):
        child = v.find("Start")
        start = v.get("start", "") if child is None else child.get("value", "")
        rows.append((f"`{v.get('name')}`", f"{v.tag} {v.get('causality')}", start if v.tag != "Binary" else "",
                     v.get("description", "")))
    return FMU + "".join("| " + " | ".join(row) + " |\n" for row in rows)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", required=True)
    parser.add_argument("--fmu")
    parser.add_argument("--update", action="store_true")
    options = parser.parse_args()
    changes = []
    pages = {name: printed(options.program, name) for name in PAGES}
    if options.fmu:
        pages["fmu-variables"] = variables_page(printed(options.fmu, "3"))
    for name, made in pages.items():
        page = pathlib.Path(rules.ROOT, "docs/reference", f"{name}.md")
        if options.update:
            page.write_text(made)
        written = page.read_text() if page.is_file() else ""
        changes += difflib.unified_diff(written.splitlines(), made.splitlines(), f"docs/reference/{name}.md",
                                        "as the program prints it", lineterm="")
    manual = printed(options.program, "man")
    if not manual.startswith(".TH underbrush 1"):
        changes.append("the manual page does not begin with .TH underbrush 1")
    if subprocess.run([options.program, "no-such-page"], capture_output=True, check=False).returncode != 2:
        changes.append("a page that is not there is not refused")
    if changes:
        sys.exit("\n".join(changes) + "\nIf that is meant: tests/rules/reference.py --program ... --update")


if __name__ == "__main__":
    main()
