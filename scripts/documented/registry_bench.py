"""The tables of the programs under `bench/`, of which ratios are compared and rates are not."""
from .common import HALVES, LOGS
from .jobs import Job, Measured, Part, read_json

RATE = "a rate of one machine"
DRIVE = "kitti_0027_forest"
DRIVE_LOG = {"needs": (LOGS[DRIVE],), "after": (HALVES[DRIVE],)}


def bench(name, options="", case="", **more):
    return Job(f"bench.{name}{case}", f"bench_{name} {options} --json bench.json", programs=(f"bench_{name}",), **more)


def pipeline(column):
    def cells(folder):
        b = read_json(folder / "bench.json")
        for row, key in (("beams", "beams"), ("ellipsoids", "ellipsoids"), ("ground triangles", "ground_triangles"),
                         ("simulate / Embree", "simulate_to_embree_ground_ratio")):
            yield row, column, [b[key]]
    return cells


def bench_fitters(folder):
    for label in ("voxel", "top_down", "bottom_up", "hierarchical", "likelihood",
                  "surface", "rimls"):
        b = read_json(folder / "bench.json")[label]
        yield label, "growth", [b["growth_exponent"]]
        yield label, "elements", [b["elements"]]
        if "clustering_time_of_voxel" in b:
            yield label, "clustering", [b["clustering_time_of_voxel"]]


def memory(folder):
    for row, measured in zip(("once", "twice", "four times"), read_json(folder / "memory.json")):
        yield row, "beams", [measured["beams"]]
        yield row, "peak", [measured["peak_mib"]]
        yield row, "of the first", [measured["factor"]]


def world_costs(folder):
    for measured in read_json(folder / "costs.json"):
        yield f"{measured['verb']}, peak MiB", f"{measured['km2']:g} km²", [measured["peak_mib"]]


MANY_DRIVE = ("annotate", "compose", "simulate, 1 km", "simulate, 5 km", "5 km, Dask", "5 km, Slurm")
MANY_LOGS = ("fit, 3 logs", "fit, 8 logs", "8 logs, Dask", "regions, 8 logs")
MORE_LOGS = ("fit, 16 logs", "regions, 16 logs")
KITTI = ("kitti_0005_city", "kitti_0027_forest", "kitti_0052_static")
OF_KITTI = {"needs": tuple(LOGS[log] for log in KITTI), "after": tuple(HALVES[log] for log in KITTI)}


def many_machines(words, rows, case="", **more):
    """Rows that `scripts/many_machines.py` makes, which fails where a result has other bytes than that of one process."""
    def cells(folder):
        for label, row in zip(rows, read_json(folder / "rows.json")):
            if row["beams"]:
                yield label, "beams", [row["beams"]]
            yield label, "peak MiB", [row["peak_mib"]]
            yield label, "MB", [row["mb"]]
    python = "../python/venv/bin/python"
    return Part((Job(f"many_machines.{words.split()[0]}{case}", f'PYTHONPATH="$BIN/../python/package" "$BIN/{python}" '
                     f'"$SOURCE/scripts/many_machines.py" {words} --program "$BIN/underbrush" --folder work --json rows.json',
                     programs=("underbrush", python), **more),), cells)


def many_logs(options, rows, case=""):
    logs = " ".join(f'"$WORK/{log}/log.ply"' for log in KITTI)
    return many_machines(f"logs {logs} --beams 400000 --pieces 4 {options}", rows, case, **OF_KITTI)


MANY = {"relative": {"peak MiB": 0.25, "MB": 0.05}, "uncompared": dict.fromkeys(("seconds", "processor s", "efficiency"), RATE)}


def trace_goals(folder):
    b = read_json(folder / "bench.json")
    machine = "EPYC" if "AMD" in b["machine"]["processor"] else "Xeon"
    yield "AVX2 / Embree's AVX2 packets", machine, [b["ratio_to_embree_packets_avx2_1e6"]]
    yield "best / Embree's best", machine, [b["ratio_to_embree_best_1e6"]]
    yield "bytes an ellipsoid", machine, [b["bytes_per_element"]]
    yield "bytes an instance", machine, [next(c["bytes_per_instance"] for c in b["cases"] if
                                              (c["scene"], c["elements"]) == ("planted", 1000000))]


def log_formats(log):
    def cells(folder):
        b = next(iter(read_json(folder / "bench.json").values()))
        for ending in ("ply", "ublog"):
            yield log, f"bytes a beam, .{ending}", [b[ending]["bytes_a_beam"]]
    return Part((bench("log_formats", f'--runs 1 "$WORK/{log}/log.ply"', f".{log}", needs=(LOGS[log],),
                       after=(HALVES[log],)),), cells)


TABLES = {
    "log-formats": Measured(
        tuple(log_formats(log) for log in LOGS), relative={"bytes a beam, .ply": 0.01, "bytes a beam, .ublog": 0.05},
        uncompared={f"{done}, MB/s, .{ending}": RATE for done in ("written", "read") for ending in ("ply", "ublog")}),
    "bench-pipeline": Measured(
        (Part((bench("pipeline"),), pipeline("generated site")),
         Part((bench("pipeline", f'"$WORK/{DRIVE}/log.ply"', f".{DRIVE}", **DRIVE_LOG),), pipeline(DRIVE))),
        relative={"simulate / Embree": 0.35},
        uncompared={row: RATE for row in ("fit, beams/s", "fit, ×", "simulate, beams/s", "simulate, ×",
                                          "Embree closest hit")}),
    "bench-fitters": Measured(
        (Part((bench("fitters", "--runs 1"),), bench_fitters),),
        absolute={"growth": 0.25}, relative={"clustering": 0.4},
        uncompared={column: RATE for column in ("M beams/s", "of ½", "of all", "× HDL-64E")}),
    "fit-memory": Measured(
        (Part((Job("bench.fit_memory", f'"$PYTHON" "$SOURCE/bench/fit_memory.py" "$WORK/{DRIVE}/log.ply" '
                   '--program "$BIN/underbrush" --json memory.json', **DRIVE_LOG),), memory),),
        relative={"peak": 0.25, "of the first": 0.15}),
    "world-costs": Measured(
        (Part((Job("bench.world_costs", '"$PYTHON" "$SOURCE/scripts/world_costs.py" mesh_primitives --km2 1 10 100 '
                   '--program "$BIN/underbrush" --folder . --json costs.json'),), world_costs),),
        relative={f"{verb}, peak MiB": 0.15 for verb in ("annotate", "compose", "simulate")},
        uncompared={**{f"{verb}, s": RATE for verb in ("annotate", "compose", "simulate")},
                    "exponent": "of times that depend on what else runs"}),
    "many-machines-drive": Measured(
        (many_machines("drive --km2 10 --km 1 5 --every 100 --pieces 4", MANY_DRIVE),), **MANY),
    "many-machines-logs": Measured(
        (many_logs("--logs 3 8 --engines dask", MANY_LOGS), many_logs("--logs 16 --engines", MORE_LOGS, ".more")), **MANY),
    "trace-goals": Measured(
        (Part((bench("trace"),), trace_goals),),
        relative={"AVX2 / Embree's AVX2 packets": 0.35, "best / Embree's best": 0.35},
        uncompared={"goal": "goals are set, not measured",
                    **dict.fromkeys(("EPYC", "Xeon"), "of the machine at hand the ratios and bytes alone are compared")}),
}
