"""The values that the verbs return beside logs and models."""
from __future__ import annotations

from typing import Any, NamedTuple

from underbrush._core import BeamLog

MOVER = 2  #: The bit of `BeamLog.flags` of a return of something that moved.


class Imported(NamedTuple):
    """A log that was read and the counts that `underbrush import --json` writes."""

    log: BeamLog
    report: dict[str, Any]


class Split(NamedTuple):
    """The two parts of a log."""

    train: BeamLog
    test: BeamLog


class Segmentation(NamedTuple):
    """A labelled log and the counts and scores that `underbrush segment --json` writes."""

    log: BeamLog  #: With the columns `class` (see `class_names`) and `instance`.
    report: dict[str, Any]


class Marked(NamedTuple):
    """A log whose movers are marked and the counts that `underbrush movers --json` writes."""

    log: BeamLog  #: With the bit `MOVER` in `flags` at the returns of what moved.
    report: dict[str, Any]


class LearntActors(NamedTuple):
    """A log whose actors are marked and the report that `underbrush actors --json` writes."""

    marked: BeamLog  #: With the bit `MOVER` in `flags` at the returns of the actors.
    report: dict[str, Any]
