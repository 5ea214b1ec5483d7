#!/usr/bin/env python3
"""Ellipsoids against surface mesh on real logs: import, fit on half, simulate and score the other half.

    scripts/real_logs.py DATA WORK [--program build/bin/underbrush] [--only NAME ...]
                         [--models NAME ...] [--reuse] [--folds K] [--markdown FILE]

default is fit without options, and median the same model, of which simulate --draw median answers. sharp is
share/configs/likelihood-sharp.yaml. tuned and tuned_nll are the default with what optimize found on a slice of the
training half. no_keyframes is the default with --keyframes 0. mesh_primitives is a scene of plant meshes, not a model.

DATA is a folder with the logs named in LOGS below (KITTI drives packed by its frames.py, which needs
NumPy, or unpacked). WORK receives all intermediate files. Prints one Markdown table row a log and
model; a log that is absent is skipped with one line.
"""
import argparse
import json
import os
import pathlib
import subprocess
import sys
import typing

Program = typing.Union[str, pathlib.Path]
Words = list[typing.Any]
Scores = dict[str, typing.Any]
HDL64 = ["--deskew", "velodyne-hdl64e", "--elevation-offset-deg", "0.205",
         "--infer-misses", "velodyne-hdl64e"]
# name: (source below DATA, import options, split options, fit options). The KITTI car stands in its
# own beams at 1.4 to 2 m.
LOGS: dict[str, tuple[str, Words, Words, Words]] = {
    "kitti_0027_forest": ("kitti_0027_forest", HDL64, ["--every", "2"], ["--min-range", "2"]),
    "kitti_0005_city": ("kitti_0005_city", HDL64, ["--every", "2"], ["--min-range", "2"]),
    "kitti_0052_static": ("kitti_0052_static", HDL64, ["--every", "2"], ["--min-range", "2"]),
    "rellis_000104": ("rellis_000104/frame000104-1581624663_170.ply",
                      ["--infer-misses", "ouster-os1-64"], ["--columns", "2"], []),
    "marv_forest": ("marv_forest/1727353472_601360559.npz", ["--unknown-below-deg", "-13"],
                    ["--columns", "2"], []),
}
SCENE_SCRIPT = pathlib.Path(__file__).resolve().parent / "mesh_primitives.sh"
CONFIGS = pathlib.Path(__file__).resolve().parent.parent / "share/configs"
FITTERS: dict[str, typing.Optional[Words]] = {
    "default": [], "hierarchical": ["--fitter", "hierarchical"], "surface": ["--fitter", "surface"],
    "no_keyframes": ["--keyframes", "0"], "surface_paper": ["--config", CONFIGS / "vegetation-surface-mobile.yaml"],
    "surface_carved": ["--fitter", "surface", "--surface-carve"],
    "sharp": ["--config", CONFIGS / "likelihood-sharp.yaml"],
    "voxel": ["--fitter", "voxel", "--voxel-side", "0.3"],
    "top_down": ["--fitter", "top_down"], "bottom_up": ["--fitter", "bottom_up"],
    "mesh_primitives": None,  # scripts/mesh_primitives.sh
    "median": None,  # the model of default
    "likelihood_voxel": ["--fitter", "likelihood", "--start", "voxel", "--voxel-side", "0.3"],
    "likelihood_top_down": ["--fitter", "likelihood", "--start", "top_down"],
    "likelihood_bottom_up": ["--fitter", "likelihood", "--start", "bottom_up"],
}
# Models whose parameters optimize tunes first: its options, and on which seconds of the training half (so
# as to keep the time within bounds; the others are shorter than 10 s).
TUNED = {"tuned": ["--objective", "packet_f1"], "tuned_nll": ["--objective", "nll"]}
SLICES = {"kitti_0027_forest": ["--slice", "0", "4"]}
DEFAULT = ["default", "sharp", "surface", "surface_paper", "surface_carved"]
COLUMNS = [("packet_error_m", "packet error, m", 3), ("precision", "precision", 4),
           ("recall", "recall", 4), ("f1", "F1", 4), ("cloud_error_m", "cloud error, m", 4),
           ("median_range_error_m", "median range error, m", 3), ("nll_per_beam", "NLL/beam", 3),
           ("crps_m", "CRPS, m", 3), ("calibration_error", "calibration error", 4), ("packet_f1", "packet error + 2(1 − F1)", 3)]


def run(program: Program, *words: object) -> None:
    subprocess.run([program, *map(str, words)], check=True, stdout=subprocess.DEVNULL)


def unpacked(source: pathlib.Path, data: pathlib.Path, work: pathlib.Path) -> pathlib.Path:
    """A KITTI drive as import takes it: velodyne/NNNNNN.bin beside its text files."""
    archive = source / "velodyne.kfx"
    if not source.is_dir() or not archive.exists():
        return source
    folder = work / "raw"
    if not (folder / "velodyne").exists():
        subprocess.run([sys.executable, data / "frames.py", "unpack", archive, folder / "velodyne"],
                       check=True)
        for text in source.glob("*.txt"):
            (folder / text.name).write_bytes(text.read_bytes())
    return folder


def halves(program: Program, data: pathlib.Path, work: pathlib.Path, name: str) -> None:
    below, options, split, _ = LOGS[name]
    work.mkdir(parents=True, exist_ok=True)
    source = unpacked(data / below, data, work)
    poses = ["--poses", source / "poses_velo.txt"] if (source / "poses_velo.txt").exists() else []
    run(program, "import", source, *poses, *options, "-o", work / "log.ply")
    run(program, "split", work / "log.ply", *split, "--train", work / "train.ply", "--test", work / "test.ply")


def fit_options(program: Program, work: pathlib.Path, name: str, label: str) -> Words:
    if label not in TUNED:
        return FITTERS[label] or []
    config = work / f"{label}.yaml"
    run(program, "optimize", work / "train.ply", *LOGS[name][3], *SLICES.get(name, []), *TUNED[label],
        "--report", work / f"{label}-report", "-o", config, "--resume")
    return ["--config", config]


def model_of(label: str) -> str:
    return "default" if label == "median" else label


def score(program: Program, work: pathlib.Path, name: str, models: list[str]) -> Scores:
    fit = LOGS[name][3]
    train, test = work / "train.ply", work / "test.ply"
    words: Words = ["score", test]
    fitted: set[str] = set()
    for label in models:
        model = model_of(label)
        if label == "mesh_primitives":
            subprocess.run([SCENE_SCRIPT, train, work / label, *fit], check=True, stdout=subprocess.DEVNULL,
                           env={**os.environ, "UNDERBRUSH": str(program)})
        elif model not in fitted:
            run(program, "fit", train, *fit_options(program, work, name, model), *fit, "-o", work / model)
            fitted.add(model)
        draw = ["--draw", "median"] if label == "median" else []
        run(program, "simulate", work / model, "--like", test, *draw, "-o", work / f"{label}.ply")
        words += [work / f"{label}.ply", "--model", work / model, "--name", label]
    run(program, *words, "--json", work / "score.json", "--report", work / "report")
    result: Scores = json.loads((work / "score.json").read_text())
    for s in result["models"].values():
        s["calibration_error"] = s["reliability"]["error"]
        s["packet_f1"] = s["packet_error_m"] + 2 * (1 - s["f1"])
    return result


def ellipsoids(program: Program, model: pathlib.Path) -> int:
    done = subprocess.run([program, "info", model, "--json", "-"], check=True, stdout=subprocess.PIPE)
    return int(json.loads(done.stdout)["ellipsoids"])


def fold_means(program: Program, work: pathlib.Path, name: str, models: list[str], folds: int) -> Scores:
    """Scores within the training half: each column in `folds` is held out once; beams of all, mean of the rest."""
    results = []
    for k in range(folds):
        fold = work / f"fold{k}"
        fold.mkdir(exist_ok=True)
        run(program, "split", work / "train.ply", "--columns", folds, "--offset", k,
            "--train", fold / "train.ply", "--test", fold / "test.ply")
        results.append(score(program, fold, name, models)["models"])
    means = {label: {key: sum(r[label][key] for r in results) / folds for key, _, _ in COLUMNS}
             for label in models}
    for label in models:
        means[label]["beams"] = sum(r[label]["beams"] for r in results)
    return {"models": means}


def rows(program: Program, work: pathlib.Path, name: str, result: Scores) -> typing.Iterator[str]:
    for label, s in result["models"].items():
        figures = [str(ellipsoids(program, work / model_of(label)))]
        figures += [f"{s[key]:.{digits}f}" for key, _, digits in COLUMNS]
        yield f"| {name} | {label} | {s['beams']} | " + " | ".join(figures) + " |"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("data", type=pathlib.Path)
    parser.add_argument("work", type=pathlib.Path)
    parser.add_argument("--program", default="build/bin/underbrush")
    parser.add_argument("--only", nargs="*", default=list(LOGS), choices=list(LOGS))
    parser.add_argument("--models", nargs="*", default=DEFAULT, choices=[*FITTERS, *TUNED],
                        help="none: import and split only")
    parser.add_argument("--reuse", action="store_true", help="take train.ply and test.ply as they are in WORK")
    parser.add_argument("--folds", type=int, help="of single scans: score within the training half, "
                        "every K-th column held out in turn; the test half is not read")
    parser.add_argument("--markdown", type=pathlib.Path, help="also write the table here")
    args = parser.parse_args()
    table = ["| log | model | beams | ellipsoids | " + " | ".join(title for _, title, _ in COLUMNS) + " |",
             "|---|---|" + "---:|" * (2 + len(COLUMNS))]
    print("\n".join(table), flush=True)
    for name in args.only:
        if not (args.data / LOGS[name][0]).exists():
            print(f"{name}: not in {args.data}, skipped", file=sys.stderr)
            continue
        if not args.reuse:
            halves(args.program, args.data, args.work / name, name)
        folder = args.work / name
        if not args.models:
            continue
        if args.folds:
            result = fold_means(args.program, folder, name, args.models, args.folds)
            folder = folder / f"fold{args.folds - 1}"
        else:
            result = score(args.program, folder, name, args.models)
        for row in rows(args.program, folder, name, result):
            table.append(row)
            print(row, flush=True)
    if args.markdown:
        args.markdown.write_text("\n".join(table) + "\n")


if __name__ == "__main__":
    main()
