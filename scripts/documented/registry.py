"""Which commands make each documented table, which figure of their results stands in which cell, and the tolerances.

Scores do not depend on the machine, so their tables have no tolerance beyond the last digit. Rates do, so of the
benchmarks only counts and ratios of times from one run are compared.
"""
import pathlib
import sys

from . import light, matter, registry_bench, registry_evidence, registry_moving, registry_scenes, registry_software
from . import registry_summary
from .common import BASELINES, HALVES, KEYS, LOGS, REAL_LOGS, STUDY, study
from .jobs import Job, Measured, Part, read_json, read_rows
from .tables import HEADING

SOURCE = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(SOURCE / "tests/rules"))
import readme  # noqa: E402

# ---------------------------------------------------------------------------------------------- the real logs


def model_job(log, model):
    """The scores of one model on one log, as `scripts/real_logs.py` prints them."""
    return Job(f"real_logs.{log}.{model}", f"{REAL_LOGS} --reuse --only {log} --models {model} --markdown table.md",
               (LOGS[log],), (HALVES[log],))


FIRST = ["capped error, m", "informedness", "F1 of misses"]
SCORES = ["packet error, m", "precision", "recall", "F1", "cloud error, m", "median range error, m", "NLL/beam",
          "CRPS, m"]
OBJECTIVE = "packet error + 2(1 − F1)"


def scores(folder):
    """{heading: figure} of the one row that `scripts/real_logs.py` printed."""
    row = read_rows(folder / "table.md")[0]
    return {heading: float(cell) for heading, cell in row.items() if heading not in ("log", "model")}


def real_logs(models):
    def part(log, model):
        def cells(folder):
            s = scores(folder)
            yield f"{log}/{models[0]}", "log", [s["beams"]]
            for heading in SCORES:
                yield f"{log}/{model}", heading, [s[heading]]
        return Part((model_job(log, model),), cells)

    def beside(log):
        def cells(folder):
            compared = read_json(folder / "scores.json")
            for model in models:
                yield from ((f"{log}/{model}", heading, [compared["models"][model][KEYS[heading]]]) for heading in FIRST)
            for name, s in compared["baselines"].items():
                yield from ((f"{log}/{name}", heading, [s[KEYS[heading]]]) for heading in FIRST + SCORES
                            if KEYS.get(heading) in s)
        return Part((compared_job(log),), cells)
    return tuple(part(log, model) for log in LOGS for model in models) + tuple(beside(log) for log in LOGS)


def reliability(models):
    """Calibration errors. A baseline predicts a return with probability 1 or 0, as it answers, and *constant* with the
    share of returns of the training half."""
    def part(log, model):
        return Part((model_job(log, model),), lambda folder: [(log, model, [scores(folder)["calibration error"]])])

    def beside(log):
        def cells(folder):
            compared = read_json(folder / "scores.json")["baselines"]
            for name in BASELINES:
                s = compared[name]
                yield log, name, [(s["false_hits"] + s["false_misses"]) / s["beams"]]
        return Part((compared_job(log),), cells)

    def constant(log):
        def cells(folder):
            train, test = (read_json(folder / f"{half}.json") for half in ("train", "test"))
            yield log, "constant", [abs(train["hits"] / train["beams"] - test["hits"] / test["beams"])]
        job = Job(f"shares.{log}", "\n".join(f'underbrush info "$WORK/{log}/{half}.ply" --json {half}.json'
                                             for half in ("train", "test")), (LOGS[log],), (HALVES[log],))
        return Part((job,), cells)
    return tuple(made for log in LOGS for made in (*(part(log, model) for model in models), beside(log), constant(log)))


def fitters(models):
    def part(log, model):
        def cells(folder):
            s = scores(folder)
            yield model, log, [s["packet error, m"], s["F1"], s["NLL/beam"], s["ellipsoids"]]
        return Part((model_job(log, model),), cells)
    return tuple(part(log, model) for log in LOGS for model in models) + tuple(baselines(log) for log in LOGS)


ON_REAL_LOGS = ("default", "median", "sharp", "surface", "surface_carved", "mesh_primitives")


def compared_job(log):
    """The scores that do not need a model, of the simulated logs and of what a simulator must beat."""
    models = (*ON_REAL_LOGS, "no_keyframes")
    return Job(f"compared.{log}", f"""cd "$WORK/{log}"
underbrush score test.ply {" ".join(f"{model}.ply" for model in models)} --train train.ply --json "$OLDPWD/scores.json"
""", (LOGS[log],), tuple(model_job(log, model) for model in models))


def baselines(log):
    def cells(folder):
        for name, s in read_json(folder / "scores.json")["baselines"].items():
            yield name, log, [s[KEYS["packet error, m"]], s[KEYS["F1"]]]
    return Part((compared_job(log),), cells)


def tuning():
    def part(log):
        def cells(default, tuned):
            before, after = scores(default), scores(tuned)
            yield log, "objective", [before[OBJECTIVE], after[OBJECTIVE]]
            for heading in ("packet error, m", "F1", "NLL/beam", "CRPS, m"):
                yield log, heading, [before[heading], after[heading]]
        return Part((model_job(log, "default"), model_job(log, "tuned")), cells)

    def beside(log):
        def cells(folder):
            for name, s in read_json(folder / "scores.json")["baselines"].items():
                yield log, f"{name}, objective", [s[KEYS["packet error, m"]] + 2 * (1 - s[KEYS["F1"]])]
        return Part((compared_job(log),), cells)
    return tuple(made for log in LOGS for made in (part(log), beside(log)))


def score_job(name, log, fit, simulate):
    """Fits a log of WORK with these options, simulates it with those, and scores it."""
    return Job(name, f"""underbrush fit "$WORK/{log}/train.ply" --min-range 2 {fit} -o model
underbrush simulate model --like "$WORK/{log}/test.ply" {simulate} -o sim.ply
underbrush score "$WORK/{log}/test.ply" sim.ply --model model --name model --json scores.json
rm -r model sim.ply""", (LOGS[log],), (HALVES[log],))


def options_of_fit():
    paper = '--config "$SOURCE/share/configs/primitives-paper.yaml"'
    rows = {"default": ("", ""), "--ellipsoid-prior-hits 1": ("--ellipsoid-prior-hits 1", ""),
            "--fitter hierarchical": ("--fitter hierarchical", ""),
            "--config share/configs/primitives-paper.yaml": (paper, ""),
            "this, simulated as published": (paper, "--draw volumetric --matter anew")}

    def part(number, row, fit, simulate):
        def cells(folder):
            s = read_json(folder / "scores.json")["models"]["model"]
            for column in ("capped error, m", "informedness", "packet error, m", "F1", "cloud error, m",
                           "median range error, m", "NLL", "CRPS"):
                yield row, column, [s[KEYS[column]]]
        return Part((score_job(f"options_of_fit.{number}", "kitti_0027_forest", fit, simulate),), cells)

    def baselines(folder):
        for row, column, numbers in look_up(folder):
            log, source = row.split("/")
            if log == "kitti_0027_forest" and source in ("look-up, 2 scans", "always hit"):
                yield source, column.replace("F1 of hits", "F1"), numbers
    return (*(part(number, row, *words) for number, (row, words) in enumerate(rows.items())), Part((LOOK_UP,), baselines))


# ------------------------------------------------------------------------------------------------- the studies


LOOK_UP = study("look-up", "--data logs",
                "mkdir logs\n" + "".join(f'ln -s "$WORK/{log}" logs/\n' for log in LOGS),
                needs=tuple(LOGS.values()), after=tuple(HALVES.values()))


LOOK_UP_KEYS = {"informedness": "informedness", "F1 of misses": "f1_of_misses", "F1 of hits": "f1",
                **{column: KEYS[column] for column in ("capped error, m", "packet error, m", "cloud error, m",
                                                       "median range error, m")}}


def look_up(folder):
    for log, sources in read_json(folder / "study.json")["figures"].items():
        for source, s in sources.items():
            yield f"{log}/{source}", "roughness, cm", [100 * s["roughness_m"]]
            yield from ((f"{log}/{source}", column, [s[key]]) for column, key in LOOK_UP_KEYS.items())


def label_path(folder):
    path = read_json(folder / "path.json")
    for name in path["iou_before"]:
        yield name, "IoU of the proposal", [path["iou_before"][name]]
        yield name, "IoU after", [path["iou_after"][name]]


def vegetation(folder):
    targets = {"planes": "planes", "high tree": "tree_high", "medium tree": "tree_medium", "low tree": "tree_low",
               "tall grass": "tall_grass", "short grass": "short_grass"}
    rows = {"surface, cone / axis": ("surface, cone", "surface, axis")}
    rows |= {row: (row,) for row in ("default", "default with options", "default with options, anew", "voxel", "top_down",
                                     "bottom_up", "hierarchical", "likelihood")}
    figures = read_json(folder / "study.json")["figures"]["static"]
    for column, target in targets.items():
        for baseline in BASELINES:
            yield baseline, column, [figures[target]["baselines"][baseline]]
        for row, models in rows.items():
            yield row, column, [figures[target]["models"][model]["distance"] for model in models]


def transfer(folder):
    sensors = {"HDL-64E": "velodyne-hdl64e", "VLP-16": "velodyne-vlp16", "OS1-64": "ouster-os1-64",
               "wide": "velodyne-vlp16 of 4 x the divergence"}
    figures = read_json(folder / "study.json")["figures"]
    for row, to in sensors.items():
        answers = {(f"simulated {row}", "always hit"): "always hit"}
        for column, learnt in sensors.items():
            answers[f"simulated {row}", column] = learnt
            answers[f"{row} by look-up", column] = f"look-up, {learnt}"
        for place, name in answers.items():
            s = figures[to][name]
            yield *place, [s["f1"], s["informedness"], s["cloud_error_m"]]


def verification(folder):
    f = read_json(folder / "study.json")["figures"]
    yield "simulated, mean patch distance, mm", "ours", [1000 * f["miniature"]["mean_patch_distance_m"]]
    yield "real (here a second ray caster), mm", "ours", [1000 * f["miniature"]["real_mean_patch_distance_m"]]
    for row, which in (("histograms, one scan", "miniature"), ("the same, instrument", "miniature_again"),
                       ("histograms, 16 scans: mean", "miniature_scans"),
                       ("histograms, 16 scans, all", "miniature_scans_all_sub_rays")):
        yield row, "ours", [f[which]["histogram_mean_share_difference"],
                            f[which]["histogram_largest_share_difference"]]


PLANTS = {"cartoon of three cones": "cartoon, three cones", "cartoon of a ball": "cartoon, a ball",
          "shrub, leaves of 1 m": "shrub 1000 mm", "shrub, leaves of 0.25 m": "shrub 250 mm",
          "shrub, leaves of 20 mm": "shrub 20 mm", "conifer, needles of 0.15 m": "conifer 150 mm",
          "conifer, needles of 8.5 mm": "conifer 8.5 mm"}


def leaves_of_plants(folder):
    plants = read_json(folder / "study.json")["figures"]["plants"]
    for row, plant in PLANTS.items():
        yield row, "ε", [plants[plant]["epsilon"]]


def epsilon(row):
    return lambda folder: [(row, "ε", [read_json(folder / "info.json")["epsilon"]])]


def leaves_job(name, importing, *after, needs=()):
    return Job(f"leaves.{name}", f"{importing}\nunderbrush info log.ply --leaves vegetation --json info.json\n"
               "rm log.ply", needs, after)


FOUR_SCANS = """underbrush import "{0}" --poses "{0}/poses_velo.txt" --deskew velodyne-hdl64e \\
  --elevation-offset-deg 0.205 --infer-misses velodyne-hdl64e --frames 0:4 -o log.ply"""


def ground(row, *methods):
    def cells(folder):
        for method in methods:
            yield row, method, [read_json(folder / f"{method}.json")["ground_score"]["iou"]]
    return cells


def conifers(folder):
    s = read_json(folder / "trees.json")["tree_score"]
    yield "MixedConifer", "trees found", [s["found"], s["truth"], s["matched"]]
    yield "MixedConifer", "precision", [s["precision"]]
    yield "MixedConifer", "recall", [s["recall"]]


def sites(*folders):
    trees = [read_json(folder / "site.json") for folder in folders]
    row = "generated site"
    yield row, "lower_envelope", [s["ground_score"]["iou"] for s in trees]
    yield row, "trees found", ([s["tree_score"]["found"] for s in trees] + [trees[0]["tree_score"]["truth"]]
                               + [s["tree_score"]["matched"] for s in trees])
    for key in ("precision", "recall"):
        yield row, key, [s["tree_score"][key] for s in trees]


METHODS = ("lower_envelope", "spherical_variance")
BOTH_METHODS = "\n".join(f"underbrush segment log.ply --ground-method {name} --json {name}.json" for name in METHODS)
SEGMENTATION = (
    Part((Job("segment.kitti00_labelled", 'underbrush import "$DATA/kitti00_labelled/kitti00_000000.bin" '
                      '--labels "$DATA/kitti00_labelled/kitti00_000000.label" -o log.ply\n' + BOTH_METHODS,
                      ("kitti00_labelled/kitti00_000000.bin",)),), ground("kitti00_labelled", *METHODS)),
    Part((Job("segment.rellis_000104", 'underbrush import "$DATA/rellis_000104/000104.bin" --label-set rellis '
                      '--labels "$DATA/rellis_000104/000104.label" -o log.ply\n' + BOTH_METHODS,
                      ("rellis_000104/000104.bin",)),), ground("rellis_000104", *METHODS)),
    Part((Job("segment.MixedConifer", """xz -dc "$DATA/trees_laz/lidr_MixedConifer.ply.xz" > lidr_MixedConifer.ply
echo "0 481306 3812970 1000 0 0 0 1" > above.txt
underbrush import lidr_MixedConifer.ply --poses above.txt --points-in-world --max-range 2000 -o log.ply
underbrush segment log.ply --truth tree_id --json trees.json""", ("trees_laz/lidr_MixedConifer.ply.xz",)),), conifers),
    Part(tuple(Job(f"segment.site{seed}", f"""underbrush demo --only site --seed {seed} -o demo
underbrush segment demo/train.ply --json site.json
rm -r demo""") for seed in (1, 2, 3)), sites))


def page_job(name, page, needs=()):
    """The commands of a page, as its readers type them."""
    steps = readme.steps((SOURCE / page).read_text(encoding="utf-8"))
    return Job(name, "".join(f"{script}\n" for how, script in steps if how == "run"), needs)


TERRESTRIAL = page_job("page.terrestrial-scan", "docs/how-to/terrestrial-scan.md",
                       needs=("tls_conifers/tls_scan.f32.xz",))


def terrestrial(folder):
    result = read_json(folder / "scores.json")
    yield HEADING, "524 158 odd beams", [result["beams"]]
    for column, model in (("default", "default"), ("median", "median"), ("surface", "mesh")):
        for row, key in KEYS.items():
            yield row, column, [result["models"][model][key]]


def terrestrial_parameters(folder):
    scored = {**read_json(folder / "scores.json")["models"], **read_json(folder / "parameters.json")["models"]}
    for row, model in (("none", "default"), ("--range-noise 0.005", "thin")):
        for column in ("packet error, m", "recall", "F1"):
            yield row, column, [scored[model][KEYS[column]]]


MEASURED = {
    "real-logs": Measured(real_logs(ON_REAL_LOGS)),
    "reliability": Measured(reliability(("default", "sharp", "hierarchical", "surface"))),
    "keyframes": Measured(real_logs(("default", "no_keyframes"))),
    "fitters": Measured(fitters(("default", "hierarchical", "voxel", "top_down", "bottom_up"))),
    "options-of-fit": Measured(options_of_fit()),
    **matter.MEASURED,
    **light.MEASURED,
    "echoes": Measured((Part((TERRESTRIAL,), matter.echoes),)),
    "tuning": Measured(tuning()),
    "vegetation": Measured((Part((study("vegetation"),), vegetation),),
                           uncompared={"published surface / volumetric": "figures of the paper"}),
    **registry_moving.measured(),
    "transfer": Measured((Part((study("transfer"),), transfer),)),
    **registry_scenes.MEASURED,
    "look-up": Measured((Part((LOOK_UP,), look_up),)),
    "segmentation": Measured(SEGMENTATION),
    "verification": Measured((Part((study("verification"),), verification),),
                             uncompared={"published": "figures of the paper"}),
    "leaf-inclinations": Measured((
        Part((study("mesh-fidelity"),), leaves_of_plants),
        Part((leaves_job("rellis_000104", 'underbrush import "$DATA/rellis_000104/000104.bin" --label-set rellis '
                         '--labels "$DATA/rellis_000104/000104.label" -o log.ply',
                         needs=("rellis_000104/000104.bin",)),), epsilon("rellis_000104")),
        Part((leaves_job("marv_forest", 'ln -s "$WORK/marv_forest/log.ply" log.ply', HALVES["marv_forest"]),),
             epsilon("marv_forest")),
        Part((leaves_job("tls_conifers", 'ln -s "$JOBS/page.terrestrial-scan/conifers.ply" log.ply', TERRESTRIAL),),
             epsilon("tls_conifers")),
        *(Part((leaves_job(log, FOUR_SCANS.format(f"$WORK/{log}/raw"), HALVES[log]),), epsilon(log))
          for log in LOGS if log.startswith("kitti")))),
    "terrestrial-scan": Measured((Part((TERRESTRIAL,), terrestrial),)),
    "terrestrial-scan-parameters": Measured((Part((TERRESTRIAL,), terrestrial_parameters),)),
    "label-path": Measured((Part((Job(
        "label_path", '"$PYTHON" "$SOURCE/scripts/label_path.py" --program "$BIN/underbrush" --data "$DATA" '
        "--json path.json", needs=("rellis_000104/000104.bin", "rellis_000104/000104.label")),), label_path),)),
    **registry_bench.TABLES,
    **registry_software.tables(LOGS),
}
MEASURED |= registry_evidence.evidence(study, LOGS, HALVES)
MEASURED["validated"] = matter.validated(MEASURED)
VIEWS = registry_summary.VIEWS
MEASURED |= {name: registry_summary.measured(view, MEASURED) for name, view in VIEWS.items()}
