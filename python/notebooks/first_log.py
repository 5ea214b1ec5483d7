# %% [markdown]
# # Your first log
#
# A log is every beam that a lidar fired, with its return or its miss. This notebook learns a model from half of one
# real scan under trees, simulates the other half in it, and shows where the simulation is right and where it is wrong.
#
# The scan (an Ouster OS0-128 on a tracked robot) comes with the package. It needs `pip install 'underbrush[plot]'`.

# %%
import pathlib
import subprocess
import tempfile

import numpy as np
from matplotlib import pyplot as plt

import underbrush
from underbrush import cli, plot

work = pathlib.Path(tempfile.mkdtemp())
scan = pathlib.Path(underbrush.__file__).parent / "share/underbrush/examples/marv_forest.pcd"

# %% [markdown]
# ## From a file to a log
#
# The command `underbrush`, which the package installs, converts foreign files. Beams below -13° look at the robot
# itself, so their misses mean nothing. `split` holds out half of the columns, which are not used for the fit.

# %%
command = str(cli.program())
subprocess.run([command, "import", str(scan), "--unknown-below-deg", "-13", "-o", str(work / "log.ply")], check=True)
subprocess.run([command, "split", str(work / "log.ply"), "--columns", "2", "--train", str(work / "train.ply"),
                "--test", str(work / "test.ply")], check=True)

# %% [markdown]
# The columns of a log are NumPy arrays. They are views of the log's memory: nothing is copied.

# %%
log = underbrush.read_log(work / "log.ply")
hit = np.isfinite(log.range_m)  # a miss has the range infinity
print(f"{len(log)} beams, {hit.mean():.0%} of them return, {np.median(log.range_m[hit]):.1f} m away")
plot.range_image(log).set_title("measured: range; misses are grey")

# %% [markdown]
# ## Learn a model
#
# A model is a ground mesh and permeable ellipsoids, each with the probability that a beam which meets it ends there.

# %%
model = underbrush.fit(work / "train.ply", seed=1)
print(model, underbrush.report_of(model)["warnings"])

ax = plot.section(model, start=[-6, -3], end=[8, 8])
plot.section(log, start=[-6, -3], end=[8, 8], thickness_m=0.2, ax=ax)
ax.set_title("a section: ellipsoids, ground and hits")

# %% [markdown]
# ## Simulate and score
#
# `simulate` answers the beams that were held out, and `score` compares them one by one.

# %%
test = underbrush.read_log(work / "test.ply")
simulated = underbrush.simulate(model, like=test, seed=1)
score = underbrush.score(test, simulated, model=model)
print(f"F1 {score.all.f1:.3f}, packet error {score.all.packet_error_m:.2f} m, "
      f"median range error {score.all.median_range_error_m:.2f} m")
assert score.all.f1 > 0.9

# %%
figure, (upper, lower) = plt.subplots(2, 1, figsize=(9, 6), layout="constrained")
plot.range_image(test, ax=upper).set_title("held out")
plot.range_image(simulated, ax=lower).set_title("simulated")

# %% [markdown]
# The map of errors shows that the ground and the trunks are right to centimetres, and that leaves are a matter of
# chance: a beam through a crown ends at another leaf, or behind it.

# %%
plot.error_map(test, simulated)
plot.range_error_histogram(score)
