"""Positions of an airborne sensor, estimated from generated surveys whose positions are known, and from real ones."""
from __future__ import annotations

import pathlib

import numpy as np
import pytest

pytest.importorskip("laspy", reason="laspy is not installed: pip install 'underbrush[formats]'")

from format_data import data, joined  # noqa: E402
from flights import ORIGIN, Floats, Way, simulated, straight, survey, write  # noqa: E402

from underbrush.formats import OptionMissing, beams, open_recording  # noqa: E402
from underbrush.formats import pulses as pulse_tables  # noqa: E402
from underbrush.formats.airborne import Estimate, estimate_poses  # noqa: E402


def estimated(path: pathlib.Path) -> Estimate:
    recording = open_recording(path)
    return estimate_poses(recording)  # type: ignore[arg-type]


def errors(found: Estimate, way: Way, start_s: float = 0.0) -> tuple[Floats, Floats]:
    """Errors (m, 3) of the positions at the nodes, and their standard errors."""
    good = [line.found for line in found.lines if not line.reason]
    time, position, sigma = (np.concatenate([getattr(one, name) for one in good])
                             for name in ("time_s", "position", "sigma"))
    return position - ORIGIN - way(time - start_s), sigma


def rms(values: Floats) -> Floats:
    return np.asarray(np.sqrt(np.mean(values**2, axis=0)))


@pytest.mark.parametrize("height_m", [400.0, 800.0])
@pytest.mark.parametrize("seed", [1, 2])
def test_lines_of_pulses_meet_at_the_sensor(tmp_path: pathlib.Path, height_m: float, seed: int) -> None:
    way = straight(height_m, sway_m=8)
    path = write(tmp_path / "flight.las", survey(way, 20, pitch_deg=4, roll_deg=2, seed=seed), angles="none")
    found = estimated(path)
    error, sigma = errors(found, way)
    assert np.all(rms(error) < [0.05, 0.06, 0.25]), rms(error)
    assert np.all(rms(error / sigma) < 1.5) and np.all(rms(error / sigma) > 0.3), rms(error / sigma)
    assert len(found.lines) == 1 and not found.lines[0].found.angles
    assert abs(found.lines[0].found.height_m - height_m) < 10  # The ground is rolling.


@pytest.mark.parametrize("height_m", [400.0, 800.0])
def test_scan_angles_alone_give_less(tmp_path: pathlib.Path, height_m: float) -> None:
    way = straight(height_m, sway_m=3)
    path = write(tmp_path / "flight.las", survey(way, 20, pitch_deg=2, roll_deg=0.7, several=0))
    found = estimated(path)
    error, sigma = errors(found, way)
    assert np.all(rms(error) < height_m * np.array([0.05, 0.02, 0.01])), rms(error)  # The pitch is not known.
    assert np.all(rms(error) < 3 * rms(sigma)), rms(error / sigma)
    flat, up = np.hypot(*rms(sigma)[:2]), rms(sigma)[2]
    assert found.note() == (
        "the sensor's positions are estimated from the scan angles: 1 flight line, "
        f"{found.lines[0].found.height_m:.0f} m above the ground, 1-sigma {flat:.2g} m horizontally and {up:.2g} m "
        "vertically (--poses FILE gives the true ones)")


def test_degrees_that_a_plot_cuts_off_do_no_harm(tmp_path: pathlib.Path) -> None:
    """The points of the first and the last degree lie on one side of its middle."""
    way = straight(600)
    flight = survey(way, 4, several=0)
    x, y, _ = (flight["xyz"] - ORIGIN).T
    plot = (np.abs(x - 120) < 45) & (np.abs(y + 80) < 20 + 0.1 * x)  # A trapezium of 64 by 90 m.
    found = estimated(write(tmp_path / "plot.las", {name: column[plot] for name, column in flight.items()}))
    error, sigma = errors(found, way)
    assert np.all(rms(error) < [5, 5, 10]) and np.all(rms(error) < 2 * rms(sigma)), rms(error)


def test_few_lines_are_helped_by_scan_angles(tmp_path: pathlib.Path) -> None:
    way = straight(500)
    few = survey(way, 4, several=0.01)  # 80 pulses.
    few["xyz"] += np.random.default_rng(5).normal(0, 0.05, few["xyz"].shape)
    both = errors(estimated(write(tmp_path / "both.las", few)), way)
    lines = errors(estimated(write(tmp_path / "lines.las", few, angles="none")), way)
    assert np.all(rms(both[1])[1:] < 0.9 * rms(lines[1])[1:]), (rms(both[1]), rms(lines[1]))
    assert np.all(rms(both[0]) < 3 * rms(both[1])) and np.all(rms(lines[0]) < 3 * rms(lines[1]))


def test_angles_that_are_no_scan_angles_are_left_out(tmp_path: pathlib.Path) -> None:
    way, flight = straight(500), survey(straight(500), 10)
    flight["angle"] = np.random.default_rng(3).uniform(-15, 15, len(flight["angle"]))
    found = estimated(write(tmp_path / "flight.las", flight))
    assert not found.lines[0].found.angles and np.all(rms(errors(found, way)[0]) < 0.3)
    alone = survey(way, 10, several=0)
    alone["angle"] = flight["angle"][:len(alone["angle"])]
    with pytest.raises(OptionMissing, match="because its scan angles do not fit its points: add --poses FILE"):
        estimated(write(tmp_path / "alone.las", alone))


def test_noise_of_returns_does_not_bring_the_sensor_nearer(tmp_path: pathlib.Path) -> None:
    """Least squares of distances to lines would place it 12 m too low: short lines have directions with noise."""
    way, flight = straight(500), survey(straight(500), 10)
    flight["xyz"] += np.random.default_rng(6).normal(0, 0.1, flight["xyz"].shape)
    error, sigma = errors(estimated(write(tmp_path / "flight.las", flight, angles="none")), way)
    assert abs(error[:, 2].mean()) < 2 * sigma[:, 2].mean(), (error[:, 2].mean(), sigma[:, 2].mean())
    assert sigma[:, 2].mean() < 3


def test_wrong_pulses_and_the_order_of_the_file_do_no_harm(tmp_path: pathlib.Path) -> None:
    way, flight = straight(600), survey(straight(600), 10)
    rng = np.random.default_rng(4)
    first = np.flatnonzero(flight["number"] == 1)
    wrong = rng.choice(first, len(first) // 4, replace=False)  # A quarter of the pulses begins elsewhere.
    flight["xyz"][wrong] += rng.normal(0, 1.5, (len(wrong), 3))
    found = estimated(write(tmp_path / "flight.las", flight, angles="none", shuffled=True))
    error, sigma = errors(found, way)
    assert np.all(rms(error) < [0.1, 0.1, 0.6]) and np.all(rms(error) < 2 * rms(sigma)), rms(error)


def test_many_pulses_take_a_bounded_amount_of_memory(tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> None:
    way = straight(400)
    path = write(tmp_path / "flight.las", survey(way, 10), angles="none")
    whole = estimated(path).lines[0].found
    monkeypatch.setattr(pulse_tables, "_MOST_PULSES", 2000)
    monkeypatch.setattr(pulse_tables, "_MOST_CELLS", 10)
    part = estimated(path)
    assert whole.pulses > 7000 and 800 < part.lines[0].found.pulses <= 2000
    error, sigma = errors(part, way)
    assert np.all(rms(error) < 2 * rms(sigma)) and np.all(part.lines[0].found.sigma > whole.sigma)


def test_each_flight_line_has_its_own_trajectory(tmp_path: pathlib.Path) -> None:
    there, back = straight(500), straight(450, speed=-70, north_m=150)
    single = survey(straight(400), 4, start_s=300, several=0)
    path = write(tmp_path / "flights.las", survey(there, 6), survey(back, 6, start_s=100), single, angles="none")
    recording = open_recording(path)
    log = joined(list(beams(recording)))
    first, second = log["time_s"] < 50, (log["time_s"] > 50) & (log["time_s"] < 200)
    for rows, way, start in ((first, there, 0), (second, back, 100)):
        error = log["origin"][rows] - ORIGIN - way(log["time_s"][rows] - start)
        assert np.count_nonzero(rows) > 10_000 and np.all(rms(error) < [0.1, 0.1, 0.5]), rms(error)
    assert np.all(first | second)
    assert recording.skipped == {"points of flight lines whose sensor positions cannot be estimated": 8000}
    (note,) = recording.notes()  # type: ignore[attr-defined]
    assert "2 flight lines, 45" in note and " 8 000 points of 1 other flight line are left out" in note
    ends = log["origin"] + log["range_m"][:, None].astype(float) * log["direction"]
    assert np.abs(ends[:, 2] - ends[:, 2].mean()).max() < 30  # The points stay where they are.


def test_what_cannot_be_estimated_is_refused_in_one_line(tmp_path: pathlib.Path) -> None:
    way = straight(500)
    flight, rough = survey(way, 4), survey(way, 4, several=0.01)
    rough["xyz"] += np.random.default_rng(7).normal(0, 2, rough["xyz"].shape)
    cases = {"single returns only and no scan angles": (survey(way, 4, several=0), "none"),
             "only 5 of its pulses have several returns": (survey(way, 4, several=0.0006), "none"),
             "all its times are equal": ({**flight, "time": np.zeros(len(flight["time"]))}, "whole"),
             "where no aircraft flies": (survey(straight(15), 4), "none"),
             "place the sensor only to": (rough, "none")}
    for reason, (points, angles) in cases.items():
        path = write(tmp_path / "flight.las", points, angles=angles)
        with pytest.raises(OptionMissing) as refused:
            next(beams(open_recording(path)))
        said = str(refused.value)
        assert reason in said and "\n" not in said, said
        assert said.startswith(f"{path}: the sensor's positions are not in it and cannot be estimated, because ")
        assert said.endswith(": add --poses FILE (GPS time x y z) or, for a tripod, --position X,Y,Z")


def test_given_positions_come_first(tmp_path: pathlib.Path) -> None:
    path = write(tmp_path / "flight.las", survey(straight(500), 2))
    recording = open_recording(path)
    log = joined(list(beams(recording, position=(481000, 3812000, 900))))
    assert np.all(log["origin"] == [481000, 3812000, 900]) and not recording.notes()  # type: ignore[attr-defined]


@pytest.mark.parametrize(("height_m", "seed"), [(400.0, 1), (600.0, 2), (800.0, 3)])
def test_a_simulated_flight_is_found_again(tmp_path: pathlib.Path, height_m: float, seed: int) -> None:
    path, way = simulated(tmp_path, height_m, 8, seed)
    (line,) = estimated(path).lines
    error = line.found.position - way(line.found.time_s)
    assert line.found.pulses > 5000 and line.found.angles
    assert np.all(rms(error) < [0.1, 0.1, 0.6]), rms(error)
    assert np.all(rms(error / line.found.sigma) < 2), rms(error / line.found.sigma)


def test_real_flights() -> None:
    (line,) = estimated(data("trees_laz", "lidr_Topography.laz")).lines
    found = line.found
    speed = np.linalg.norm(np.diff(found.position, axis=0), axis=1) / np.diff(found.time_s)
    assert found.pulses > 13_000 and np.all(found.sigma < 0.5)
    assert np.all(np.abs(speed - 69.4) < 1.5) and np.ptp(found.position[:, 2]) < 1  # An aircraft's level flight.
    mixed = estimated(data("trees_laz", "lidr_MixedConifer.laz"))  # It has first returns alone.
    good = [line.found for line in mixed.lines if not line.reason]
    assert len(good) == 3 and all(abs(one.height_m - 820) < 60 and one.angles and not one.pulses for one in good)
