#!/usr/bin/env python3
"""What the software behind a lidar makes of simulated scans, against the real scans of the same beams.

    scripts/software_study.py DATA WORK [--program build/bin/underbrush] [--seeds 3] [--only NAME ...] [--reuse]
                              [--json FILE] [--markdown FILE]

Odometry (KISS-ICP) and ground classification (Patchwork++) run over the held-out half of real logs, and over what the
default, meshes and look-ups answer to its beams. Both come from PyPI into WORK/venv, in the versions of
software/requirements.txt. DATA is as scripts/real_logs.py takes it; a log that is absent is skipped with one line.
--reuse takes what an interrupted run has imported, fitted and simulated. docs/results/software.md has the
protocol. Exit status: 0 the verdict holds, 1 it falls short, 77 the packages cannot be installed.
"""
import argparse
import json
import math
import os
import pathlib
import sys
import typing

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from packages import make_venv  # noqa: E402

REQUIREMENTS = pathlib.Path(__file__).resolve().parent / "software/requirements.txt"
NO_PACKAGES = 77
HALF = "log, half the beams"
Figures = dict[str, typing.Any]


def odometry_table(figures: Figures) -> list[str]:
    """The figures of odometry as a Markdown table; a row LOG/SOURCE."""
    out = ["| log/source | translation: RMSE, cm | ratio | correlation | rotation: RMSE, ° | ratio | correlation |",
           "|---|" + "---:|" * 6]
    units = {"translation": (100.0, 2), "rotation": (math.degrees(1), 4)}
    for log, sources in figures["odometry"].items():
        own = figures["real"][log]
        cells = [f"{own[f'{part}_rmse'] * unit:.{digits}f} | | " for part, (unit, digits) in units.items()]
        out.append(f"| {log}/log | {'| '.join(cells)}|")
        for source, found in sources.items():
            cells = []
            for part, (unit, digits) in units.items():
                f = found[part]
                low, high = f["ratio_interval"]
                cells += [f"{f['rmse'] * unit:.{digits}f}", f"{f['ratio']:.2f} ({low:.2f} to {high:.2f})",
                          f"{f['correlation']:.2f}"]
            out.append(f"| {log}/{source} | " + " | ".join(cells) + " |")
    return out


def scans_table(figures: Figures) -> list[str]:
    """The figures of ground and of successive scans as a Markdown table; a column for each source."""
    titles = list(next(iter(figures["scans"].values())))
    out = ["| ground share / agreement / scan to scan | log | " + " | ".join(titles) + " |",
           "|---|" + "---:|" * (1 + len(titles))]
    for log, sources in figures["scans"].items():
        own = figures["real"][log]
        moves = not math.isnan(own["difference_m"])
        cells = [f"{own['ground_share']:.3f}" + (f" / – / {100 * own['difference_m']:.2f} cm" if moves else "")]
        for title in titles:
            f = sources[title]
            cells.append(f"{f['ground_share_ratio']:.2f} / {f['ground_agreement']:.3f}"
                         + (f" / {f['difference_ratio']:.2f}" if moves else ""))
        out.append(f"| {log} | " + " | ".join(cells) + " |")
    return out


def study(options: argparse.Namespace) -> Figures:
    """Runs the study on the logs that are there, and returns its figures."""
    from software import figures, sources
    work = sources.Work(options.data.resolve(), options.work.resolve(), options.program.resolve(), options.seeds,
                        options.reuse)
    out: Figures = {"real": {}, "odometry": {}, "scans": {}}
    for name in options.only or sources.NAMES:
        if lacking := sources.absent(work.data, name):
            print(f"{name}: {lacking[0]} is not in {options.data}, skipped", file=sys.stderr)
            continue
        test = sources.halves(work, name)
        moves = name in sources.MOVING
        real = figures.Real(test, moves)
        out["real"][name] = real.own_figures()
        halves = [test.answered(range_m) for range_m in sources.half_of_beams(test)]
        out["scans"][name] = {HALF: real.scans(halves, halved=True)}
        if moves:
            out["odometry"][name] = {HALF: real.odometry(halves)}
        for source, answers in sources.answers(work, name, test):
            if moves:
                out["odometry"][name][source] = real.odometry(answers)
            if source not in sources.MIXTURES:
                out["scans"][name][source] = real.scans(answers[:1])
            print(f"{name}: {source}: {[out[what].get(name, {}).get(source) for what in ('odometry', 'scans')]}",
                  file=sys.stderr, flush=True)
    return out


def main() -> int:
    """Runs the study in its environment, and prints tables and verdict."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("data", type=pathlib.Path)
    parser.add_argument("work", type=pathlib.Path)
    parser.add_argument("--program", type=pathlib.Path, default=pathlib.Path("build/bin/underbrush"))
    parser.add_argument("--seeds", type=int, default=3, help="simulations of the default on the drives")
    parser.add_argument("--only", nargs="+", metavar="NAME", help="logs; default: all")
    parser.add_argument("--reuse", action="store_true", help="take what WORK has")
    parser.add_argument("--json", type=pathlib.Path, help="write figures, checks and verdict here")
    parser.add_argument("--markdown", type=pathlib.Path, help="also write the tables here")
    options = parser.parse_args()
    venv = options.work.resolve() / "venv"
    if pathlib.Path(sys.prefix) != venv:
        if failed := make_venv(venv, REQUIREMENTS):
            print(f"skipped: KISS-ICP and Patchwork++ cannot be installed: {failed}", file=sys.stderr)
            return NO_PACKAGES
        sys.stdout.flush()
        os.execv(venv / "bin/python", [str(venv / "bin/python"), *sys.argv])
    from software import sources, verdict
    figures = study(options)
    if not figures["real"]:
        parser.error(f"none of the logs is in {options.data}")
    checks = verdict.checks(figures, sources.OURS, "look-up, raw", sources.STANDING)
    tables = [*odometry_table(figures), "", *scans_table(figures)]
    judgement = verdict.verdict(checks)
    print("\n".join(tables) + f"\n\nverdict: {judgement}")
    if options.json:
        options.json.write_text(json.dumps({"study": "software", "verdict": judgement,
                                            "checks": [check.as_json() for check in checks], "figures": figures,
                                            "seeds": options.seeds}, indent=1) + "\n")
    if options.markdown:
        options.markdown.write_text("\n".join(tables) + "\n")
    return 0 if judgement == "holds" else 1


if __name__ == "__main__":
    sys.exit(main())
