"""The table of intensities: what models answer for held-out beams, beside constants."""
from .common import HALVES, LOGS, near
from .jobs import Job, Measured, Part, read_json

LABELLED = {"kitti00_labelled": ("kitti00_000000", "semantickitti"), "rellis_000104": ("000104", "rellis")}
SCORED = """for i in mean drawn; do underbrush simulate model --like {test} --intensity $i -o $i.ply; done
underbrush score {test} mean.ply drawn.ply --model model --model model --json scores.json
rm -r model *.ply"""


def part(row, job):
    def cells(folder):
        models = read_json(folder / "scores.json")["models"]
        mean, drawn = models["mean"]["intensity"], models["drawn"]["intensity"]
        group = mean.get("constant_of_class") or mean["constant_of_kind"]
        yield row, "beams", [mean["beams"]]
        for word, key in (("RMSE", "rmse"), ("MAE", "mae")):
            yield row, f"{word}: mean", [mean[key]]
            yield row, f"{word}: drawn", [drawn[key]]
            yield row, f"{word}: constant", [mean["constant"][key]]
            yield row, f"{word}: group", [group[key]]
        for column, score in (("mean", mean), ("drawn", drawn), ("group", group)):
            yield row, f"correlation: {column}", [score["correlation"]]
        yield row, "deviation: log", [mean["real_sd"]]
        yield row, "deviation: mean", [mean["simulated_sd"]]
        yield row, "deviation: drawn", [drawn["simulated_sd"]]
    return Part((job,), cells)


def halves(log):
    return part(log, Job(f"light.{log}", f'underbrush fit "$WORK/{log}/train.ply"{near(log)} -o model\n' +
                         SCORED.format(test=f'"$WORK/{log}/test.ply"'), (LOGS[log],), (HALVES[log],)))


def labelled(log):
    scan, label_set = LABELLED[log]
    file = f"{log}/{scan}"
    return part(f"{log}, labels", Job(
        f"light.labelled.{log}", f"""underbrush import "$DATA/{file}.bin" --labels "$DATA/{file}.label" \
--label-set {label_set} -o log.ply
underbrush split log.ply --columns 2 --train train.ply --test test.ply
underbrush fit train.ply -o model
""" + SCORED.format(test="test.ply"), (f"{file}.bin", f"{file}.label")))


MEASURED = {"light": Measured((*(halves(log) for log in LOGS), *(labelled(log) for log in LABELLED)))}
