#!/usr/bin/env python3
"""Checks the length of files: headers up to 200 lines, sources up to 400. Longer ones are listed, and the test
fails at 1.5 times these limits. The first page of results has at most 150 lines. A room, which is a folder with all
below it, has a limit of its own: what grows beyond it is moved to where it belongs, or deleted."""
import rules

RESULTS = "docs/results.md", 150
LIMITS = {".hpp": 200, ".inl": 400, ".cpp": 400, ".py": 400, ".ts": 400}
# The most lines of C++, Python and TypeScript of each room: a limit is raised only together with a feature
# that users get, and in the same commit.
ROOMS = {
    "apps": 5935, "apps/fmu": 1800, "apps/underbrush": 4400, "bench": 3570, "cli": 1700, "python/src": 3780, "python/underbrush":
    10390, "report": 2900, "studies": 9550, "web/src": 7790, "src/underbrush/actors": 1480,
    "src/underbrush/calibrate": 2465,
    "src/underbrush/cluster": 1710, "src/underbrush/compact": 1900, "src/underbrush/core": 2930, "src/underbrush/credit": 1100,
    "src/underbrush/elements": 2615, "src/underbrush/fit": 2405, "src/underbrush/ground": 2000, "src/underbrush/io":
    9345, "src/underbrush/jobs": 2025, "src/underbrush/keyframes": 2095, "src/underbrush/library": 500, "src/underbrush/likelihood": 2200, "src/underbrush/live": 1150, "src/underbrush/metrics": 3145,
    "src/underbrush/movers": 700, "src/underbrush/optimize": 700, "src/underbrush/osi": 5170,
    "src/underbrush/perception": 5645, "src/underbrush/pipeline": 7200, "src/underbrush/plant_meshes": 260, "src/underbrush/primitives": 3715,
    "src/underbrush/radiometry": 2300, "src/underbrush/rasters": 600, "src/underbrush/regions": 1410, "src/underbrush/sensor": 3520, "src/underbrush/serve": 7280,
    "src/underbrush/simulate": 2900, "src/underbrush/sites": 1850, "src/underbrush/surface": 1100, "src/underbrush/test_site": 1900,
    "src/underbrush/trace": 5935, "src/underbrush/update": 1200, "src/underbrush/worlds": 2050,
}
CODE = (".hpp", ".h", ".inl", ".cpp", ".py", ".ts")


def lines_of(root, room):
    """The lines of the room's sources."""
    return sum(rules.read(root, path).count("\n") for path in rules.tracked(root, *CODE) if path.startswith(room + "/"))


def check(root):
    out = []
    for path in rules.tracked(root, *LIMITS):
        limit = next(n for suffix, n in LIMITS.items() if path.endswith(suffix))
        lines = rules.read(root, path).count("\n")
        if lines > 1.5 * limit:
            out.append(f"{path}: {lines} lines, {limit} are enough: split it")
        elif lines > limit:
            print(f"{path}: {lines} lines, more than {limit}")
    for room, limit in ROOMS.items():
        lines = lines_of(root, room)
        if lines > limit:
            out.append(f"{room}: {lines} lines, {limit} are enough: move to a library what belongs there, or delete")
    page, limit = RESULTS
    if (root / page).exists() and rules.read(root, page).count("\n") > limit:
        out.append(f"{page}: more than {limit} lines: tables stand beside their protocols in docs/results/, split it")
    return out


BAD = [({f"apps/underbrush/{k}.cpp": "\n" * 400 for k in range(16)}, "apps/underbrush: 6400 lines, 4400 are enough"),
       ({"docs/results.md": "\n" * 151}, "split"), ({"src/a.hpp": "\n" * 301}, "split"), ({"src/a.cpp": "\n" * 601}, "split")]
GOOD = {"docs/results.md": "\n" * 150, "src/a.hpp": "\n" * 150, "src/a.cpp": "\n" * 300}

if __name__ == "__main__":
    rules.main(check, BAD, GOOD)
