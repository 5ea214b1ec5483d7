# %% [markdown]
# # Compose a forest, for users of HELIOS++
#
# In HELIOS++ a scene is built of meshes and voxels whose gaps somebody has to know. Here the plants are cut out of a
# real scan, with the gaps that its beams found, and planted again where a plan says. The result is a LAS file with the
# fields that HELIOS++ writes, so the scripts that read those go on working.
#
# | HELIOS++ | here |
# |---|---|
# | scene XML, parts with OBJ or voxel files | a ground model, primitives, an annotation (JSON) |
# | scanner and scanner settings | a sensor of the catalogue, or a YAML file |
# | platform and legs | a trajectory of poses |
# | beam sample quality | `super_sample` |
# | LAS output | `formats.export_log(log, "plot.las")` |
#
# It needs `pip install 'underbrush[formats,plot]'`.

# %%
import json
import pathlib
import subprocess
import tempfile

import laspy
import numpy as np

import underbrush
from underbrush import cli, formats, plot

work = pathlib.Path(tempfile.mkdtemp())
scan = pathlib.Path(underbrush.__file__).parent / "share/underbrush/examples/marv_forest.pcd"
subprocess.run([str(cli.program()), "import", str(scan), "--unknown-below-deg", "-13", "-o", str(work / "log.ply")],
               check=True)

# %% [markdown]
# ## Plants from a real scan
#
# `segment` labels ground, trees and shrubs, `fit` learns the model, and `extract` cuts one primitive for each plant.

# %%
labelled = underbrush.segment(work / "log.ply")
model = underbrush.fit(labelled.log, clusters_per_point=0.2)
underbrush.write_model(work / "site", model)
plants = underbrush.extract(model, labelled.log)
print(len(plants), "plants:", {name: plants.labels.count(name) for name in sorted(set(plants.labels))})

# %% [markdown]
# ## The plan of a new stand
#
# An annotation lists what shall stand where. Every object has a class, a place and a box; of each class the primitive
# with the most similar box is taken and scaled if asked to. The ground is that of the scan.

# %%
generator = np.random.default_rng(4)
ground = model.origin + model.ground.vertices
low, high = np.percentile(ground[:, :2], [25, 75], axis=0)
objects = [{"class": "small_tree", "position_m": generator.uniform(low, high).tolist(),
            "yaw_rad": float(generator.uniform(0, 2 * np.pi)), "box_m": {"size": [2.5, 2.5, 4.0]}} for _ in range(12)]
plan = {"format": "underbrush-annotation", "version": 1, "ground": "site", "objects": objects}
(work / "plan.json").write_text(json.dumps(plan))

stand = underbrush.compose(work / "plan.json", plants, nearest=3, seed=2)
print(stand, underbrush.report_of(stand))
ax = plot.section(stand, low, high)
ax.set_title("a section through the composed stand")

# %% [markdown]
# ## A scanner in it
#
# A leg of a survey is a trajectory with one pose or more. Sub-rays of the sensor's own beam (`super_sample`) give
# several returns a pulse, as full-waveform simulation does in HELIOS++.

# %%
centre = (low + high) / 2
height = ground[np.argmin(np.hypot(*(ground[:, :2] - centre).T)), 2] + 1.8
leg = underbrush.Trajectory(np.array([0.0, 0.1]), np.array([[*centre, height]] * 2), np.tile([0, 0, 0, 1.0], (2, 1)))
pulses = underbrush.simulate(stand, sensor="velodyne-vlp16", trajectory=leg, super_sample="2x6", returns="3",
                             element_ids=True, seed=3)
hit = np.isfinite(pulses.range_m)
print(f"{len(pulses)} rows, {hit.mean():.0%} of them returns")
plot.range_image(pulses).set_title("the composed stand, seen by a VLP-16")

# %% [markdown]
# ## LAS, as HELIOS++ writes it
#
# Misses cannot stand in LAS: the writer counts them, and `fullwaveIndex` still numbers every pulse.

# %%
print("not in LAS:", formats.export_log(pulses, work / "plot.las"))
las = laspy.read(work / "plot.las")
print(list(las.point_format.dimension_names))
print("returns by number:", np.bincount(np.asarray(las.return_number)))
trees = np.unique(np.asarray(las["hitObjectId"]))
print(f"{len(las.points)} returns of {len(trees)} objects")
assert len(las.points) == hit.sum() and len(trees) > 3
