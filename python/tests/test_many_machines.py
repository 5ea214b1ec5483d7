"""The script that measures jobs at scale: on a small site and small logs, all engines give the bytes of one process."""
from __future__ import annotations

import json
import os
import pathlib
import subprocess
import sys
from collections.abc import Callable
from typing import Any

import underbrush
from underbrush.cli import program

SCRIPT = pathlib.Path(__file__).parents[2] / "scripts" / "many_machines.py"


def measured(folder: pathlib.Path, *words: object) -> dict[tuple[str, str], dict[str, Any]]:
    """Runs the script, and returns its last row of each step and engine."""
    common = ["--program", program(), "--folder", folder / "work", "--json", folder / "rows.json", "--engines", "dask",
              "--workers", 2, "--pieces", 3]
    done = subprocess.run([sys.executable, SCRIPT, *map(str, [*words, *common])], env=dict(os.environ, PYTHONDONTWRITEBYTECODE="1"),
                          capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert not (folder / "work").exists()
    return {(row["what"], row["engine"]): row for row in json.loads((folder / "rows.json").read_text(encoding="utf-8"))}


def test_a_drive_through_a_composed_forest(run: Callable[..., str], tmp_path: pathlib.Path) -> None:
    (tmp_path / "plant.obj").write_text("v 0 0 0\nv 1 0 0\nv 0.5 0.5 6\nf 1 2 3\n", encoding="utf-8")
    run("meshes", tmp_path / "plant.obj", "-o", tmp_path / "plants", "--sizes", 1, "--up", "z")
    rows = measured(tmp_path, "drive", "--km2", 0.09, "--km", 0.1, 0.2, "--every", 50, "--primitives", tmp_path / "plants")
    assert rows["simulate", "one process"]["beams"] == 4 * 65536
    assert rows["simulate", "dask"]["equal"] and rows["simulate", "dask"]["tasks"] == 3
    assert "time_exponent" in rows["simulate", "one process"]


def test_copies_of_logs_become_one_world(log: underbrush.BeamLog, tmp_path: pathlib.Path) -> None:
    underbrush.write_log(tmp_path / "log.ublog", log)
    rows = measured(tmp_path, "logs", tmp_path / "log.ublog", "--logs", 1, 3, "--beams", 3000, "--places", 2, "--apart", 60)
    assert rows["fit", "one process"]["beams"] == 9000
    assert rows["fit", "dask"]["equal"] and rows["regions", "one process"]["mb"] > 0
