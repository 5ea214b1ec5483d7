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
    """Rows of beams with (returns, beams) ranges of an unsigned type, where 0 is none.

    The returns of a beam follow each other in order of range. Equal ranges are one row (the first return), and so is
    a miss.
    """
    if len(counts) == 1:
        hit = (counts[0] > 0).astype(np.uint8)
        return Rows(slice(None), 0, hit, hit)
    order = np.argsort(counts - counts.dtype.type(1), axis=0, kind="stable")  # 0 becomes the greatest number: last.
    near_to_far = np.take_along_axis(counts, order, axis=0)
    kept = near_to_far > 0
    kept[1:] &= near_to_far[1:] != near_to_far[:-1]
    number = kept.sum(axis=0, dtype=np.uint8)
    echo = np.cumsum(kept, axis=0, dtype=np.uint8)
    kept[0] |= number == 0
    beam, place = np.nonzero(kept.T)
    return Rows(beam, order[place, beam], echo[place, beam], number[beam])
