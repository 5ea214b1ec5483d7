"""A few damaged files of every kind; `mutate_formats.py` reads as many as one likes."""
from __future__ import annotations

import sys

import pytest
from mutate_formats import KINDS, run

_NEEDS = {"las": "laspy", "laz": "lazrs", "old-laz": "lazrs", "e57": "pye57", "xyz": "numpy", "npz": "numpy"}


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="needs fork and RLIMIT_AS")
@pytest.mark.parametrize("kind", list(KINDS))
def test_damaged_files_are_read_or_refused(kind: str) -> None:
    module = _NEEDS.get(kind, "rosbags")
    pytest.importorskip(module, reason=f"{module} is not installed: pip install 'underbrush[formats]'")
    results, failures = run(kind, 40, 20)
    assert failures == []
    assert sum(results.values()) == 40 and results["refused"] > 0
