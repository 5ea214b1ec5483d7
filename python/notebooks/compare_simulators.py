# %% [markdown]
# # Compare simulators on your own bag
#
# Which simulator is nearest to your sensor in your terrain? Hold out half of the beams of a recording, let each
# simulator learn from the rest, and score its answers to the beams that it has not seen. This notebook does so for a
# surface mesh, as common simulators use it, and for two models with permeable ellipsoids.
#
# It needs `pip install 'underbrush[formats,plot]'`.

# %%
import pathlib
import subprocess
import tempfile

import numpy as np
from matplotlib import pyplot as plt

import underbrush
from underbrush import cli, formats, plot

work = pathlib.Path(tempfile.mkdtemp())

# %% [markdown]
# ## The recording
#
# Put the path of your bag here (ROS 1, or ROS 2 as SQLite or MCAP). Without one, the example scan is written to a bag
# as Ouster's driver publishes it, with its misses.

# %%
own_bag: pathlib.Path | None = None
command = str(cli.program())
if own_bag is None:
    scan = pathlib.Path(underbrush.__file__).parent / "share/underbrush/examples/marv_forest.pcd"
    subprocess.run([command, "import", str(scan), "-o", str(work / "scan.ply")], check=True)
    bag = work / "drive.mcap"
    print("lost in the bag:", formats.export_log(work / "scan.ply", bag, layout="ouster"))
else:
    bag = own_bag

# %% [markdown]
# `found` says what a recording holds; what it does not say is asked in one line that names the option to add.

# %%
recording = formats.open_recording(bag)
print("\n".join(recording.found()))
info, scans = formats.beams_of_recording(recording)
with underbrush.LogWriter(work / "log.ply", info) as writer:
    for chunk in scans:
        # Beams without a return below -13° meet the robot itself: they mean nothing.
        kept = np.isfinite(chunk.range_m) | (chunk.direction[:, 2] > np.sin(np.radians(-13)))
        names = ("origin", "direction", "range_m", "intensity", "time_s", "ring", "scan", "packet", "flags")
        writer.write(underbrush.log_from_columns(**{name: getattr(chunk, name)[kept] for name in names}, info=info))
print(dict(recording.skipped))

# %% [markdown]
# ## Hold out half of the columns

# %%
subprocess.run([command, "split", str(work / "log.ply"), "--columns", "2", "--train", str(work / "train.ply"),
                "--test", str(work / "test.ply")], check=True)
test = underbrush.read_log(work / "test.ply")

# %% [markdown]
# ## Three simulators, the same beams

# %%
models = {"surface mesh": underbrush.fit(work / "train.ply", fitter="surface"),
          "voxels": underbrush.fit(work / "train.ply", fitter="voxel"),
          "default": underbrush.fit(work / "train.ply")}
simulated = {name: underbrush.simulate(model, like=test, seed=1) for name, model in models.items()}
scores = {name: underbrush.score(test, log, model=models[name]) for name, log in simulated.items()}

print(f"{'':14}{'F1':>6}{'false hits':>12}{'false misses':>14}{'packet error, m':>17}{'CRPS, m':>9}")
for name, score in scores.items():
    s = score.all
    print(f"{name:14}{s.f1:6.3f}{s.false_hits:12}{s.false_misses:14}{s.packet_error_m:17.2f}{s.crps_m:9.2f}")
if own_bag is None:
    assert scores["default"].all.f1 > scores["surface mesh"].all.f1
    assert scores["default"].all.packet_error_m < scores["surface mesh"].all.packet_error_m
    assert scores["surface mesh"].all.false_misses > 2 * scores["default"].all.false_misses
    assert scores["surface mesh"].all.crps_m > 2 * scores["default"].all.crps_m

# %% [markdown]
# No single number decides. F1 says whether the right beams return, the packet error how far off the returns are, and
# CRPS judges the predicted distribution of the range. On the example scan the mesh has nearly the packet error of the
# default, for it keeps every point where it was, but twice the false misses, because beams pass where too few points made
# a surface, and twice the CRPS, because it does not know where it may be wrong.

# %%
figure, panels = plt.subplots(len(models), 1, figsize=(9, 9), layout="constrained")
for panel, (name, log) in zip(panels, simulated.items(), strict=True):
    plot.error_map(test, log, ax=panel)
    panel.set_title(name, loc="right")

# %%
plot.range_error_histogram(scores, log=True)
plot.score_by_range(scores, "median_range_error_m")
