#!/usr/bin/env python3
"""Writes the notebooks of this folder as Jupyter's `.ipynb`, without outputs.

    python python/notebooks/make_ipynb.py build/notebooks && jupyter lab build/notebooks

They are kept as Python scripts, whose cells begin with `# %%`: these run as they are, a type checker reads them, and a
change shows as changed lines. Visual Studio Code, PyCharm and Spyder open them as notebooks too.
"""
from __future__ import annotations

import json
import pathlib
import re
import sys

HERE = pathlib.Path(__file__).resolve().parent
CELL = re.compile(r"^# %%(?P<markdown> \[markdown\])?\n(?P<text>.*?)(?=^# %%|\Z)", re.M | re.S)


def scripts() -> list[pathlib.Path]:
    """The notebooks' scripts, sorted."""
    return sorted(path for path in HERE.glob("*.py") if path.read_text(encoding="utf-8").startswith("# %%"))


def notebook_of(script: str) -> dict[str, object]:
    """The notebook (nbformat 4.5) of a script with cells."""
    cells = []
    for number, match in enumerate(CELL.finditer(script)):
        text = match["text"].strip("\n")
        cell: dict[str, object] = {"id": f"cell-{number:02d}", "metadata": {}}
        if match["markdown"]:
            text = re.sub(r"^# ?", "", text, flags=re.M)
            cell |= {"cell_type": "markdown"}
        else:
            cell |= {"cell_type": "code", "execution_count": None, "outputs": []}
        cells.append(cell | {"source": text.splitlines(keepends=True)})
    kernel = {"display_name": "Python 3", "language": "python", "name": "python3"}
    return {"cells": cells, "metadata": {"kernelspec": kernel, "language_info": {"name": "python"}}, "nbformat": 4,
            "nbformat_minor": 5}


def main(folder: pathlib.Path) -> None:
    """Writes all notebooks into a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    for script in scripts():
        text = json.dumps(notebook_of(script.read_text(encoding="utf-8")), indent=1, ensure_ascii=False)
        (folder / script.with_suffix(".ipynb").name).write_text(text + "\n", encoding="utf-8")
        print(folder / script.with_suffix(".ipynb").name)


if __name__ == "__main__":
    if len(sys.argv) != 2 or sys.argv[1].startswith("-"):
        sys.exit(__doc__)
    main(pathlib.Path(sys.argv[1]))
