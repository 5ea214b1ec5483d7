#!/usr/bin/env python3
"""Holds the score of a list of objects: the car ahead is found, near its place, and nothing else is.

  check_objects.py SCORE.json
"""
from __future__ import annotations

import json
import pathlib
import sys

(score,) = json.loads(pathlib.Path(sys.argv[1]).read_text(encoding="utf-8"))["against_real"].values()
if score["detection_rate"] < 0.85 or score["position_mean_m"] > 0.5 or score["unmatched"] > 0:
    sys.exit(f"check_objects: found {score['detection_rate']:.0%} of the objects, {score['position_mean_m']:.2f} m from "
             f"their places, and {score['unmatched']} that are none")
