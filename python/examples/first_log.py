#!/usr/bin/env python3
"""Learns a model from a log, simulates the log's beams in it and says how well that went.

    python first_log.py log.ply
"""
from __future__ import annotations

import sys

import numpy as np

import underbrush


def main(path: str) -> None:
    """Fits, simulates and scores the log at a path."""
    log = underbrush.read_log(path)
    hit = np.isfinite(log.range_m)  # a miss has the range infinity
    print(f"{len(log)} beams, {hit.mean():.0%} of them hits, {np.median(log.range_m[hit]):.1f} m away")

    model = underbrush.fit(log, fitter="hierarchical", clusters_per_point=0.1)
    print(model, underbrush.report_of(model)["warnings"])
    sigma, _ = underbrush.ellipsoid_axes(model.ellipsoids)
    print(f"ellipsoids of {np.median(sigma[:, 2]):.2f} m, hit probability {model.ellipsoids.hit_probability.mean():.2f}")

    simulated = underbrush.simulate(model, like=log, seed=1)
    score = underbrush.score(log, simulated, model=model)
    print(f"F1 {score.all.f1:.3f}, packet error {score.all.packet_error_m:.2f} m")


if __name__ == "__main__":
    main(sys.argv[1])
