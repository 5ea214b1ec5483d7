"""Progress of the verbs: the values that a caller may pass, and a bar on the terminal."""
from __future__ import annotations

import contextlib
import importlib
import importlib.util
from collections.abc import Callable, Iterator
from typing import Any

#: Receives (stage, done, total); True shows a bar if tqdm is installed.
Progress = Callable[[str, int, int], object] | bool


class _Bar:
    """A bar of tqdm for each stage."""

    def __init__(self) -> None:
        self._bar: Any = None
        self._stage = ""

    def __call__(self, stage: str, done: int, total: int) -> None:
        tqdm: Any = importlib.import_module("tqdm")
        if stage != self._stage:
            self.close()
            self._stage, self._bar = stage, tqdm.tqdm(desc=stage, leave=False)
        self._bar.total = total
        self._bar.update(done - self._bar.n)

    def close(self) -> None:
        if self._bar is not None:
            self._bar.close()


@contextlib.contextmanager
def shown(progress: Progress | None) -> Iterator[Callable[[str, int, int], object] | None]:
    if not isinstance(progress, bool):
        yield progress
    elif not progress or importlib.util.find_spec("tqdm") is None:
        yield None
    else:
        bar = _Bar()
        try:
            yield bar
        finally:
            bar.close()
