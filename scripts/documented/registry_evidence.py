"""Which commands make the tables of evidence that can fail: the two-sided verification, repeated scans, extrapolation
and the protocol of learned simulators."""
import dataclasses
import math
import typing

from .common import BASELINES, cell
from .jobs import Job, Measured, Part, read_json

SOURCES = ("default", "mesh", "mesh, carved", "look-up", "always hit")
FAULTS = ("no noise", "double noise", "bias of 1 cm", "mirror tilted by 0.5°")
IMAGES = {"CD, m²": "chamfer_m2", "F": "f_score", "depth RMSE, m": "depth_rmse_m", "MedAE, m": "depth_median_m",
          "SSIM": "depth_ssim", "PSNR, dB": "depth_psnr", "drop RMSE": "drop_rmse", "drop accuracy": "drop_accuracy",
          "drop F1": "drop_f1"}
GHOSTS = {"capped error, m": "capped_error_m", "informedness": "informedness", "packet error, m": "packet_error_m",
          "F1": "f1", "cloud error, m": "cloud_error_m", "NLL/beam": "nll_per_beam", "CRPS, m": "crps_m"}


def figures(folder: typing.Any) -> typing.Any:
    return read_json(folder / "study.json")["figures"]


def bounded(figure: dict[str, float], unit: float) -> list[float]:
    return [unit * figure[key] for key in ("mean", "low", "high")]


def walls(folder: typing.Any) -> typing.Iterator[tuple[str, str, list[float]]]:
    for log, simulators in figures(folder)["walls"].items():
        for simulator, f in simulators.items():
            row = f"{log}/{simulator}"
            yield row, "spread", bounded(f["spread"], 1)
            yield row, "range, mm", bounded(f["offset_m"], 1000)
            yield row, "lean", bounded(f["lean_rad"], 180 / math.pi)


def faults(folder: typing.Any) -> typing.Iterator[tuple[str, str, list[float]]]:
    caught = figures(folder)["faults"]
    for fault in FAULTS:
        for place, counts in caught.items():
            yield fault, place, [counts[fault]]


def viewpoints(folder: typing.Any) -> typing.Iterator[tuple[str, str, list[float]]]:
    """A site whose truth is known, answered from poses that had no part in the training."""
    columns = {"transmission, %": ("transmission", 100), "capped error, m": ("capped_error_m", 1),
               "informedness": ("informedness", 1)}
    sources = {"truth": "truth", "default": "default", "voxel": "voxel", "mesh": "mesh", "carved mesh": "mesh, carved",
               "look-up": "look-up", "always hit": "always hit"}
    only = {"truth": "transmission", "always hit": "capped_error_m"}  # Their other columns are the same for all views.
    for view, answers in figures(folder).items():
        for column, (key, unit) in columns.items():
            for name, source in sources.items():
                if only.get(name, key) != key:
                    continue
                empty = key == "informedness" and view == "overhead"
                yield view, f"{column}: {name}", [] if empty else [unit * answers[source][key]]


def extrapolation(folder: typing.Any) -> typing.Iterator[tuple[str, str, list[float]]]:
    columns = {"informedness": "informedness", "returns answered": "answered", "F1": "f1",
               "capped error, m": "capped_error_m", "median range error, m": "median_range_error_m"}
    for log, protocols in figures(folder).items():
        for protocol, sources in protocols.items():
            for column, key in columns.items():
                yield f"{log}/{protocol}", column, [sources[source][key] for source in SOURCES]


def repeats(folder: typing.Any) -> typing.Iterator[tuple[str, str, list[float]]]:
    for models in figures(folder)["repeats"].values():
        for model, targets in models.items():
            for target, f in targets.items():
                yield model, target, [0 if model == "measured" else f["same_scans"],
                                      f["floor"] if model == "measured" else f["distance"]]
            last = targets["all"]
            yield model, "scan to scan, cm", [100 * last["real_difference_m" if model == "measured"
                                                         else "difference_m"]]


def evidence(study: typing.Callable[..., Job], logs: dict[str, str], halves: dict[str, Job]) -> dict[str, Measured]:
    """The tables, from the registry's `study` and its jobs of the real logs."""
    everything = {"needs": tuple(logs.values()), "after": tuple(halves.values())}
    data = "mkdir logs\n" + "".join(f'ln -s "$WORK/{log}" logs/\n' for log in logs)
    still, street = "kitti_0052_static", "kitti_0005_city"

    def run(name: str, options: str, before: str, **more: typing.Any) -> Job:
        # A name of its own: the registry runs some of these studies without data.
        return dataclasses.replace(study(name, options, before, **more), name=f"evidence.{name}")

    alone = f'mkdir still\nln -s "$WORK/{still}" still/\n'
    only = {"needs": (logs[still],), "after": (halves[still],)}
    verification = run("verification", "--data still", alone, **only)

    def protocol(log: str) -> Part:
        job = Job(f"kitti360.{log}", f"""underbrush fit "$WORK/{log}/train.ply" --min-range 2 -o default
underbrush fit "$WORK/{log}/train.ply" --min-range 2 --fitter surface -o mesh
for m in default mesh; do underbrush simulate $m --like "$WORK/{log}/test.ply" -o $m.ply; done
underbrush simulate default --like "$WORK/{log}/test.ply" --draw median -o median.ply
underbrush score "$WORK/{log}/test.ply" default.ply median.ply mesh.ply --train "$WORK/{log}/train.ply" \\
  --protocol kitti360 --json scores.json
rm -r default mesh default.ply median.ply mesh.ply""", (logs[log],), (halves[log],))

        def cells(folder: typing.Any) -> typing.Iterator[tuple[str, str, list[float]]]:
            read = read_json(folder / "scores.json")
            for model, s in {**read["models"], **read["baselines"]}.items():
                for column, key in IMAGES.items():
                    yield f"{log}/{model}", column, [s["kitti360"][key]]
        return Part((job,), cells)

    left_out = Job("movers-left-out", f"""underbrush movers "$WORK/{street}/log.ply" -o marked.ply
underbrush split marked.ply --every 2 --train train.ply --test test.ply
for m in default carved; do
  more=""; [ $m = default ] || more="--fitter surface --surface-carve"
  underbrush fit "$WORK/{street}/train.ply" --min-range 2 $more -o $m-all
  underbrush fit train.ply --min-range 2 $more -o $m-without
  for n in $m-all $m-without; do underbrush simulate $n --like test.ply -o $n.ply; done
  underbrush score test.ply $m-all.ply $m-without.ply --model $m-all --model $m-without --train train.ply --json $m.json
done
rm -r *.ply *-all *-without""", (logs[street],), (halves[street],))

    def ghosts(folder: typing.Any) -> typing.Iterator[tuple[str, str, list[float]]]:
        for model, row in (("default", "default"), ("carved", "mesh, carved")):
            for log in ("all", "without"):
                score = read_json(folder / f"{model}.json")["models"][f"{model}-{log}"]
                for column, key in GHOSTS.items():
                    yield f"{row}/{log}", column, [score[key]]
        for name, score in read_json(folder / "default.json")["baselines"].items():
            for column, key in GHOSTS.items():
                yield name, column, cell(score, key)

    def growing(log: str, seconds: float, models: tuple[str, ...]) -> Part:
        """A fit of the first seconds of a log, updated with the rest, beside one fit of all."""
        whole = 'underbrush fit "$train" --min-range 2 -o whole' if "whole" in models else ""
        job = Job(f"growing.{log}.{seconds}", f"""train="$WORK/{log}/train.ply" test="$WORK/{log}/test.ply"
underbrush split "$train" --time {seconds} 99 --train a.ply --test b.ply
underbrush fit a.ply --min-range 2 -o first
underbrush fit b.ply --update first -o updated
{whole}
for m in {" ".join(models)}; do
  underbrush simulate $m --like "$test" -o $m.ply
  underbrush score "$test" $m.ply --model $m --name $m --train "$train" --json $m.json
done
rm -r *.ply {" ".join(models)}""", (logs[log],), (halves[log],))

        def cells(folder: typing.Any) -> typing.Iterator[tuple[str, str, list[float]]]:
            scored = {model: read_json(folder / f"{model}.json") for model in models}
            rows = {model: read["models"][model] for model, read in scored.items()}
            if "whole" in models:  # The baselines of a log are the same in each of its parts.
                rows.update((name, scored["whole"]["baselines"][name]) for name in BASELINES)
            for row, score in rows.items():
                for column, key in GHOSTS.items():
                    if column != "cloud error, m":
                        yield f"{log}, {seconds} s/{row}", column, cell(score, key)
        return Part((job,), cells)

    every = ("first", "updated", "whole")
    return {
        "growing": Measured((growing(street, 1.5, every), growing("kitti_0027_forest", 4.1, every),
                             growing("kitti_0027_forest", 7.7, ("first", "updated")))),
        "movers-left-out": Measured((Part((left_out,), ghosts),)),
        "walls": Measured((Part((verification,), walls),)),
        "faults": Measured((Part((verification,), faults),)),
        "extrapolation": Measured((Part((run("extrapolation", "--data logs", data, **everything),), extrapolation),)),
        "viewpoints": Measured((Part((run("viewpoints", "", ""),), viewpoints),)),
        "repeats": Measured((Part((run("vegetation", "--quick --data still", alone, **only),), repeats),)),
        "kitti360": Measured((protocol("kitti_0027_forest"), protocol(street)),
                             uncompared={"LiDAR4D": "figures of the paper, of other drives"}),
    }
