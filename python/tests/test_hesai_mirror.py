"""Packets of Hesai's AT128: its mirror's angles and correction file, in closed form in a room."""
from __future__ import annotations

import pathlib

import numpy as np
import pytest

import packet_files as pf
from hesai_mirror_unit import correction, direction_at, packets, sweeps
from underbrush.errors import FormatError
from underbrush.formats import catalogue
from underbrush.formats.packets import PacketRecording
from velodyne_unit import joined, save


@pytest.mark.parametrize(("returns", "flags"), [(1, 1), (1, 9), (2, 0)])
def test_every_beam_in_a_room(tmp_path: pathlib.Path, returns: int, flags: int) -> None:
    mirror, time_s = sweeps(4)
    direction = direction_at(mirror)
    near = np.round(pf.room_range(direction) / 0.004).astype(np.int64)
    near[:, :20] = 0
    counts = np.stack([near, np.where((near > 0) & (np.arange(128) % 3 == 0), near + 300, near)], axis=1)[:, :returns]
    path = save(tmp_path / "a.pcap", packets(mirror, time_s, counts, returns, flags))
    recording = PacketRecording(path, correction(tmp_path / "c.dat"))
    assert recording.sensor == "hesai-at128" and recording.organised
    scans = list(recording.scans())
    assert not recording.skipped and len(scans) == 4
    file = catalogue.load("hesai-at128")
    order = np.argsort(file.time_s, kind="stable")
    beam = np.cumsum(joined(scans, "echo") <= 1) - 1
    assert beam[-1] + 1 == 4 * 1200 * 128
    assert (joined(scans, "ring") == np.tile(order, 4800)[beam]).all()
    expected = (time_s[:, None] + file.time_s[order]).ravel()
    assert np.abs(joined(scans, "beam_time_s") - expected[beam]).max() < 2e-6
    angle = np.linalg.norm(joined(scans, "direction") - direction[:, order].reshape(-1, 3)[beam], axis=1)
    assert np.degrees(angle).max() < 2e-3
    hits = (joined(scans, "echo") == 1)
    np.testing.assert_allclose(joined(scans, "range_m")[hits], near[:, order].ravel()[beam][hits] * 0.004, atol=1e-4)
    assert (joined(scans, "echo") == 0).sum() == (near == 0).sum()
    assert joined(scans, "echoes").max() == returns
    ahead = np.degrees(np.arctan2(joined(scans, "direction")[:, 1], joined(scans, "direction")[:, 0]))
    assert 57 < ahead.max() < 64 and -64 < ahead.min() < -57  # The field of view lies about the x axis.


def test_it_needs_its_file(tmp_path: pathlib.Path) -> None:
    mirror, time_s = sweeps(1)
    path = save(tmp_path / "a.pcap", packets(mirror[:40], time_s[:40], np.zeros((40, 1, 128), int), 1))
    with pytest.raises(FormatError, match="a Hesai AT128 needs the angles.*--metadata CORRECTION.dat"):
        PacketRecording(path)
    good = correction(tmp_path / "c.dat").read_bytes()
    for bad in (b"", good[:3], good[:-33], b"\0" + good[1:], good[:2] + b"\1\3" + good[4:], good[:4] + b"\1" + good[5:],
                good[:5] + b"\0" + good[6:], good[:16] + b"\xff" * 12 + good[28:], good[:40] + b"\xff\xff\xff\x7f" + good[44:],
                b"Channel,Elevation,Azimuth\n1,2,3\n"):
        (tmp_path / "c.dat").write_bytes(bad)
        with pytest.raises(FormatError, match="c.dat: ") as error:
            PacketRecording(path, tmp_path / "c.dat")
        assert "\n" not in str(error.value)
