"""The tables of matter that is drawn once, of the instrument that meets it, and of matter that is known."""
import statistics

from .common import HALVES, KEYS, LOGS, near, study
from .jobs import Job, Measured, Part, read_json

THREE = ("packet error, m", "F1", "cloud error, m")


def grain():
    def part(log):
        job = Job(f"grain.{log}", f"""underbrush fit "$WORK/{log}/train.ply"{near(log)} -o model
for m in once anew; do underbrush simulate model --like "$WORK/{log}/test.ply" --matter $m -o $m.ply; done
underbrush score "$WORK/{log}/test.ply" once.ply anew.ply --json scores.json
rm -r model once.ply anew.ply""", (LOGS[log],), (HALVES[log],))

        def cells(folder):
            models = read_json(folder / "scores.json")["models"]
            yield log, "roughness, cm: log", [100 * models["once"]["roughness_real_m"]]
            for model in ("once", "anew"):
                yield log, f"roughness, cm: {model}", [100 * models[model]["roughness_m"]]
                yield from ((log, f"{column}: {model}", [models[model][KEYS[column]]])
                            for column in THREE)
        return Part((job,), cells)
    return tuple(part(log) for log in LOGS)


LABELLED = {"kitti00_labelled": ("kitti00_000000", "semantickitti", {"vegetation": 70, "building": 50, "car": 10}),
            "rellis_000104": ("000104", "rellis", {"tree": 4, "bush": 19, "person": 17})}


def grain_of_classes():
    """One grain for all ellipsoids, which a log without labels has, beside a grain for each class."""
    def part(log):
        scan, label_set, classes = LABELLED[log]
        file = f"{log}/{scan}"
        job = Job(f"grain-class.{log}", f"""like="--like labelled.test.ply"
underbrush import "$DATA/{file}.bin" -o bare.ply
underbrush import "$DATA/{file}.bin" --labels "$DATA/{file}.label" --label-set {label_set} -o labelled.ply
for n in bare labelled; do
    underbrush split $n.ply --columns 2 --train $n.train.ply --test $n.test.ply
    underbrush fit $n.train.ply -o $n
done
underbrush simulate bare $like --matter anew -o anew.ply
underbrush simulate bare $like -o one.ply
underbrush simulate labelled $like -o by_class.ply
"$PYTHON" "$SOURCE/scripts/class_roughness.py" labelled.test.ply anew.ply one.ply by_class.ply > roughness.json
rm -r bare labelled *.ply""", (f"{file}.bin", f"{file}.label"))

        def cells(folder):
            of_class = read_json(folder / "roughness.json")
            for name, number in classes.items():
                for column, source in (("log", "labelled.test"), ("drawn anew", "anew"), ("one grain", "one"),
                                       ("a grain by class", "by_class")):
                    yield f"{log}, {name}", f"{column}, cm", [100 * of_class[str(number)][f"{source}.ply"]["m"]]
        return Part((job,), cells)
    return tuple(part(log) for log in LABELLED)


INSTRUMENT_COLUMNS = {column: KEYS[column] for column in ("capped error, m", *THREE, "informedness", "F1 of misses")}
SENSORS = {"rellis_000104": "ouster-os1-64", "marv_forest": "ouster-os0-128"}  # of the others: velodyne-hdl64e
UNNAMED = "marv_forest"  # does not name its sensor, so that `fit` is told it


def instrument():
    """Thin rays beside the instrument of the log's own sensor, with keyframes (the default) and without."""
    def part(log):
        sensor = SENSORS.get(log, "velodyne-hdl64e")
        like = f'--like "$WORK/{log}/test.ply"'
        beam = f"--sensor {sensor} --super-sample 9"
        train = f'"$WORK/{log}/train.ply"{near(log)}'
        told = f" --sensor {sensor}" if log == UNNAMED else ""
        default = f"""underbrush fit {train} -o model
underbrush simulate model {like} -o default.ply
rm -r model
""" if told else ""
        job = Job(f"instrument.{log}", f"""{default}underbrush fit {train}{told} -o model
underbrush simulate model {like} -o thin.ply
underbrush simulate model {like} {beam} -o instrument.ply
underbrush fit {train}{told} --keyframes 0 -o elements
underbrush simulate elements {like} -o thin-elements.ply
underbrush simulate elements {like} {beam} -o instrument-elements.ply
underbrush score "$WORK/{log}/test.ply" {"default.ply " if told else ""}thin.ply instrument.ply thin-elements.ply \
  instrument-elements.ply --train "$WORK/{log}/train.ply" --json scores.json
rm -r model elements *.ply""", (LOGS[log],), (HALVES[log],))

        def cells(folder):
            read = read_json(folder / "scores.json")
            for source, s in {**read["models"], **read["baselines"]}.items():
                row = f"{log}/{source.replace('-elements', ', elements')}"
                yield from ((row, column, [] if s.get(key) is None else [s[key]])
                            for column, key in INSTRUMENT_COLUMNS.items())
                yield row, "roughness, cm", [] if s.get("roughness_m") is None else [100 * s["roughness_m"]]
                rmse = s.get("intensity", {}).get("rmse")
                yield row, "intensity RMSE", [] if rmse is None else [rmse]
        return Part((job,), cells)
    return tuple(part(log) for log in LOGS)


def echoes(folder):
    """The study of the page on terrestrial scans."""
    for row, s in read_json(folder / "study.json")["figures"].items():
        row = row.removeprefix("conifers/")
        for column, key in (("2 or more, %", "two"), ("3 or more, %", "three"), ("above ground", "two_above_ground")):
            yield row, column, [100 * s[key]]
        for column, share in zip(("0 to 2 m", "2 to 4 m", "4 to 8 m", "from 8 m"), s["two_in_band"]):
            yield row, column, [100 * share]
        yield row, "gaps, m", s["gap_m"]
        yield row, "distance", [s["distance"]]


def transmission(folder):
    """Densities and transmissions of slabs whose truth is known."""
    for slab, sources in read_json(folder / "study.json")["figures"].items():
        for source, s in sources.items():
            row, layers = f"{slab}/{source}", s["layers"]
            yield row, "area density", [s["area_density"]]
            yield row, "inner layers", extremes(layers[1:-1])
            yield row, "outermost layers", [layers[0], layers[-1]]
            yield row, "cells held, %", [] if s["covered"] is None else [100 * s["covered"]]
            for view, share in s["transmission"].items():
                error = s.get("error", {}).get(view)
                yield row, f"{view}, %", [100 * share] + ([] if error is None else [100 * error])


MEASURED = {
    "transmission": Measured((Part((study("transmission"),), transmission),)),
    "grain": Measured(grain()),
    "grain-class": Measured(grain_of_classes()),
    "instrument": Measured(instrument()),
}


def object_list_errors(figures, row):
    """{value: RMSE in m} of a row of the table of object lists, the mean over the objects that are long in view.
    The row "truth" has the errors of the labels."""
    objects = figures["meshes/model" if row == "truth" else row]["normalised_rmse"]
    kept = [o for o in objects if min(o["simulated_real"]["cycles"], o["real_truth"]["cycles"]) >= 10]
    pair = "real_truth" if row == "truth" else "simulated_real"
    return {value: sum(o[pair]["rmse_m"][value] for o in kept) / len(kept)
            for value in ("x", "y", "z", "length", "width", "height")}


def extremes(values):
    return [min(values), max(values)]


def over_logs(values):
    """The 95 % interval of the mean of a value of each of the five logs (Student's t with 4 degrees of freedom)."""
    assert len(values) == len(LOGS) == 5
    half = 2.776 * statistics.stdev(values) / len(values) ** 0.5
    return [statistics.mean(values) - half, statistics.mean(values) + half]


def validated(tables):
    """The table of effects on the page about validation, made of results that other tables show."""
    def of_logs(effect, *values):
        yield effect, "error", [x for of_value in values for x in extremes(of_value)]
        yield effect, "interval", [x for of_value in values for x in over_logs(of_value)]

    def draws(folder):
        figures = read_json(folder / "study.json")["figures"]
        yield from of_logs("where beams end", *([figures[log]["default"][KEYS[column]] for log in LOGS]
                                                for column in ("capped error, m", "informedness")))

    def ends(*folders):
        models = [read_json(folder / "scores.json")["models"] for folder in folders]
        for effect, source, columns in (("where beams end, elements alone", "thin-elements", ("packet error, m", "F1")),
                                        ("the whole instrument", "instrument", ("capped error, m", "informedness"))):
            yield from of_logs(effect, *([m[source][KEYS[column]] for m in models] for column in columns))

    def rings(*folders):
        models = [read_json(folder / "scores.json")["models"]["once"] for folder in folders]
        yield from of_logs("roughness along a ring", [m["roughness_m"] / m["roughness_real_m"] for m in models])

    def several(folder):
        figures = {row.partition("/")[2]: s for row, s in read_json(folder / "study.json")["figures"].items()}
        ours, real = figures["default"], figures["real"]
        yield "several echoes a pulse", "error", [ours["two"], real["two"]]
        yield "gaps between echoes", "error", [ours["gap_m"][1], real["gap_m"][1]]

    def walls(folder):
        f = read_json(folder / "study.json")["figures"]["walls"]["kitti_0052_static"]["default fit"]
        yield "walls of a fitted model", "error", [f["spread"]["mean"], 1000 * f["offset_m"]["mean"]]
        yield "walls of a fitted model", "interval", [scale * f[key][end] for key, scale in
                                                      (("spread", 1), ("offset_m", 1000)) for end in ("low", "high")]

    def beyond(folder):
        f = read_json(folder / "study.json")["figures"]["kitti_0027_forest"]["20 m beyond"]["default"]
        yield "beyond the log", "compared with", [20]
        yield "beyond the log", "error", [f["answered"], f["capped_error_m"]]

    def software(forest, street):
        found = [next(iter(read_json(folder / "study.json")["figures"]["odometry"].values()))["default"]
                 for folder in (forest, street)]
        parts = [drive[part] for part in ("translation", "rotation") for drive in found]
        yield "odometry on simulated scans", "error", [p["ratio"] for p in parts] + extremes(
            [p["correlation"] for p in parts])
        yield "odometry on simulated scans", "interval", [x for p in parts for x in p["ratio_interval"]]

    def lists(folder):
        f = read_json(folder / "study.json")["figures"]["kitti_0005_tracks"]
        errors = {row: object_list_errors(f, row) for row in ("meshes/pipeline", "ellipsoids/pipeline")}
        truth = object_list_errors(f, "truth")
        yield ("object lists", "error", extremes([e[v] / truth[v] for e in errors.values()
                                                 for v in ("length", "width", "height")]))

    def part(name, cells):
        return Part(tuple(job for p in tables[name].parts for job in p.jobs), cells)
    return Measured((part("look-up", draws), part("instrument", ends), part("grain", rings), part("echoes", several), part("walls", walls),
                     part("extrapolation", beyond), part("software-odometry", software),
                     part("sequential", lists)),
                    relative={"odometry on simulated scans": 0.02})
