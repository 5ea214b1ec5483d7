#!/usr/bin/env python3
"""Tests of the configurations in share/configs, each of which is a method of a paper or ours; run as cli_test.py is."""
import json
import pathlib
import struct
import tempfile

import cli_test
from cli_test import call

CONFIGS = pathlib.Path(__file__).resolve().parents[2] / "share" / "configs"
EXAMPLE = CONFIGS.parent / "examples" / "marv_forest.pcd"

# What the papers state, by the names of `fit`: Table I of Tallavajhula et al. 2018 and their published code;
# sections III, V and VI of Deschaud et al. 2012.
PRIMITIVES = {"fitter": "hierarchical", "ground-method": "spherical_variance", "clusters-per-point": "0.042",
              "min-points": "5", "tau": "3.5", "credit": "first", "mixture-rounds": "0",
              "ellipsoid-prior-hits": "0", "ellipsoid-prior-misses": "1", "triangle-prior-hits": "1",
              "triangle-prior-misses": "2", "max-residual-for-hit": "0.75", "covariance-prior": "0",
              "free-space-below": "0", "ranges-as-given": "true"}
VOXELS = {"fitter": "voxel", "ground-method": "none", "voxel-bounded": "true", "tau": "2", "credit": "mahalanobis",
          "ellipsoid-prior-hits": "0", "ellipsoid-prior-misses": "0", "covariance-prior": "0", "free-space-below": "0",
          "ranges-as-given": "true"}
SURFACES = {"fitter": "rimls", "surface-noise": "0.005"}
PAPERS = {
    "primitives-paper": PRIMITIVES,
    "vegetation-paper": {**VOXELS, "voxel-side": "0.3"},
    "vegetation-paper-static": {**VOXELS, "voxel-side": "0.05"},
    "vegetation-surface-mobile": {**SURFACES, "surface-cell": "0.3", "surface-kernel": "0.4",
                                  "surface-least-kernel": "0.4"},
    "vegetation-surface-static": {**SURFACES, "surface-cell": "0.01", "surface-kernel": "0.04",
                                  "surface-least-kernel": "0.04"},
}
OWN = {"likelihood-sharp"}


def settings(path):
    """{option: value} of a configuration without sections."""
    rows = [line.partition(":") for line in path.read_text().splitlines() if not line.startswith("#")]
    return {name: value.strip() for name, _, value in rows}


def probabilities(path):
    """The hit probabilities of a model's ellipsoids; all columns are four bytes wide."""
    data = path.read_bytes()
    end = data.index(b"end_header\n") + len(b"end_header\n")
    names = [line.split()[2].decode() for line in data[:end].splitlines() if line.startswith(b"property")]
    place, row = 4 * names.index("p_hit"), 4 * len(names)
    return [struct.unpack_from("<f", data, at + place)[0] for at in range(end, len(data), row)]


class Configs(cli_test.Failing):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.temporary.name)
        self.write(EXAMPLE, "forest.ply")

    def tearDown(self):
        self.temporary.cleanup()

    def write(self, source, log):
        done = call("import", source, "-o", log, cwd=self.folder)
        self.assertEqual((done.returncode, done.stderr), (0, ""))

    def wall(self):
        """The log of a wall, for the surface whose cells are too fine for a forest."""
        points = "".join(f"3,{0.01 * y:.2f},{0.01 * z:.2f}\n" for y in range(-30, 31) for z in range(-30, 31))
        pathlib.Path(self.folder, "wall.csv").write_text("x,y,z\n" + points)
        self.write("wall.csv", "wall.ply")
        return "wall.ply"

    def fit(self, name, log="forest.ply"):
        """The report of a fit and the manifest of its model."""
        done = call("fit", log, "--config", CONFIGS / f"{name}.yaml", "-o", "model", "--json", "-", cwd=self.folder)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        return json.loads(done.stdout), json.loads(pathlib.Path(self.folder, "model/model.json").read_text())

    def test_each_says_what_the_paper_used(self):
        self.assertEqual({p.stem for p in CONFIGS.glob("*.yaml")}, set(PAPERS) | OWN)
        for name, stated in PAPERS.items():
            with self.subTest(name):
                self.assertEqual(settings(CONFIGS / f"{name}.yaml"), stated)

    def test_fit_makes_the_model_of_the_paper(self):
        for name, stated in PAPERS.items():
            with self.subTest(name):
                report, model = self.fit(name, *[self.wall()] * (name == "vegetation-surface-static"))
                self.assertEqual(model["fitter"], stated["fitter"])
                self.assertEqual(model["tau"], float(stated.get("tau", 3)))
                self.assertEqual(model.get("voxel_m"), float(stated["voxel-side"]) if "voxel-side" in stated else None)
                self.assertFalse({"keyframes", "channels"} & set(model))
                meshes = {part: model[part]["triangles"] for part in ("ground", "surface")}
                if name == "primitives-paper":  # a mesh of the ground, and clusters of what stands on it
                    self.assertEqual(model["ellipsoids"]["count"], int(0.042 * report["other_points"]))
                    self.assertGreater(meshes.pop("ground"), 0)
                elif stated["fitter"] == "voxel":  # voxels alone, of the ground, too
                    self.assertEqual(report["other_points"], report["hits"])
                    self.assertGreater(model["ellipsoids"]["count"], 0)
                else:  # a mesh alone, with the noise of its ranges
                    self.assertEqual(model["ellipsoids"]["count"], 0)
                    self.assertEqual(model["surface"]["range_sigma_m"], 0.005)
                    self.assertGreater(meshes.pop("surface"), 0)
                self.assertFalse(any(meshes.values()), meshes)

    def test_hit_probabilities_are_those_of_the_prior(self):
        """With prior counts of (0, 1) no ellipsoid that was seen is opaque."""
        self.fit("primitives-paper")
        self.assertLess(max(probabilities(self.folder / "model/ellipsoids.ply")), 1)
        self.fit("vegetation-paper")
        self.assertEqual(max(probabilities(self.folder / "model/ellipsoids.ply")), 1)


if __name__ == "__main__":
    cli_test.main()
