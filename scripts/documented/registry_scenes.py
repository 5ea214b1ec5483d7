"""The tables of composed scenes: Table II of *Primitives*, and the ladder from a composed scene to a fit of the site."""
import statistics

from .common import HALVES, LOGS, study
from .jobs import Measured, Part, read_json

FOREST = {"options": "--data drive", "before": 'mkdir drive\nln -s "$WORK/kitti_0027_forest" drive/\n',
          "needs": (LOGS["kitti_0027_forest"],), "after": (HALVES["kitti_0027_forest"],)}
PRIMITIVES = study("primitives", **FOREST)
LADDER = study("scenes", **FOREST)
SCORES = {"cloud error, m": "cloud_error_m", "packet error, m": "packet_error_m", "informedness": "informedness",
          "F1 of misses": "f1_of_misses", "capped error, m": "capped_error_m"}


def scenes(where, group, spread):
    rows = {"primitives": ["primitives"], "meshes (generated sites": ["meshes", "meshes (true species)"],
            "meshes, not adapted": ["meshes, not adapted"],
            "meshes (other species)": ["meshes (other species)"], "fit of the test log": ["geospecific"],
            "replay": ["replay"], "always hit": ["always hit"]}

    def cells(folder):
        figures = read_json(folder / "study.json")["figures"][where]["mean"]
        for row, names in rows.items():
            s = next(figures[name] for name in names if name in figures)
            for column, key in {**SCORES, "F1": "f1"}.items():
                yield row, f"{group}: {column}", [s[key]["mean"]] + ([s[key]["reach_95"]] if spread else [])
    return cells


def ladder(where, group):
    student_t = {3: 4.303, 6: 2.571}  # of 95 % intervals, by the number of pairs

    def cells(folder):
        pairs = list(read_json(folder / "study.json")["figures"][where]["pairs"].values())
        for rung in pairs[0]:
            for column, key in SCORES.items():
                values = [pair[rung][key] for pair in pairs]
                reach = student_t[len(values)] * statistics.stdev(values) / len(values) ** 0.5
                yield rung, f"{group}: {column}", [statistics.mean(values), reach]
    return cells


MEASURED = {
    "scenes": Measured((Part((PRIMITIVES,), scenes("kitti_0027_forest", "drive", False)),
                        Part((PRIMITIVES,), scenes("generated sites", "generated", True))),
                       uncompared={"published": "figures of the paper"}),
    "ladder": Measured((Part((LADDER,), ladder("kitti_0027_forest", "drive")),
                        Part((LADDER,), ladder("generated sites", "generated")))),
}
