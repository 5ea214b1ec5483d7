"""Vertical sections through logs, models and scenes."""
from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.collections import EllipseCollection, LineCollection

from underbrush._core import BeamLog, Model, Scene, TriangleMesh
from underbrush.logs import ellipsoid_axes
from underbrush.plot._figure import AMOUNT, KINDS, Array, axes_or_new

_LEAST_SIGMA_M = 1e-4  # flatter ellipsoids are drawn as if they were that thick


def ellipses_in_plane(mean: Array, sigma: Array, axes: Array, point: Array, in_plane: Array,
                      contour: float = 1.0) -> tuple[npt.NDArray[np.int64], Array, Array, Array]:
    """Cuts ellipsoids, each within `contour` standard deviations of its mean, by a plane.

    `mean` (n, 3) m; `sigma` (n, 3) m and `axes` (n, 3, 3) as `ellipsoid_axes` gives them; the plane holds `point` (3,)
    m and is spanned by the orthonormal rows of `in_plane` (2, 3). Returns the indices (k,) of the ellipsoids that the
    plane meets, and of their ellipses the centres (k, 2) m from the point along the two directions, the semi-axes
    (k, 2) m, the longer first, and the angles (k,) rad of the longer ones from the first direction.
    """
    scaled = axes / np.maximum(sigma, _LEAST_SIGMA_M)[:, None, :]  # columns: axis / sigma
    across = np.einsum("ki,nij->nkj", in_plane, scaled)  # (n, 2, 3): the plane's directions, in standard deviations
    offset = np.einsum("ni,nij->nj", point - mean, scaled)
    form = np.einsum("nij,nkj->nik", across, across)  # q(y) = y' form y + 2 linear y + |offset|²
    linear = np.einsum("nij,nj->ni", across, offset)
    centre = -np.linalg.solve(form, linear[:, :, None])[:, :, 0]
    left = contour**2 - (np.einsum("nj,nj->n", offset, offset) + np.einsum("ni,ni->n", linear, centre))
    met = np.flatnonzero(left > 0)
    values, vectors = np.linalg.eigh(form[met])  # rising: the first belongs to the longer semi-axis
    half = np.sqrt(left[met, None] / values)
    return met, centre[met], half, np.arctan2(vectors[:, 1, 0], vectors[:, 0, 0])


def segments_in_plane(vertices: Array, triangles: npt.NDArray[np.uint32], point: Array, normal: Array) -> Array:
    """Cuts triangles by a plane; returns the ends (k, 2, 3), m, of the segments."""
    above = (vertices - point) @ normal
    corner = above[triangles]
    cut = np.flatnonzero((corner.min(axis=1) < 0) & (corner.max(axis=1) >= 0))
    ends = []
    for a, b in ((0, 1), (1, 2), (2, 0)):
        i, j = triangles[cut, a], triangles[cut, b]
        crosses = (above[i] < 0) != (above[j] < 0)
        share = np.divide(above[i], above[i] - above[j], out=np.zeros(len(cut)), where=crosses)
        place = vertices[i] + share[:, None] * (vertices[j] - vertices[i])
        ends.append(np.where(crosses[:, None], place, np.nan))
    three = np.stack(ends, axis=1)
    order = np.argsort(np.isnan(three[:, :, 0]), axis=1, kind="stable")[:, :2]
    return np.take_along_axis(three, order[:, :, None], axis=1)


class _Plane:
    """The vertical plane through two places, seen from its right side: s along the ground, z up."""

    def __init__(self, start: npt.ArrayLike, end: npt.ArrayLike) -> None:
        self.start = np.asarray(start, dtype=float)[:2]
        way = np.asarray(end, dtype=float)[:2] - self.start
        self.length_m = float(np.hypot(*way))
        if not self.length_m > 0:
            raise ValueError("section: start and end are the same place")
        self.along = way / self.length_m
        self.in_plane = np.array([[*self.along, 0.0], [0.0, 0.0, 1.0]])
        self.normal = np.array([-self.along[1], self.along[0], 0.0])
        self.point = np.array([*self.start, 0.0])

    def place(self, points: Array) -> Array:
        """(…, 2): distance from the start along the plane, and height, m."""
        return np.asarray((points - self.point) @ self.in_plane.T)

    def within(self, s: Array, margin: Array | float = 0.0) -> npt.NDArray[np.bool_]:
        """Whether a distance lies between start and end."""
        return np.asarray((s + margin >= 0) & (s - margin <= self.length_m))


def _parts(world: Model | Scene) -> Iterator[tuple[Model, float, Array, Array]]:
    """The models of a world with scale, rotation (3, 3) and position (3,) of each."""
    if isinstance(world, Model):
        yield world, 1.0, np.eye(3), np.asarray(world.origin)
        return
    copies = [world.copy_model(k) for k in range(world.models)]
    for k, model in enumerate(world.model):
        x, y, z, w = world.rotation[k]
        turned = np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                           [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                           [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])
        yield copies[model], float(world.scale[k]), turned, world.position[k]


def _lines(mesh: TriangleMesh, scale: float, turned: Array, position: Array, plane: _Plane) -> Array:
    if not len(mesh):
        return np.empty((0, 2, 2))
    vertices = scale * mesh.vertices.astype(float) @ turned.T + position
    ends = plane.place(segments_in_plane(vertices, mesh.triangles, plane.point, plane.normal))
    return ends[plane.within(ends[:, :, 0]).any(axis=1)]


def _draw_log(log: BeamLog, plane: _Plane, thickness_m: float, ax: Axes) -> None:
    points = log.end_points()[np.isfinite(log.range_m)]
    near = points[np.abs((points - plane.point) @ plane.normal) <= thickness_m / 2]
    place = plane.place(near)
    place = place[plane.within(place[:, 0])]
    ax.plot(place[:, 0], place[:, 1], linestyle="none", marker=".", markersize=1.5, color=KINDS[7],
            label=f"hits within {thickness_m / 2:g} m")


def _draw_world(world: Model | Scene, plane: _Plane, contour: float | None, cmap: str, colorbar: bool,
                ax: Axes) -> None:
    lines, centres, halves, angles, chances = [], [], [], [], []
    for model, scale, turned, position in _parts(world):
        lines += [_lines(mesh, scale, turned, position, plane) for mesh in (model.ground, model.surface)]
        table = model.ellipsoids
        if not len(table):
            continue
        sigma, axes = ellipsoid_axes(table)
        mean = scale * table.mean.astype(float) @ turned.T + position
        met, centre, half, angle = ellipses_in_plane(mean, scale * sigma, turned @ axes, plane.point, plane.in_plane,
                                                     contour or model.tau)
        kept = plane.within(centre[:, 0], half[:, 0])
        centres.append(centre[kept])
        halves.append(half[kept])
        angles.append(angle[kept])
        chances.append(table.hit_probability[met[kept]])
    half = np.concatenate(halves) if halves else np.empty((0, 2))
    shown = EllipseCollection(
        2 * half[:, 0], 2 * half[:, 1], np.degrees(np.concatenate(angles)) if angles else [], units="xy",
        offsets=np.concatenate(centres) if centres else np.empty((0, 2)), offset_transform=ax.transData, cmap=cmap,
        alpha=0.6, linewidth=0)
    shown.set_array(np.concatenate(chances) if chances else np.empty(0))
    shown.set_clim(0, 1)
    ax.add_collection(shown)
    cut = np.concatenate(lines)
    ax.add_collection(LineCollection(list(cut), colors=KINDS[5], linewidths=1.5, label="triangles"))
    corners = np.concatenate([cut.reshape(-1, 2), shown.get_offsets()])
    ax.update_datalim(corners)
    ax.autoscale_view()
    if colorbar:
        ax.figure.colorbar(shown, ax=ax, label="hit probability", shrink=0.7)


def section(what: BeamLog | Model | Scene, start: npt.ArrayLike, end: npt.ArrayLike, *, thickness_m: float = 0.5,
            contour: float | None = None, cmap: str = AMOUNT, colorbar: bool = True, ax: Axes | None = None) -> Axes:
    """Draws the vertical section from `start` to `end` (x y, m, world), the distance from the start to the right.

    The hits of a log within half of `thickness_m` of the plane are points. The ellipsoids of a model or scene that the
    plane cuts are filled ellipses with the colour of their hit probability, and its triangles are lines; the
    ellipses end at `contour` standard deviations, by default at the model's `tau`, beyond which no beam meets them.
    Draw a model first and then its log into the same axes to compare them. Raises `ValueError` where start and end are
    one place.
    """
    plane = _Plane(start, end)
    ax = axes_or_new(ax)
    if isinstance(what, BeamLog):
        _draw_log(what, plane, thickness_m, ax)
    else:
        _draw_world(what, plane, contour, cmap, colorbar, ax)
    ax.set_xlim(0, plane.length_m)
    ax.set_aspect("equal", adjustable="box")
    ax.set_xlabel("distance, m")
    ax.set_ylabel("z, m")
    return ax
