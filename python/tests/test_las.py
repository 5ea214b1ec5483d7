"""LAS, LAZ, COPC and HELIOS++ text: what comes out, what is counted, what is refused."""
from __future__ import annotations

import pathlib
import struct

import numpy as np
import pytest

laspy = pytest.importorskip("laspy", reason="laspy is not installed: pip install 'underbrush[formats]'")

from format_data import Columns, data, end_points, generated_log, joined, pieces  # noqa: E402

from underbrush.formats import FormatError, OptionMissing, Poses, beams, open_recording  # noqa: E402
from underbrush.formats.las import LasRecording  # noqa: E402
from underbrush.formats.write_las import LasWriter  # noqa: E402


def written(path: pathlib.Path, echoes: int = 1, crs: str = "") -> tuple[Columns, Poses, LasWriter]:
    log, poses = generated_log(echoes=echoes)
    log["class"] = (log["ring"] % 7).astype(np.uint8)
    with LasWriter(path, crs=crs) as writer:
        for piece in pieces(log):
            writer.write(piece)
    return log, poses, writer


@pytest.mark.parametrize("name", ["log.las", "log.laz"])
@pytest.mark.parametrize("echoes", [1, 4])
def test_hits_come_back_and_misses_are_counted(tmp_path: pathlib.Path, name: str, echoes: int) -> None:
    log, poses, writer = written(tmp_path / name, echoes)
    hit = np.isfinite(log["range_m"])
    assert writer.lost["misses"] == np.count_nonzero(~hit)
    assert writer.written == np.count_nonzero(hit)
    recording = open_recording(tmp_path / name)
    back = joined(list(beams(recording, poses=poses)))
    np.testing.assert_allclose(end_points(back), end_points(log), atol=2e-4)
    for column in ("time_s", "ring", "scan", "class", "intensity"):
        np.testing.assert_array_equal(back[column], log[column][hit])
    if echoes > 1:
        np.testing.assert_array_equal(back["echo"], log["echo"][hit])
        np.testing.assert_array_equal(back["echoes"], log["echoes"][hit])
        np.testing.assert_allclose(back["pulse_width"], log["pulse_width"][hit], rtol=1e-6)
    assert not recording.skipped


def test_fields_are_those_of_helios(tmp_path: pathlib.Path) -> None:
    log, _, _ = written(tmp_path / "log.laz", echoes=3)
    las = laspy.read(tmp_path / "log.laz")
    hit = np.isfinite(log["range_m"])
    assert {"echo_width", "fullwaveIndex", "hitObjectId", "heliosAmplitude"} <= set(las.point_format.dimension_names)
    np.testing.assert_array_equal(las.return_number, log["echo"][hit])
    np.testing.assert_allclose(las.echo_width, log["pulse_width"][hit] * 2 / 0.299792458, rtol=1e-6)
    beam = np.cumsum(log["echo"] <= 1) - 1
    np.testing.assert_array_equal(las.fullwaveIndex, beam[hit])


def test_pulses_are_whole_at_the_end_of_a_piece(tmp_path: pathlib.Path) -> None:
    written(tmp_path / "log.laz", echoes=5)
    whole = [scan for scan in LasRecording(tmp_path / "log.laz").scans()]
    parts = [scan for scan in LasRecording(tmp_path / "log.laz", chunk=997).scans()]
    assert len(parts) > 5
    for name in ("echo", "echoes", "xyz", "beam_time_s"):
        np.testing.assert_array_equal(np.concatenate([getattr(s, name) for s in parts]), getattr(whole[0], name))
    assert all(scan.echo is not None and scan.echo[0] == 1 for scan in parts)


@pytest.mark.parametrize("crs", ["EPSG:32633", "EPSG:32633+5773", "EPSG:4326",
                                 'PROJCS["ETRS89 / UTM zone 33N",AUTHORITY["EPSG","25833"]]'])
def test_crs_is_kept_as_text(tmp_path: pathlib.Path, crs: str) -> None:
    written(tmp_path / "log.las", crs=crs)
    assert open_recording(tmp_path / "log.las").crs == crs


def test_shuffled_returns_of_a_pulse_are_joined(tmp_path: pathlib.Path) -> None:
    header = laspy.LasHeader(point_format=1, version="1.2")
    header.scales = np.full(3, 0.001)
    las = laspy.LasData(header)
    las.x, las.y, las.z = np.arange(7.0), np.zeros(7), np.array([3.0, 5, 4, 9, 8, 7, 7])
    las.gps_time = np.array([1.0, 1, 1, 2, 2, 3, 3])
    las.return_number = np.array([3, 1, 2, 1, 2, 1, 1])
    las.number_of_returns = np.array([3, 3, 3, 3, 3, 1, 1])
    las.write(tmp_path / "shuffled.las")
    recording = LasRecording(tmp_path / "shuffled.las")
    scan = next(recording.scans())
    assert scan.echo is not None and scan.echoes is not None and scan.xyz is not None
    assert scan.echo.tolist() == [1, 2, 3, 1, 2, 1, 1]
    assert scan.echoes.tolist() == [3, 3, 3, 2, 2, 1, 1]
    assert scan.xyz[:3, 2].tolist() == [5, 4, 3]
    assert recording.skipped == {"returns that the file lacks, of pulses with several": 1}


def test_withheld_points_are_counted(tmp_path: pathlib.Path) -> None:
    header = laspy.LasHeader(point_format=6, version="1.4")
    las = laspy.LasData(header)
    las.x = las.y = las.z = np.arange(5.0)
    las.gps_time = np.arange(5.0)
    las.return_number = las.number_of_returns = np.ones(5, np.uint8)
    las.withheld = np.array([0, 1, 0, 0, 1])
    las.write(tmp_path / "withheld.laz")
    recording = LasRecording(tmp_path / "withheld.laz")
    assert sum(len(scan) for scan in recording.scans()) == 3
    assert recording.skipped["points flagged as withheld"] == 2


def test_real_files_are_read_as_laspy_reads_them() -> None:
    for name, returns in (("lidr_Topography.laz", 73403), ("treels_pine_plot.laz", 114024)):
        path = data("trees_laz", name)
        scan = next(open_recording(path).scans())
        las = laspy.read(path)
        assert len(scan) == returns == len(las.points) and scan.xyz is not None
        order = np.lexsort(scan.xyz.T)
        np.testing.assert_array_equal(scan.xyz[order], las.xyz[np.lexsort(las.xyz.T)])
    recording = open_recording(data("trees_laz", "lidr_MixedConifer.laz"))
    assert recording.crs == "EPSG:26912"
    scan = next(recording.scans())
    assert len(np.unique(scan.extra["treeID"])) == 206  # 205 trees and none.


def test_what_is_missing_is_one_line_with_the_option(tmp_path: pathlib.Path) -> None:
    _, poses, _ = written(tmp_path / "log.las")
    with pytest.raises(OptionMissing, match=r"log\.las: .*--poses FILE .*--position X,Y,Z"):
        next(beams(open_recording(tmp_path / "log.las")))
    header = laspy.LasHeader(point_format=0, version="1.2")
    las = laspy.LasData(header)
    las.x = las.y = las.z = np.arange(1.0, 5.0)
    las.write(tmp_path / "untimed.las")
    recording = open_recording(tmp_path / "untimed.las")
    assert any("no times (gps_time)" in line for line in recording.found())
    with pytest.raises(OptionMissing, match="no gps_time.*--position X,Y,Z"):
        next(beams(recording, poses=poses))
    back = next(beams(recording, position=(0, 0, 0)))
    np.testing.assert_allclose(back["range_m"], np.sqrt(3) * np.arange(1, 5), rtol=1e-6)


@pytest.mark.parametrize("name", ["log.las", "log.laz"])
def test_damaged_files_are_refused_in_one_line(tmp_path: pathlib.Path, name: str) -> None:
    written(tmp_path / name)
    good = (tmp_path / name).read_bytes()
    bad = {"truncated": good[:len(good) // 2], "short": good[:200],
           "points": good[:247] + struct.pack("<Q", 2**60) + good[255:],
           "records": good[:100] + struct.pack("<I", 2**32 - 1) + good[104:],
           "extended records": good[:235] + struct.pack("<QI", 400, 2**32 - 1) + good[247:],
           "offset": good[:96] + struct.pack("<I", 2**31) + good[100:]}
    for what, content in bad.items():
        (tmp_path / "bad").write_bytes(content)
        with pytest.raises(FormatError, match=r"^[^\n]*bad: [^\n]*$"):
            for _ in open_recording(tmp_path / "bad").scans():
                pass
            pytest.fail(what)


HELIOS = """\
1.0000 2.0000 3.0000 45.6789 4.5000 1 2 7 12 2 100.0001
1.0000 2.0000 2.5000 5.6789 5.5000 2 2 7 13 5 100.0001
4.0000 2.0000 3.0000 45.6789 4.5000 1 1 8 12 2 100.0002
"""


def test_helios_text(tmp_path: pathlib.Path) -> None:
    path = tmp_path / "leg000_points.xyz"
    path.write_text(HELIOS + "7 8 9 nonsense\n" + HELIOS.replace(" 7 ", " 9 "))
    recording = open_recording(path)
    scans = list(recording.scans())
    scan = scans[0]
    assert len(scans) == 1 and scan.xyz is not None and scan.echo is not None and scan.echoes is not None
    assert scan.xyz[0].tolist() == [1, 2, 3]
    assert scan.echo.tolist() == [1, 2, 1, 1, 2, 1] and scan.echoes.tolist() == [2, 2, 1, 2, 2, 1]
    assert scan.extra["class"].tolist() == [2, 5, 2, 2, 5, 2]
    assert scan.extra["hitObjectId"].tolist() == [12, 13, 12, 12, 13, 12]
    np.testing.assert_allclose(scan.extra["pulse_width"][0], 4.5 * 0.299792458 / 2, rtol=1e-6)
    assert recording.skipped == {"lines that are no rows of HELIOS++": 1}


def test_helios_text_and_its_trajectory(tmp_path: pathlib.Path) -> None:
    (tmp_path / "points.xyz").write_text(HELIOS)
    (tmp_path / "trajectory.txt").write_text("0.0 0.0 100.0 100.0 0 0 0\n1.0 0.0 100.0 101.0 0 0 90\n")
    back = next(beams(open_recording(tmp_path / "points.xyz", poses=tmp_path / "trajectory.txt")))
    np.testing.assert_allclose(back["origin"][0], [1e-4, 0, 100], atol=1e-9)
    np.testing.assert_allclose(end_points(back)[2], [4, 2, 3], atol=1e-5)


def test_copc(tmp_path: pathlib.Path) -> None:
    """A LAZ file with chunks of several sizes, as COPC has, is read like any other."""
    lazrs = pytest.importorskip("lazrs")
    log, _, _ = written(tmp_path / "log.las")
    las = laspy.read(tmp_path / "log.las")
    raw = np.frombuffer(las.points.array.tobytes(), np.uint8).reshape(len(las.points), -1)
    vlr = lazrs.LazVlr.new_for_compression(6, las.point_format.num_extra_bytes, True)
    las.header.vlrs.append(laspy.vlrs.VLR("laszip encoded", 22204, "", vlr.record_data()))
    las.header.set_compressed(True)
    with (tmp_path / "varied.laz").open("wb") as out:
        las.header.write_to(out)
        compressor = lazrs.LasZipCompressor(out, vlr)
        for begin, end in ((0, 1000), (1000, 1700), (1700, len(raw))):
            compressor.compress_many(raw[begin:end].reshape(-1))
            compressor.finish_current_chunk()
        compressor.done()
    scan = next(open_recording(tmp_path / "varied.laz").scans())
    np.testing.assert_array_equal(scan.xyz, np.asarray(las.xyz))


def test_classes_of_what_was_hit_become_those_of_las(tmp_path: pathlib.Path) -> None:
    names = ("unknown", "ground", "grass", "low_shrub_patch", "large_shrub", "small_tree", "las_6", "Bark", "leaf")
    log, _ = generated_log(scans=1)
    log["element_class"] = (np.arange(len(log["range_m"])) % (len(names) + 1)).astype(np.uint16)
    with LasWriter(tmp_path / "log.las", element_classes=names) as out:
        out.write(log)
    las = laspy.read(tmp_path / "log.las")
    codes = np.array([1, 2, 3, 3, 4, 5, 6, 1, 5, 1])
    hit = np.isfinite(log["range_m"])
    np.testing.assert_array_equal(las.classification, codes[log["element_class"][hit]])
