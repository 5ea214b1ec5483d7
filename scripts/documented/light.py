"""The table of intensities: what models answer for held-out beams, beside constants."""
from .common import HALVES, LOGS
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
        yield row, "log", [mean["beams"]]
        yield row, "RMSE", [mean["rmse"]]
        yield row, "of one constant", [mean["constant"]["rmse"]]
        yield row, "of one a group", [group["rmse"]]
        yield row, "RMSE, drawn", [drawn["rmse"]]
        yield row, "MAE", [mean["mae"]]
        yield row, "MAE of one a group", [group["mae"]]
        yield row, "correlation", [mean["correlation"]]
        yield row, "of the groups", [group["correlation"]]
        yield row, "deviation of the log", [mean["real_sd"]]
        yield row, "mean's", [mean["simulated_sd"]]
        yield row, "drawn's", [drawn["simulated_sd"]]
    return Part((job,), cells)


def halves(log):
    near = " --min-range 2" if log.startswith("kitti") else ""
    return part(log, Job(f"light.{log}", f'underbrush fit "$WORK/{log}/train.ply"{near} -o model\n' +
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
