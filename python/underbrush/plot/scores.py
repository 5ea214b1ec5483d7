"""Histograms and curves of scores, as the report of `underbrush score --report` shows them."""
from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from underbrush import _core
from underbrush._core import Score
from underbrush.plot._figure import KINDS, axes_or_new

_FEWEST_BEAMS = 100  # a handful of beams would set the scale of the whole plot
_LABELS = {"packet_error_m": "packet error, m", "median_range_error_m": "median range error, m",
           "cloud_error_m": "cloud error, m", "capped_error_m": "capped error, m", "recall": "recall of hits",
           "precision": "precision of hits", "f1": "F1 of hits", "recall_of_misses": "recall of misses", "density_aware_chamfer": "density-aware Chamfer distance",
           "nll_per_beam": "negative log-likelihood per beam", "crps_m": "CRPS, m"}


def _named(scores: Score | Mapping[str, Score]) -> dict[str, Score]:
    return {"": scores} if isinstance(scores, Score) else dict(scores)


def _printed(score: Score) -> dict[str, Any]:
    """The score as `underbrush score --json` prints it."""
    found: dict[str, Any] = json.loads(_core.scores_json(["score"], [score], "{}"))
    return found


def range_error_histogram(scores: Score | Mapping[str, Score], *, log: bool = False, ax: Axes | None = None) -> Axes:
    """Draws the shares of simulated minus measured range, of the beams that returned in both logs, in bins of 5 cm.

    `scores` is a score or several by name. The legend has the share beyond ±2 m; `log` makes the shares' axis
    logarithmic.
    """
    ax = axes_or_new(ax, 6.0, 3.5)
    for k, (name, score) in enumerate(_named(scores).items()):
        found = _printed(score)["range_error_histogram"]
        count = np.array(found["below_bins_above"], dtype=float)
        share = count / max(count.sum(), 1)
        edges = np.linspace(found["from_m"], found["to_m"], len(count) - 1)
        beyond = f"{share[0] + share[-1]:.1%} beyond ±{found['to_m']:g} m"
        ax.stairs(100 * share[1:-1], edges, color=KINDS[k % len(KINDS)], fill=False, linewidth=1.6,
                  label=f"{name}: {beyond}" if name else beyond)
    if log:
        ax.set_yscale("log")
    ax.set_xlabel("simulated − measured range, m")
    ax.set_ylabel("share of beams, %")
    ax.legend(frameon=False)
    return ax


def reliability(scores: Score | Mapping[str, Score], *, ax: Axes | None = None) -> Axes:
    """Draws the share of the beams that returned by the probability of a return that the model gave them.

    `scores` is a score or several by name, made with a model; a calibrated model is on the diagonal. The area of a dot
    grows with its beams. Raises `ValueError` for a score without a model.
    """
    ax = axes_or_new(ax, 4.5, 4.5)
    ax.plot([0, 1], [0, 1], color="0.6", linewidth=0.8, linestyle="--")
    for k, (name, score) in enumerate(_named(scores).items()):
        found = _printed(score).get("reliability")
        if found is None:
            raise ValueError("reliability: the score was made without a model")
        x, y, beams = (np.array([b[key] for b in found["bins"]]) for key in ("predicted", "returned", "beams"))
        error = f"calibration error {found['error']:.2%}"
        ax.plot(x, y, color=KINDS[k % len(KINDS)], linewidth=1.4, label=f"{name}: {error}" if name else error)
        ax.scatter(x, y, s=4 + 60 * beams / beams.max(), color=KINDS[k % len(KINDS)], alpha=0.8)
    ax.set_xlabel("predicted probability of a return")
    ax.set_ylabel("share that returned")
    ax.legend(frameon=False)
    return ax


def _begin_of(band: str) -> float:
    return float(band.rstrip("-").split("-")[0])


def score_by_range(scores: Score | Mapping[str, Score], value: str = "packet_error_m", *,
                   ax: Axes | None = None) -> Axes:
    """Draws a value of `Summary`, such as "packet_error_m", "f1" or "recall", by measured range.

    `scores` is a score or several by name. Bands of fewer than 100 beams are left out where others have more. Raises
    `ValueError` for a value that a summary has not.
    """
    if value not in _LABELS:
        raise ValueError(f"score_by_range: value is one of {', '.join(_LABELS)}, not '{value}'")
    named = {name: score.per_range for name, score in _named(scores).items()}
    beams = {band: max(table[band].beams for table in named.values() if band in table)
             for table in named.values() for band in table if band != "miss"}
    enough = _FEWEST_BEAMS if beams and max(beams.values()) >= _FEWEST_BEAMS else 0
    bands = sorted((band for band, n in beams.items() if n >= enough), key=_begin_of)
    ax = axes_or_new(ax, 6.0, 3.5)
    for k, (name, table) in enumerate(named.items()):
        values = [getattr(table[band], value) if band in table else np.nan for band in bands]
        ax.plot(range(len(bands)), values, marker="o", color=KINDS[k % len(KINDS)], label=name or None)
    ax.set_xticks(range(len(bands)), [f"> {b[:-1]}" if b.endswith("-") else b.replace("-", "–") for b in bands])
    ax.set_xlabel("measured range, m")
    ax.set_ylabel(_LABELS[value])
    if any(named):
        ax.legend(frameon=False)
    return ax
