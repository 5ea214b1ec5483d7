"""What the tables share: the real logs and their halves, names of scores, and the studies."""
from .jobs import Job

LOGS = {  # name: what of DATA it needs
    "kitti_0027_forest": "kitti_0027_forest/velodyne.kfx",
    "kitti_0005_city": "kitti_0005_city/velodyne.kfx",
    "kitti_0052_static": "kitti_0052_static/velodyne.kfx",
    "rellis_000104": "rellis_000104/frame000104-1581624663_170.ply",
    "marv_forest": "marv_forest/1727353472_601360559.npz",
}
REAL_LOGS = '"$PYTHON" "$SOURCE/scripts/real_logs.py" "$DATA" "$WORK" --program "$BIN/underbrush"'
STUDY = "underbrush-study"
BASELINES = ("look-up", "always hit")

HALVES = {log: Job(f"halves.{log}", f"{REAL_LOGS} --only {log} --models\ntest -s \"$WORK/{log}/test.ply\"", (path,))
          for log, path in LOGS.items()}



def near(log):
    """The option of a fit that leaves out the returns of the car that drives a log."""
    return " --min-range 2" if log.startswith("kitti") else ""


KEYS = {"packet error, m": "packet_error_m", "capped error, m": "capped_error_m", "precision": "precision",
        "recall": "recall", "F1": "f1", "informedness": "informedness", "F1 of misses": "f1_of_misses", "median range error, m": "median_range_error_m",
        "cloud error, m": "cloud_error_m", "density-aware Chamfer": "density_aware_chamfer",
        "NLL": "nll_per_beam", "CRPS": "crps_m"}


def cell(score, key):
    """The figure of a score, or none: baselines have no likelihood, and always hit has no precision of misses."""
    return [] if score.get(key) is None else [score[key]]


def study(name, options="", before="", **more):
    # A study whose verdict falls short exits 1, and its figures count all the same.
    return Job(f"study.{name}", f"{before}{STUDY} {name} {options} --json study.json || test -s study.json",
               programs=(STUDY,), **more)
