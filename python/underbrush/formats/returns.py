"""Rows of a scan from the returns of its beams."""
from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import numpy.typing as npt


@dataclasses.dataclass(frozen=True)
class Rows:
    """Which return of which beam each row of a scan is. `values[which, beam]` takes (returns, beams) values to rows."""

    beam: npt.NDArray[np.intp] | slice
    which: npt.NDArray[np.intp] | int
    echo: npt.NDArray[np.uint8]  #: (rows,), number of the return in order of range, from 1; 0 for a miss.
    echoes: npt.NDArray[np.uint8]  #: (rows,), number of returns of the row's beam.


def rows_of(counts: npt.NDArray[Any]) -> Rows:
    """Rows of beams with (1 or 2, beams) ranges, where 0 is none.

    Both returns of a beam follow each other in order of range. Equal ranges are one row (the first return), and so is
    a miss.
    """
    if len(counts) == 1:
        hit = (counts[0] > 0).astype(np.uint8)
        return Rows(slice(None), 0, hit, hit)
    first, second = counts
    number = ((first > 0) | (second > 0)).astype(np.uint8)
    number += (first > 0) & (second > 0) & (first != second)
    beam = np.repeat(np.arange(len(number)), np.maximum(number, 1))
    again = np.zeros(len(beam), dtype=bool)
    again[1:] = beam[1:] == beam[:-1]
    echoes, far = number[beam], (second > first)[beam]
    which = np.where((echoes == 2) & ~again, ~far, far).astype(np.intp)
    return Rows(beam, which, np.minimum(echoes, 1) + again.astype(np.uint8), echoes)
