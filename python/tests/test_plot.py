"""Pictures: the data of their artists, not their pixels."""
from __future__ import annotations

import json
import pathlib
import struct
from typing import Any

import numpy as np
import pytest

import underbrush
from underbrush import _core

matplotlib = pytest.importorskip("matplotlib", reason="matplotlib is not installed: pip install 'underbrush[plot]'")
matplotlib.use("Agg")
from matplotlib import pyplot as plt  # noqa: E402

from underbrush import plot  # noqa: E402


@pytest.fixture(autouse=True)
def closed() -> Any:
    """Closes the figures of a test."""
    yield
    plt.close("all")


@pytest.fixture(scope="module")
def simulated(log: underbrush.BeamLog, model: underbrush.Model) -> underbrush.BeamLog:
    """The log's beams in the model."""
    return underbrush.simulate(model, like=log)


def small_scan() -> underbrush.BeamLog:
    """Five rings of 80 beams around the sensor; ring k has the elevation (k - 2) * 0.1 rad and the range 1 + k."""
    ring, step = np.divmod(np.arange(400), 80)
    azimuth, elevation = np.pi - (step + 0.5) * 2 * np.pi / 80, 0.1 * (ring - 2)
    direction = np.stack([np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth),
                          np.sin(elevation)], axis=1)
    return underbrush.log_from_columns(origin=np.zeros((400, 3)), direction=direction, range_m=1.0 + ring,
                                       ring=ring.astype(np.uint16), packet=step.astype(np.uint32),
                                       scan=np.full(400, 3, np.uint32))


def test_panorama_places_rings_and_azimuths() -> None:
    log = small_scan()
    where = plot.panorama(log)
    assert where.row.shape == (5, 80) and np.allclose(where.elevation_rad, 0.1 * np.array([2, 1, 0, -1, -2]))
    assert np.array_equal(where.image(log.range_m)[:, 7], [5, 4, 3, 2, 1])  # the highest ring on top
    assert where.left_rad > 3 and where.right_rad < -3  # the left of the sensor is on the left
    shown = where.image(np.arctan2(log.direction[:, 1], log.direction[:, 0]))
    assert (np.diff(shown, axis=1) <= 0).all()
    with pytest.raises(ValueError, match="scan 4"):
        plot.panorama(log, 4)


def test_panorama_is_in_the_sensors_frame() -> None:
    log = small_scan()
    turn = np.array([0, 0, np.sin(0.25), np.cos(0.25)])
    info = underbrush.LogInfo(scans=[underbrush.ScanInfo(3, 0.0, underbrush.Pose([5, 0, 0], turn))])
    turned = underbrush.log_from_columns(origin=log.origin, direction=log.direction, range_m=log.range_m, ring=log.ring,
                                         scan=log.scan, info=info)
    forward = int(np.argmax(log.direction[:, 0] * np.cos(0.5) + log.direction[:, 1] * np.sin(0.5)
                            - 10 * np.abs(log.direction[:, 2])))
    column = np.argwhere(plot.panorama(turned).row == forward)[0, 1]
    assert abs(column - 40) <= 2  # the middle of the picture


def test_panorama_of_a_log_without_rings(log: underbrush.BeamLog) -> None:
    plain = underbrush.log_from_columns(origin=log.origin, direction=log.direction, range_m=log.range_m, scan=log.scan)
    where = plot.panorama(plain)
    assert len(where.row) == 64 and (np.diff(where.elevation_rad) < 0).all()
    seen = where.row[where.row >= 0]
    assert (log.scan[seen] == log.scan[0]).all() and len(np.unique(seen)) > 0.9 * (log.scan == log.scan[0]).sum()


def test_gaps_are_filled_and_edges_are_not() -> None:
    log = small_scan()
    kept = np.ones(400, bool)
    kept[[10, 11, 20, 21, 22, 23, 24, 25]] = False  # of ring 0: a gap of 2, and one of 6
    part = underbrush.log_from_columns(origin=log.origin[kept], direction=log.direction[kept],
                                       range_m=log.range_m[kept], ring=log.ring[kept])
    bottom = plot.panorama(part, columns=80).row[-1]
    assert (bottom[10:12] >= 0).all() and (bottom[20:26] < 0).sum() >= 5


def test_range_image(log: underbrush.BeamLog) -> None:
    ax = plot.range_image(log)
    misses, ranges = (np.ma.filled(image.get_array(), np.nan) for image in ax.get_images())
    where = plot.panorama(log)
    shown = where.image(log.range_m)
    assert np.array_equal(ranges, np.where(np.isfinite(shown), shown, np.nan), equal_nan=True)
    assert np.array_equal(misses == 1, np.isposinf(shown)) and np.isposinf(shown).any()
    assert ax.get_xlabel() == "azimuth, °" and ax.get_ylabel() == "elevation, °"
    assert ax.figure.axes[1].get_ylabel() == "range, m" and ax.get_images()[1].get_clim()[0] == 0
    given = plt.subplots()[1]
    assert plot.range_image(log, "ring", ax=given, limits=(0, 15), colorbar=False) is given
    assert given.get_images()[1].get_clim() == (0, 15) and len(given.figure.axes) == 1
    plot.range_image(log, np.arange(len(log)))
    with pytest.raises(ValueError, match="no column 'colour'"):
        plot.range_image(log, "colour")


def test_error_map() -> None:
    real, wrong = small_scan(), small_scan()
    wrong.range_m[:80] += 0.25  # the lowest ring is too far
    real.range_m[80:160:2] = np.inf  # false hits
    wrong.range_m[160:240:2] = np.inf  # false misses
    for log in (real, wrong):
        log.range_m[240:320] = np.inf  # true misses
    ax = plot.error_map(real, wrong)
    kinds, errors = (image.get_array() for image in ax.get_images())
    assert np.allclose(errors[4], 0.25) and np.allclose(errors[0], 0) and errors[3].count() == 40
    assert (kinds[3].compressed() == 1).all() and (kinds[2].compressed() == 2).all() and (kinds[1] == 3).all()
    texts = [text.get_text() for text in ax.get_legend().get_texts()]
    assert texts == ["false hit 10.0%", "false miss 10.0%", "true miss 20.0%"]
    packets = plot.error_map(real, wrong, "packet").get_images()[1].get_array()
    assert np.isclose(packets[4, 1], 0.25 / 4) and np.isclose(packets[4, 0], 0.25 / 2)  # hits of the column in both
    with pytest.raises(ValueError, match="400 real beams"):
        plot.error_map(real, wrong.slice(0, 10))
    with pytest.raises(ValueError, match="range or packet"):
        plot.error_map(real, wrong, "colour")


def test_packet_errors_have_the_score_as_mean(log: underbrush.BeamLog, simulated: underbrush.BeamLog) -> None:
    from underbrush.plot.images import _packet_means
    both = np.isfinite(log.range_m) & np.isfinite(simulated.range_m)
    packets = _packet_means(log, simulated, both)
    _, first = np.unique(log.scan.astype(np.int64) << 32 | log.packet, return_index=True)
    score = underbrush.score(log, simulated, cloud=False)
    assert np.isclose(np.nanmean(packets[first]), score.all.packet_error_m, rtol=1e-6)


def test_ellipses_in_plane() -> None:
    generator = np.random.default_rng(3)
    mean, sigma = generator.normal(0, 0.4, (200, 3)), np.sort(generator.uniform(0.05, 0.6, (200, 3)), axis=1)
    axes = np.linalg.qr(generator.normal(size=(200, 3, 3)))[0]
    in_plane = np.array([[0.6, 0.8, 0], [0, 0, 1.0]])
    point, contour = np.array([0.1, -0.2, 0.3]), 1.7
    met, centre, half, angle = plot.ellipses_in_plane(mean, sigma, axes, point, in_plane, contour)
    inverse = axes @ (sigma[:, :, None] ** -2 * axes.transpose(0, 2, 1))
    normal = np.array([-0.8, 0.6, 0])
    across = np.abs((mean - point) @ normal)
    reach = contour * np.sqrt(np.einsum("i,nij,j->n", normal, np.linalg.inv(inverse), normal))
    assert np.array_equal(met, np.flatnonzero(across < reach)) and 20 < len(met) < 200
    assert (half[:, 0] >= half[:, 1]).all()
    for turn in np.linspace(0, 2 * np.pi, 9):  # points of each ellipse lie at the contour of its ellipsoid
        along = np.stack([np.cos(angle), np.sin(angle)], axis=1) * (half[:, :1] * np.cos(turn))
        beside = np.stack([-np.sin(angle), np.cos(angle)], axis=1) * (half[:, 1:] * np.sin(turn))
        to = point + (centre + along + beside) @ in_plane - mean[met]
        assert np.allclose(np.einsum("ni,nij,nj->n", to, inverse[met], to), contour**2)


def test_section_of_a_model_and_its_log(model: underbrush.Model, log: underbrush.BeamLog) -> None:
    ax = plot.section(model, [0, 4], [20, 4])
    ellipses, ground = ax.collections
    assert len(ellipses.get_offsets()) > 3 and ax.get_xlim() == (0, 20)
    assert ((0 <= ellipses.get_array()) & (ellipses.get_array() <= 1)).all()
    ends = np.array(ground.get_segments())
    assert len(ends) > 5 and np.isfinite(ends).all() and np.abs(ends[:, :, 1]).max() < 0.3  # the ground lies at z = 0
    assert plot.section(log, [0, 4], [20, 4], thickness_m=0.4, ax=ax) is ax
    points = ax.lines[0].get_xydata()
    world = log.end_points()[np.isfinite(log.range_m)]
    near = world[(np.abs(world[:, 1] - 4) <= 0.2) & (world[:, 0] >= 0) & (world[:, 0] <= 20)]
    assert len(near) > 20 and np.allclose(points, near[:, [0, 2]])
    assert ax.get_xlabel() == "distance, m" and ax.get_ylabel() == "z, m"
    with pytest.raises(ValueError, match="same place"):
        plot.section(log, [1, 1], [1, 1])


def test_section_of_a_scene_is_that_of_its_models(model: underbrush.Model, tmp_path: pathlib.Path) -> None:
    angle, position, scale = 0.7, np.array([3.0, -2.0, 0.5]), 1.5
    underbrush.write_model(tmp_path / "model", model)
    scene = _scene_of(tmp_path, [*position, 0, 0, np.sin(angle / 2), np.cos(angle / 2)], scale)
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    start, end = np.array([0.0, 4.03]) - model.origin[:2], np.array([20.0, 4.03]) - model.origin[:2]
    one = plot.section(model, [0, 4.03], [20, 4.03])
    two = plot.section(scene, turn @ start * scale + position[:2], turn @ end * scale + position[:2])
    for k in (0, 1):
        a, b = one.collections[k], two.collections[k]
        if k == 0:
            assert np.allclose(scale * np.asarray(a.get_offsets())[:, 0], np.asarray(b.get_offsets())[:, 0], atol=1e-3)
            assert np.allclose(a.get_array(), b.get_array())
        else:
            assert np.allclose(scale * np.array(a.get_segments())[:, :, 0], np.array(b.get_segments())[:, :, 0],
                               atol=1e-3)


def _scene_of(folder: pathlib.Path, place: list[float], scale: float) -> underbrush.Scene:
    """A scene with one instance of the model in the folder; `place` is x y z and a quaternion x y z w."""
    names = [f"property double {name}" for name in ("x", "y", "z", "qx", "qy", "qz", "qw")]
    header = ["ply", "format binary_little_endian 1.0", "element vertex 1", *names, "property float scale",
              "property uint model", "property uchar class", "end_header", ""]
    (folder / "instances.ply").write_bytes("\n".join(header).encode() + struct.pack("<7dfIB", *place, scale, 0, 1))
    (folder / "scene.json").write_text(json.dumps({
        "format": "underbrush-scene", "version": 1, "models": [{"folder": "model", "name": "ground"}],
        "instances": {"file": "instances.ply", "count": 1}, "provenance": {}}))
    return underbrush.read_scene(folder)


def test_range_error_histogram(log: underbrush.BeamLog, simulated: underbrush.BeamLog) -> None:
    score = underbrush.score(log, simulated, cloud=False)
    ax = plot.range_error_histogram({"one": score, "two": score}, log=True)
    values, edges, _ = ax.patches[0].get_data()
    both = np.isfinite(log.range_m) & np.isfinite(simulated.range_m)
    error = simulated.range_m[both].astype(float) - log.range_m[both]
    counted = np.bincount(np.clip(np.floor((error + 2) / 0.05), -1, 80).astype(int) + 1, minlength=82)
    assert np.allclose(values, 100 * counted[1:-1] / counted.sum(), atol=1e-9) and np.allclose(edges[[0, -1]], [-2, 2])
    assert len(ax.patches) == 2 and ax.get_yscale() == "log" and ax.get_xlabel().endswith(", m")
    beyond = (counted[0] + counted[-1]) / counted.sum()
    assert ax.get_legend().get_texts()[0].get_text() == f"one: {beyond:.1%} beyond ±2 m"


def test_reliability(log: underbrush.BeamLog, simulated: underbrush.BeamLog, model: underbrush.Model) -> None:
    score = underbrush.score(log, simulated, model=model, cloud=False)
    ax = plot.reliability({"a": score})
    printed = json.loads(_core.scores_json(["score"], [score], "{}"))["reliability"]
    assert sum(b["beams"] for b in printed["bins"]) == score.all.beams
    returned = sum(b["beams"] * b["returned"] for b in printed["bins"])
    assert round(returned) == score.all.true_hits + score.all.false_misses
    assert 0 < score.calibration_error < 0.2 and abs(score.calibration_bias) <= score.calibration_error
    assert np.allclose(ax.lines[1].get_ydata(), [b["returned"] for b in printed["bins"]])
    assert ax.get_legend().get_texts()[0].get_text() == f"a: calibration error {score.calibration_error:.2%}"
    without = underbrush.score(log, simulated, cloud=False)
    assert np.isnan(without.calibration_error)
    with pytest.raises(ValueError, match="without a model"):
        plot.reliability(without)


def test_score_by_range(log: underbrush.BeamLog, simulated: underbrush.BeamLog) -> None:
    score = underbrush.score(log, simulated, cloud=False)
    ax = plot.score_by_range({"a": score}, "recall")
    names = [text.get_text() for text in ax.get_xticklabels()]
    solid = [band for band in ("0-10", "10-20", "20-30", "30-50", "50-80", "80-")
             if band in score.per_range and score.per_range[band].beams >= 100]
    assert names == [band.replace("-", "–") if band != "80-" else "> 80" for band in solid] and len(solid) >= 2
    assert np.allclose(ax.lines[0].get_ydata(), [score.per_range[band].recall for band in solid])
    assert plot.score_by_range(score).get_ylabel() == "packet error, m"
    with pytest.raises(ValueError, match="packet_error_m"):
        plot.score_by_range(score, "beauty")


def test_counts_come_from_the_score(log: underbrush.BeamLog, simulated: underbrush.BeamLog) -> None:
    score = underbrush.score(log, simulated, cloud=False)
    histogram = json.loads(_core.scores_json(["score"], [score], "{}"))["range_error_histogram"]
    assert sum(histogram["below_bins_above"]) == score.all.true_hits
