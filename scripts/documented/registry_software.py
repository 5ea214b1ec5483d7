"""The tables of `scripts/software_study.py`, one job a log."""
import math

from .jobs import Job, Measured, Part, read_json

NEEDS = {"kitti_0005_tracks": ("kitti_0005_city/velodyne.kfx", "kitti_0005_tracks/velodyne_30_89.kfx")}
DRIVES = ("kitti_0027_forest", "kitti_0005_tracks")
LOGS = (*DRIVES, "kitti_0052_static", "rellis_000104", "marv_forest")
UNITS = {"translation: RMSE, cm": 100, "rotation: RMSE, °": math.degrees(1)}


def job(log, needs):
    # A study whose verdict falls short exits 1, and its figures count all the same.
    return Job(f"software.{log}", f"""rm -rf "$WORK/software/{log}"
"$PYTHON" "$SOURCE/scripts/software_study.py" "$DATA" "$WORK/software" --program "$BIN/underbrush" --only {log} \\
  --json study.json || test -s study.json
rm -r "$WORK/software/{log}\"""", NEEDS.get(log, (needs.get(log),)),
               programs=("underbrush", "underbrush-study"))


def odometry(log):
    def cells(folder):
        figures = read_json(folder / "study.json")["figures"]
        for column, unit in UNITS.items():
            part = column.partition(":")[0]
            yield f"{log}/log", column, [unit * figures["real"][log][f"{part}_rmse"]]
            for source, found in figures["odometry"][log].items():
                yield f"{log}/{source}", column, [unit * found[part]["rmse"]]
                yield f"{log}/{source}", f"{part}: ratio", [found[part]["ratio"], *found[part]["ratio_interval"]]
                yield f"{log}/{source}", f"{part}: correlation", [found[part]["correlation"]]
    return cells


def scans(log):
    def cells(folder):
        figures = read_json(folder / "study.json")["figures"]
        own = figures["real"][log]
        many = not math.isnan(own["difference_m"])
        yield log, "log", [own["ground_share"]] + [100 * own["difference_m"]] * many
        for source, found in figures["scans"][log].items():
            yield log, source, ([found["ground_share_ratio"], found["ground_agreement"]]
                                + [found["difference_ratio"]] * many)
    return cells


def tables(needs):
    """The tables of the study; `needs` is what of the data each log needs."""
    jobs = {log: job(log, needs) for log in LOGS}
    return {"software-odometry": Measured(tuple(Part((jobs[log],), odometry(log)) for log in DRIVES),
                                          relative={"*": 0.02},
                                          absolute={f"{column.partition(':')[0]}: correlation": 0.01
                                                    for column in UNITS}),
            "software-scans": Measured(tuple(Part((jobs[log],), scans(log)) for log in LOGS), relative={"*": 0.01})}
