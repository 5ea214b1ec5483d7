"""The notebooks run, and become files that Jupyter opens."""
from __future__ import annotations

import importlib
import pathlib
import runpy
import subprocess
import sys
import tempfile
from typing import Any

import pytest

FOLDER = pathlib.Path(__file__).resolve().parents[1] / "notebooks"
_NEEDS = {"compare_simulators": ("rosbags",), "compose_forest": ("laspy",)}


def scripts() -> list[pathlib.Path]:
    """The notebooks."""
    return sorted(path for path in FOLDER.glob("*.py") if path.read_text(encoding="utf-8").startswith("# %%"))


@pytest.mark.parametrize("script", scripts(), ids=lambda path: path.stem)
def test_notebook_runs(script: pathlib.Path, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for module in ("matplotlib", *_NEEDS.get(script.stem, ())):
        pytest.importorskip(module, reason=f"{module} is not installed: pip install 'underbrush[formats,plot]'")
    importlib.import_module("matplotlib").use("Agg")
    pyplot: Any = importlib.import_module("matplotlib.pyplot")
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    runpy.run_path(str(script), run_name="__main__")
    figures = [pyplot.figure(number) for number in pyplot.get_fignums()]
    for figure in figures:
        figure.canvas.draw()
    pyplot.close("all")
    assert figures


def test_notebooks_for_jupyter(tmp_path: pathlib.Path) -> None:
    subprocess.run([sys.executable, str(FOLDER / "make_ipynb.py"), str(tmp_path)], check=True, capture_output=True)
    sys.path.insert(0, str(FOLDER))
    try:
        made: Any = importlib.import_module("make_ipynb")
    finally:
        sys.path.pop(0)
    assert len(list(tmp_path.glob("*.ipynb"))) == len(scripts()) == 4
    for script in scripts():
        notebook = made.notebook_of(script.read_text(encoding="utf-8"))
        code = "\n".join("".join(cell["source"]) for cell in notebook["cells"] if cell["cell_type"] == "code")
        compile(code, script.name, "exec")
        text = script.read_text(encoding="utf-8")
        assert sum(not line.startswith("#") for line in code.splitlines() if line) == sum(
            not line.startswith("#") for line in text.splitlines() if line)  # no line of code is lost
        assert not any(cell.get("outputs") for cell in notebook["cells"])
        assert notebook["cells"][0]["cell_type"] == "markdown" and notebook["cells"][0]["source"][0].startswith("# ")
