"""Survey files whose coordinates are no metres, whose sensor is elsewhere, whose times tell no pulses, whose points are
noise."""
from __future__ import annotations

import pathlib
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

laspy = pytest.importorskip("laspy", reason="laspy is not installed: pip install 'underbrush[formats]'")

from format_data import end_points, joined  # noqa: E402

from underbrush.formats import FormatError, beams, open_recording  # noqa: E402
from underbrush.formats.las_units import Units, units_of_keys, units_of_wkt  # noqa: E402

FOOT, US_FOOT = 0.3048, 1200 / 3937
PLACE = np.array([532100.0, 5412300.0, 311.8])
GEOGCS = 'GEOGCS["NAD83",DATUM["D",SPHEROID["GRS 1980",6378137,298.257222101]],UNIT["degree",0.0174532925199433]]'
US_FEET = f'PROJCS["NAD83 / North Carolina (ftUS)",{GEOGCS},PROJECTION["L"],UNIT["US survey foot",0.304800609601219]]'
WKT2 = ('PROJCRS["a",BASEGEOGCRS["b",DATUM["c",ELLIPSOID["d",6378137,298.2,LENGTHUNIT["metre",1]]]],CONVERSION["e",'
        'METHOD["f"],PARAMETER["g",0,LENGTHUNIT["metre",1]]],CS[Cartesian,2],AXIS["easting",east,LENGTHUNIT["foot",0.3048]]'
        ',AXIS["northing",north,LENGTHUNIT["foot",0.3048]]]')
HEIGHT = 'VERT_CS["NAVD88 height (m)",VERT_DATUM["n",2005],UNIT["metre",1.0],AXIS["Up",UP]]'


def walls(n: int = 200) -> npt.NDArray[np.float64]:
    """Points of a wall 20 m before the sensor."""
    share = np.linspace(-1, 1, n)
    return np.asarray(PLACE + np.column_stack([np.full(n, 20.0), 10 * share, 3 * share**2]))


def written(path: pathlib.Path, xyz: npt.NDArray[np.float64], records: list[Any], scales: Any = 0.001,
            **columns: npt.NDArray[Any]) -> pathlib.Path:
    header = laspy.LasHeader(point_format=6, version="1.4")
    header.scales, header.offsets = np.broadcast_to(scales, 3), np.floor(xyz[0])
    header.vlrs.extend(records)
    las = laspy.LasData(header)
    las.x, las.y, las.z = xyz.T
    las.return_number = las.number_of_returns = np.ones(len(xyz), np.uint8)
    las.gps_time = 1e5 + np.arange(len(xyz)) * 1e-3
    for name, column in columns.items():
        setattr(las, name, column)
    las.write(path)
    return path


def wkt(text: str) -> list[Any]:
    return [laspy.vlrs.known.WktCoordinateSystemVlr(text)]


def keys(**values: int) -> list[Any]:
    """GeoTIFF keys; of each name the number counts."""
    record = laspy.vlrs.known.GeoKeyDirectoryVlr()
    body = np.array([[1, 1, 0, len(values)], *([int(name[1:]), 0, 1, value] for name, value in values.items())], np.uint16)
    record.parse_record_data(body.tobytes())
    return [record]


@pytest.mark.parametrize(("records", "flat_m", "up_m", "said"), [
    (wkt(US_FEET), US_FOOT, US_FOOT, "US survey feet"), (wkt(WKT2), FOOT, FOOT, "international feet"),
    (wkt(f'COMPD_CS["both",{US_FEET},{HEIGHT}]'), US_FOOT, 1, "US survey feet, z in m"),
    (wkt(f'{US_FEET},{HEIGHT.replace("VERT_CS", "VERTCS")}'), US_FOOT, 1, "US survey feet, z in m"),
    (keys(k1024=1, k3072=2264, k3076=9003), US_FOOT, US_FOOT, "US survey feet"),
    (keys(k1024=1, k3072=32633, k3076=9001, k4099=9002), 1, FOOT, "m, z in international feet"),
    (keys(k1024=1, k3072=2222), FOOT, FOOT, "international feet"), (keys(k1024=1, k3072=32633), 1, 1, ""), ([], 1, 1, "")])
def test_feet_become_metres(tmp_path: pathlib.Path, records: list[Any], flat_m: float, up_m: float, said: str) -> None:
    unit = np.array([flat_m, flat_m, up_m])
    written(tmp_path / "feet.las", walls() / unit, records)
    still, moving = open_recording(tmp_path / "feet.las"), open_recording(tmp_path / "feet.las")
    (tmp_path / "poses.txt").write_text("".join(
        " ".join(f"{v:.6f}" for v in (t, *PLACE / unit)) + "\n" for t in (99999.0, 100001.0)))
    for back in (next(beams(still, position=tuple(PLACE / unit))), next(beams(moving, poses=tmp_path / "poses.txt")),
                 next(beams(open_recording(tmp_path / "feet.las", poses=tmp_path / "poses.txt")))):
        np.testing.assert_allclose(end_points(back), walls(), atol=1e-3)
        np.testing.assert_allclose(back["origin"], np.tile(PLACE, (200, 1)), atol=1e-5)
        assert abs(float(back["range_m"][100]) - 20) < 0.1
    notes = still.notes()  # type: ignore[attr-defined]
    assert [f"in {said}:" in note for note in notes] == [True] * bool(said)
    assert (f" {said}" if said else " m") in still.found()[1]


def test_a_unit_that_a_user_names(tmp_path: pathlib.Path) -> None:
    written(tmp_path / "a.las", walls() / FOOT, [])
    recording = open_recording(tmp_path / "a.las", unit="ft")
    np.testing.assert_allclose(end_points(next(beams(recording, position=tuple(PLACE / FOOT)))), walls(), atol=1e-3)
    (tmp_path / "a.xyz").write_text("1.0 2.0 3.0 45.6 4.5 1 1 7 12 2 100.0001\n")
    with pytest.raises(ValueError, match="--unit is for bags, E57, LAS and LAZ files"):
        open_recording(tmp_path / "a.xyz", unit="ft")


def test_units_of_systems() -> None:
    assert units_of_wkt(f'GEOGCS["WGS 84",{GEOGCS}]') == Units(degrees=True)
    assert units_of_wkt('GEODCRS["a",CS[Cartesian,3],AXIS["X",geocentricX],LENGTHUNIT["metre",1]]') is None
    assert units_of_wkt('PROJCS["UTM",UNIT["metre",1]]') == Units()
    assert units_of_wkt("nonsense[") is None and units_of_wkt('PROJCS["x",UNIT["y",z]]') is None
    assert units_of_keys({1024: 2, 2048: 4326}, {}, "") == Units(degrees=True)
    assert units_of_keys({3072: 6543}, {}, "NAD83(2011) / North Carolina (ftUS)|") == Units(US_FOOT, US_FOOT)
    assert units_of_keys({3072: 3647}, {}, "NAD83(NSRS2007) / South Carolina (ft)|") == Units(FOOT, FOOT)
    assert units_of_keys({3072: 32767, 3076: 32767}, {3077: 0.5}, "") == Units(0.5, 0.5)
    assert units_of_keys({3072: 32633}, {}, "WGS 84 / UTM zone 33N|") is None


@pytest.mark.parametrize(("records", "scales"), [(wkt(GEOGCS), 1e-7), (keys(k1024=2, k2048=4326), 1e-7),
                                                 ([], [1e-7, 1e-7, 1e-3]), ([], 1e-7)])
def test_degrees_are_refused(tmp_path: pathlib.Path, records: list[Any], scales: Any) -> None:
    written(tmp_path / "degrees.las", (walls() - PLACE) * [1e-5, 1e-5, 1] + [11.4, 48.1, 311], records, scales)
    recording = open_recording(tmp_path / "degrees.las")
    assert " degrees, z in m" in recording.found()[1] and "project them to m" in recording.found()[-1]
    with pytest.raises(FormatError, match=r"degrees\.las: header: .* longitude and latitude in degrees: project them"):
        next(beams(recording, position=(11.4, 48.1, 311)))


@pytest.mark.parametrize(("place", "reason"), [
    ([0, 0, 1.5], "degrees or those of a site of its own"), ([48.1, 11.4, 311], "both .* the coordinates of the file"),
    ([1e6, 0, 0], "both must have the coordinates of the file$"), ([PLACE[1], PLACE[0], PLACE[2]], r"x .east. must stand before y .north.")])
def test_a_sensor_that_is_elsewhere_is_refused(tmp_path: pathlib.Path, place: list[float], reason: str) -> None:
    written(tmp_path / "a.las", walls(), [])
    (tmp_path / "t.txt").write_text("".join(" ".join(map(str, (t, *place))) + "\n" for t in (99999, 100001)))
    with pytest.raises(FormatError, match=rf"a\.las: --poses: the sensor at .* km from the points .*{reason}"):
        next(beams(open_recording(tmp_path / "a.las"), poses=tmp_path / "t.txt"))
    with pytest.raises(FormatError, match=rf"a\.las: --position: the sensor at .* km from the points .*{reason}"):
        next(beams(open_recording(tmp_path / "a.las"), position=place))


def test_one_point_that_is_elsewhere_is_counted(tmp_path: pathlib.Path) -> None:
    points = walls()
    points[7] += [0, 40e3, 0]
    points[9] += [0, 0, 20e3]  # An aircraft flies so high.
    recording = open_recording(written(tmp_path / "a.las", points, []))
    assert len(next(beams(recording, position=tuple(PLACE)))["range_m"]) == 199
    assert recording.skipped == {"points farther than 30 km from the sensor": 1}


def two_returns(path: pathlib.Path, digits: int, order: npt.NDArray[np.intp]) -> pathlib.Path:
    """Pulses of two returns, 5 m apart in height, at times that are rounded, in this order of the rows."""
    points = np.repeat(walls(), 2, axis=0)
    points[::2, 2] += 5
    number = np.tile([1, 2], 200).astype(np.uint8)
    time = np.round(1e5 + np.repeat(np.arange(200) * 1e-4, 2), digits)
    return written(path, points[order], [], return_number=number[order], number_of_returns=np.full(400, 2, np.uint8),
                   gps_time=time[order])


@pytest.mark.parametrize("digits", [3, 2, 0])
def test_rounded_times_tell_no_pulses_unless_the_order_does(tmp_path: pathlib.Path, digits: int) -> None:
    mixed = np.random.default_rng(5).permutation(400)
    for name, order in (("mixed", mixed), ("by return", np.argsort(np.tile([1, 2], 200), kind="stable")),
                        ("last first", np.arange(400) ^ 1)):
        recording = open_recording(two_returns(tmp_path / f"{name}.las", digits, order))
        scan, = recording.scans()
        assert scan.echoes is not None and set(scan.echoes) == {1} and list(recording.skipped.values()) == [400], name
        assert "pulses share their gps_time" in next(iter(recording.skipped))
    recording = open_recording(two_returns(tmp_path / "flown.las", digits, np.arange(400)))
    scan, = recording.scans()
    assert scan.echo is not None and scan.echo.tolist() == [1, 2] * 200 and not recording.skipped
    recording = open_recording(two_returns(tmp_path / "exact.las", 6, mixed))
    scan, = recording.scans()
    assert scan.echo is not None and scan.xyz is not None and scan.echo.tolist() == [1, 2] * 200
    np.testing.assert_allclose(scan.xyz[::2] - scan.xyz[1::2], np.tile([0, 0, 5], (200, 1)), atol=2e-3)
    assert not recording.skipped


def test_points_of_noise_are_counted(tmp_path: pathlib.Path) -> None:
    points, kinds = walls(), np.full(200, 2, np.uint8)
    points[[3, 50]] += [0, 0, 5e3]
    kinds[[3, 50]] = 7, 18
    recording = open_recording(written(tmp_path / "noise.las", points, [], classification=kinds))
    back = joined(list(beams(recording, position=tuple(PLACE))))
    assert len(back["range_m"]) == 198 and back["range_m"].max() < 30
    assert recording.skipped == {"points of the classes of noise, 7 and 18": 2}
