# %% [markdown]
# # Evaluate a perception stack
#
# A simulator is good enough for your perception when your perception decides alike on simulated and on real scans.
# This notebook takes a detector of obstacles, a few lines of NumPy that stand for your own, runs it on held-out real
# beams and on simulations of the same beams, and counts where its decisions differ.
#
# It needs `pip install 'underbrush[plot]'`.

# %%
import pathlib
import subprocess
import tempfile

import numpy as np
import numpy.typing as npt
from matplotlib import pyplot as plt
from matplotlib.colors import ListedColormap

import underbrush
from underbrush import cli, plot

work = pathlib.Path(tempfile.mkdtemp())
scan = pathlib.Path(underbrush.__file__).parent / "share/underbrush/examples/marv_forest.pcd"
command = str(cli.program())
subprocess.run([command, "import", str(scan), "--unknown-below-deg", "-13", "-o", str(work / "log.ply")], check=True)
subprocess.run([command, "split", str(work / "log.ply"), "--columns", "2", "--train", str(work / "train.ply"),
                "--test", str(work / "test.ply")], check=True)
test = underbrush.read_log(work / "test.ply")

# %% [markdown]
# ## The detector
#
# It divides the ground around the vehicle into cells of 0.5 m. A cell whose points span more than 0.4 m of height
# below the vehicle's own height is an obstacle, one with points of less is free, and one without points is unknown.

# %%
CELL_M, REACH_M, TOO_HIGH_M, CLEARANCE_M = 0.5, 12.0, 0.4, 1.5
UNKNOWN, FREE, OBSTACLE = 0, 1, 2


def obstacles(log: underbrush.BeamLog) -> npt.NDArray[np.uint8]:
    """The grid (48, 48) of decisions around the origin of a log's first beam, x by y."""
    points = log.end_points()[np.isfinite(log.range_m)] - log.origin[0]
    points = points[(np.abs(points[:, :2]) < REACH_M).all(axis=1)]
    side = int(2 * REACH_M / CELL_M)
    cell = ((points[:, :2] + REACH_M) / CELL_M).astype(int)
    number = cell[:, 0] * side + cell[:, 1]
    lowest = np.full(side * side, np.inf)
    np.minimum.at(lowest, number, points[:, 2])
    reached = points[:, 2] < lowest[number] + CLEARANCE_M  # crowns above the vehicle do not stop it
    highest = np.full(side * side, -np.inf)
    np.maximum.at(highest, number[reached], points[reached, 2])
    out = np.where(np.isinf(lowest), UNKNOWN, np.where(highest - lowest > TOO_HIGH_M, OBSTACLE, FREE))
    return out.astype(np.uint8).reshape(side, side)


real = obstacles(test)
print("real scan:", {name: int((real == k).sum()) for k, name in enumerate(("unknown", "free", "obstacle"))})

# %% [markdown]
# ## The same detector on simulated scans
#
# Every simulation answers exactly the beams of the real scan, so a different decision comes from the simulator alone.
# The yardstick is the sampling noise of the real scan: the other half of its columns shows the same place.

# %%
other_half = underbrush.read_log(work / "train.ply")
logs = {"other real half": other_half}
models = {"surface mesh": underbrush.fit(work / "train.ply", fitter="surface"),
          "default": underbrush.fit(work / "train.ply"),
          "sharp": underbrush.fit(work / "train.ply", sharpness=2.0)}
for name, model in models.items():
    logs[name] = underbrush.simulate(model, like=test, seed=1)


def compared(decision: npt.NDArray[np.uint8]) -> tuple[float, float, float]:
    """Share of equal decisions, and precision and recall of obstacles, against those on the real scan."""
    both = (decision == OBSTACLE) & (real == OBSTACLE)
    return (float((decision == real).mean()), float(both.sum() / max((decision == OBSTACLE).sum(), 1)),
            float(both.sum() / max((real == OBSTACLE).sum(), 1)))


decisions = {name: obstacles(log) for name, log in logs.items()}
results = {name: compared(decision) for name, decision in decisions.items()}
print(f"{'':18}{'equal cells':>12}{'precision':>11}{'recall':>8}")
for name, (equal, precision, recall) in results.items():
    print(f"{name:18}{equal:12.1%}{precision:11.1%}{recall:8.1%}")
for name in ("default", "sharp"):
    assert results[name][0] > results["surface mesh"][0] and results[name][2] > results["surface mesh"][2]

# %% [markdown]
# Both models decide as the real scan does in more cells than the mesh, and nearly in as many as the other half of the
# real columns. The mesh misses a third of the obstacles; what it reports it reports most precisely.

# %% [markdown]
# ## Where the decisions differ

# %%
COLOURS = ListedColormap(["#FFFFFF", "#56B4E9", "#D55E00"])  # unknown, free, obstacle
figure, panels = plt.subplots(1, 1 + len(decisions), figsize=(13, 3.6), sharey=True, layout="constrained")
for panel, (name, decision) in zip(panels, {"real scan": real, **decisions}.items(), strict=True):
    panel.imshow(decision, cmap=COLOURS, vmin=0, vmax=2, origin="lower",
                 extent=(-REACH_M, REACH_M, -REACH_M, REACH_M))
    panel.set_title(name)
    panel.set_xlabel("y, m")
panels[0].set_ylabel("x, m")

# %% [markdown]
# A beam-wise score of the same simulation shows why: false hits in free space become obstacles that are not there,
# false misses become free cells that are not free.

# %%
ax = plot.error_map(test, logs["sharp"])
ax.set_title("sharp", loc="right")
