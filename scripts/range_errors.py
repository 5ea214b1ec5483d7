#!/usr/bin/env python3
"""Where the range errors of a model come from. Prints, as JSON, for level flat, other flat and rough places the share
of the returns of TEST, and medians (m) of the error of a simulated range: as it is drawn (draw), without the draw's
sigma (centre), drawn with the sigma of the element that explains the return best (element), and without both (both);
the median sigma of that element, and the share of the draws that took it. Needs SciPy.

SIMULATED is simulate MODEL --like TEST --matter anew --element-ids. A place is flat where the 30 training returns
nearest to a return of TEST spread less than 3 cm across their plane, or less than an eighth of what they do in it."""
import argparse
import json
import pathlib

import numpy
from scipy.spatial import cKDTree

from ply_columns import TYPES, read

NEAR = 12  # elements that may explain a return


def elements(path):
    """The tables of a model's PLY file, by name."""
    head, _, body = path.read_bytes().partition(b"end_header\n")
    tables, at, columns = {}, 0, []
    for words in [line.split() for line in head.decode().splitlines()] + [["element", "", "0"]]:
        if words[:1] == ["property"]:
            corners = [("corners", "u1"), *((f"corner{k}", "<i4") for k in range(3))]
            columns += corners if words[1] == "list" else [(words[2], TYPES[words[1]])]
        elif words[:1] == ["element"]:
            if columns:
                tables[name] = numpy.frombuffer(body, numpy.dtype(columns), count, at)
                at += tables[name].nbytes
            name, count, columns = words[1], int(words[2]), []
    return tables


def xyz(table, names=("x", "y", "z")):
    return numpy.stack([table[n].astype(float) for n in names], axis=1)


class Model:
    """The elements of a model without a surface: ground triangles, then ellipsoids."""

    def __init__(self, folder):
        facts = json.loads((folder / "model.json").read_text())
        ground, ball = elements(folder / "ground.ply"), elements(folder / "ellipsoids.ply")["vertex"]
        face, origin = ground["face"], numpy.array(facts["origin_m"])
        corner = [xyz(ground["vertex"])[face[f"corner{k}"]] + origin for k in range(3)]
        normal = numpy.cross(corner[1] - corner[0], corner[2] - corner[0])
        rough = face["roughness"] if "roughness" in face.dtype.names else facts["ground"].get("roughness_m", 0)
        self.triangles, self.rough = len(face), numpy.broadcast_to(rough, len(face)).astype(float)
        self.noise = facts["ground"]["range_sigma_m"]
        self.offset = numpy.zeros(1 << 16)  # of the channels
        for channel in facts.get("channels", []):
            self.offset[channel["ring"]] = channel["range_offset_m"]
        self.corner = corner
        self.normal = normal / numpy.linalg.norm(normal, axis=1, keepdims=True)
        self.centre = numpy.concatenate((sum(corner) / 3, xyz(ball) + origin))
        names = ("xx", "xy", "xz", "xy", "yy", "yz", "xz", "yz", "zz")
        self.inverse = numpy.linalg.inv(xyz(ball, [f"cov_{n}" for n in names]).reshape(-1, 3, 3))
        self.p, self.density = face["p_hit"].astype(float), ball["density"].astype(float)
        self.tree = [cKDTree(self.centre[: self.triangles]), cKDTree(self.centre[self.triangles:])]

    def meet(self, element, origin, direction):
        """Returns t, sigma and p of rays at one element each; p is 0 outside of it."""
        to = self.centre[element] - origin
        t, sigma, p = (numpy.zeros(len(element)) for _ in range(3))
        flat = element < self.triangles
        n = self.normal[element[flat]]
        cosine = numpy.einsum("ij,ij->i", n, direction[flat])
        cosine = numpy.copysign(numpy.maximum(abs(cosine), 0.01), cosine)
        t[flat] = numpy.einsum("ij,ij->i", n, to[flat]) / cosine
        sigma[flat] = numpy.hypot(self.noise, self.rough[element[flat]] / cosine)
        p[flat] = self.p[element[flat]]
        at = origin[flat] + t[flat, None] * direction[flat]
        for k in range(3):
            a, b = self.corner[k][element[flat]], self.corner[(k + 1) % 3][element[flat]]
            p[flat] *= numpy.einsum("ij,ij->i", numpy.cross(b - a, at - a), n) >= -1e-6
        w = numpy.einsum("ijk,ik->ij", self.inverse[element[~flat] - self.triangles], direction[~flat])
        per = numpy.einsum("ij,ij->i", w, direction[~flat])
        t[~flat] = numpy.einsum("ij,ij->i", w, to[~flat]) / per
        sigma[~flat] = per**-0.5
        off = to[~flat] - t[~flat, None] * direction[~flat]
        square = numpy.einsum("ij,ijk,ik->i", off, self.inverse[element[~flat] - self.triangles], off)
        depth = self.density[element[~flat] - self.triangles] * sigma[~flat] * (2 * numpy.pi) ** 0.5
        p[~flat] = numpy.where(square <= 9, -numpy.expm1(-depth * numpy.exp(-square / 2)), 0)
        return t, sigma, p

    def best(self, drawn, ends, origin, direction, ranges):
        """Returns t, sigma and the number of the element, the drawn or a near one, that explains a range best."""
        near = [drawn[:, None]]
        for tree, first in zip(self.tree, (0, self.triangles)):
            near.append(tree.query(ends, min(NEAR, tree.n))[1].reshape(len(ends), -1) + first)
        best, out = numpy.full(len(ends), -1.0), numpy.zeros((3, len(ends)))
        for element in numpy.concatenate(near, axis=1).T:
            t, sigma, p = self.meet(element, origin, direction)
            f = p / sigma * numpy.exp(-0.5 * ((ranges - t) / sigma) ** 2)
            better = f > best
            best[better] = f[better]
            out[:, better] = numpy.stack((t, sigma, element))[:, better]
        return out


def kinds(train, ends):
    """Whether the training returns around each end are level and flat (0), flat (1) or rough (2)."""
    around = train[cKDTree(train).query(ends, 30)[1]]
    around = around - around.mean(axis=1, keepdims=True)
    value, axes = numpy.linalg.eigh(numpy.einsum("nki,nkj->nij", around, around) / 29)
    value = numpy.sqrt(numpy.maximum(value, 0))
    flat = (value[:, 0] < 0.4 * value[:, 1]) & ((value[:, 0] < 0.03) | (value[:, 0] < value[:, 1] / 8))
    return numpy.where(flat, numpy.where(abs(axes[:, 2, 0]) > 0.9, 0, 1), 2)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    for name in ("model", "train", "test", "simulated"):
        parser.add_argument(name, type=pathlib.Path)
    parser.add_argument("--every", type=int, default=1, help="take every K-th beam [1]")
    options = parser.parse_args()
    model = Model(options.model)
    (train, train_range), (test, ranges), (simulated, drawn) = map(
        read, (options.train, options.test, options.simulated))
    rows = numpy.flatnonzero(~numpy.isnan(ranges) & ~numpy.isnan(drawn))[:: options.every]
    ends, back = xyz(test[rows]), xyz(test[rows], ("nx", "ny", "nz"))
    origin, direction = ends + back, -back / ranges[rows, None]
    ranges, drawn = ranges[rows] - model.offset[test["ring"][rows]], drawn[rows] - model.offset[test["ring"][rows]]
    element = simulated["element"][rows].astype(int)
    centre = model.meet(element, origin, direction)[0]
    t, sigma, best = model.best(element, ends, origin, direction, ranges)
    noise = numpy.random.default_rng(1).standard_normal(len(rows))
    error = {"draw": drawn - ranges, "centre": centre - ranges,
             "element": t + sigma * noise - ranges, "both": t - ranges}
    kind = kinds(xyz(train[~numpy.isnan(train_range)]), ends)
    out = {}
    for k, name in enumerate(("level", "flat", "rough")):
        at = kind == k
        out[name] = {"share": at.mean(), **{key: numpy.median(abs(e[at])) for key, e in error.items()},
                     "sigma": numpy.median(sigma[at]), "taken": (best == element)[at].mean()}
    print(json.dumps({kind: {key: round(float(x), 4) for key, x in of.items()} for kind, of in out.items()}, indent=1))


if __name__ == "__main__":
    main()
