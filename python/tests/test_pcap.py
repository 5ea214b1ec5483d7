"""The reader of captures: every container and link layer gives the same datagrams; damage is counted."""
from __future__ import annotations

import gzip
import pathlib
import struct
import sys
import time

import pytest

import mutate_packets
from packet_files import LINKS, T0, pcap, pcapng, udp
from underbrush.errors import FormatError
from underbrush.formats.pcap import Capture, Datagram

PAYLOADS = [bytes([number]) * (100 + number) for number in range(5)]
TIMES = [T0 + 0.25 * number for number in range(5)]
RECORDS = [(time_s, udp(payload)[0]) for time_s, payload in zip(TIMES, PAYLOADS)]


def read(tmp_path: pathlib.Path, data: bytes) -> tuple[list[Datagram], dict[str, int]]:
    path = tmp_path / "a.pcap"
    path.write_bytes(data)
    capture = Capture(path)
    datagrams = list(capture.datagrams())
    assert capture.bytes_done == capture.bytes_total == len(data)
    return datagrams, dict(capture.skipped)


@pytest.mark.parametrize("order", "<>")
@pytest.mark.parametrize("nano", [False, True])
@pytest.mark.parametrize("link", LINKS)
def test_classic_captures(tmp_path: pathlib.Path, order: str, nano: bool, link: str) -> None:
    datagrams, skipped = read(tmp_path, pcap(RECORDS, order, nano, link))
    assert [datagram.data for datagram in datagrams] == PAYLOADS
    assert [datagram.time_s for datagram in datagrams] == pytest.approx(TIMES, abs=1e-6)
    assert {(datagram.source, datagram.port) for datagram in datagrams} == {(bytes([192, 168, 1, 201]), 2368)}
    assert not skipped


@pytest.mark.parametrize("order", "<>")
@pytest.mark.parametrize("resolution", [None, 3, 6, 9, 0x80 | 20])
@pytest.mark.parametrize("link", ["ethernet", "vlan", "cooked 2"])
def test_pcapng(tmp_path: pathlib.Path, order: str, resolution: int | None, link: str) -> None:
    datagrams, skipped = read(tmp_path, pcapng(RECORDS, order, resolution, 1000, link))
    assert [datagram.data for datagram in datagrams] == PAYLOADS
    assert [datagram.time_s for datagram in datagrams] == pytest.approx(TIMES, abs=1e-6)
    assert not skipped


def test_pcapng_of_two_sections_and_simple_packets(tmp_path: pathlib.Path) -> None:
    datagrams, skipped = read(tmp_path, pcapng(RECORDS, "<") + pcapng(RECORDS, ">", simple=True))
    assert [datagram.data for datagram in datagrams] == PAYLOADS * 2
    assert datagrams[-1].time_s == pytest.approx(TIMES[-1])  # The time before it.
    assert not skipped


def test_gzip_and_its_damage(tmp_path: pathlib.Path) -> None:
    whole = gzip.compress(pcap(RECORDS))
    assert [datagram.data for datagram in read(tmp_path, whole)[0]] == PAYLOADS
    datagrams, skipped = read(tmp_path, whole[:-30])
    assert len(datagrams) < 5 and skipped


@pytest.mark.parametrize("version", [4, 6])
def test_fragments_in_any_order(tmp_path: pathlib.Path, version: int) -> None:
    payload = bytes(range(256)) * 49
    first, second = (udp(payload, identity=number, mtu=1500, version=version) for number in (1, 2))
    assert len(first) > 8
    mixed = [part for pair in zip(first, reversed(second)) for part in pair]
    datagrams, skipped = read(tmp_path, pcap([(T0, part) for part in mixed + [mixed[0]]]))
    assert [datagram.data for datagram in datagrams] == [payload, payload]
    assert skipped == {"datagrams with lost fragments": 1}  # The fragment that came again.


def test_lost_fragments_take_bounded_memory(tmp_path: pathlib.Path) -> None:
    parts = [(T0, udp(b"a" * 60000, identity=number)[0][:20 + 30000]) for number in range(1000)]
    broken = [(time_s, ip[:2] + struct.pack(">H", len(ip)) + ip[4:6] + b"\x20\x00" + ip[8:]) for time_s, ip in parts]
    path = tmp_path / "a.pcap"
    path.write_bytes(pcap(broken))
    capture = Capture(path)
    assert not list(capture.datagrams())
    assert capture.skipped == {"datagrams with lost fragments": 1000}
    assert capture._fragment_bytes <= 8 << 20


@pytest.mark.parametrize("make", [pcap, pcapng])
def test_cut_file_keeps_what_is_whole(tmp_path: pathlib.Path, make: object) -> None:
    data = pcap(RECORDS) if make is pcap else pcapng(RECORDS)
    datagrams, skipped = read(tmp_path, data[:-20])
    assert [datagram.data for datagram in datagrams] == PAYLOADS[:4]
    assert skipped == {"record cut off at the end of the file": 1}


@pytest.mark.parametrize("make", [pcap, pcapng])
def test_damaged_stretch_is_passed_over(tmp_path: pathlib.Path, make: object) -> None:
    data = bytearray(pcap(RECORDS) if make is pcap else pcapng(RECORDS))
    place = data.find(PAYLOADS[1]) - (58 if make is pcap else 70)  # Its record's header.
    data[place:place + 40] = b"\xff" * 40
    datagrams, skipped = read(tmp_path, bytes(data))
    assert [datagram.data for datagram in datagrams] == [PAYLOADS[0], *PAYLOADS[2:]]
    assert sum(skipped.values()) == 1


def test_short_snapshots_are_counted(tmp_path: pathlib.Path) -> None:
    datagrams, skipped = read(tmp_path, pcap(RECORDS, cut=96))
    assert not datagrams
    assert skipped == {"packets cut off by the capture (its snapshot length was too small)": 5}


def test_zeros_at_the_end(tmp_path: pathlib.Path) -> None:
    datagrams, _ = read(tmp_path, pcap(RECORDS) + b"\0" * 4096)
    assert [datagram.data for datagram in datagrams] == PAYLOADS


@pytest.mark.parametrize("data", [b"", b"\0", b"PK\3\4" * 20, b"\x1f\x8b\x08\x00garbage..."])
def test_other_files_are_refused(tmp_path: pathlib.Path, data: bytes) -> None:
    path = tmp_path / "x.pcap"
    path.write_bytes(data)
    with pytest.raises(FormatError, match="x.pcap: byte 0: is no capture"):
        Capture(path)


def test_mutants_are_read_or_refused(tmp_path: pathlib.Path) -> None:
    """A few of those that `mutate_packets.py` makes."""
    assert sum(mutate_packets.run("container", 90, 20, tmp_path).values()) == 90


def test_the_time_for_damaged_records_does_not_grow_with_what_follows_them(tmp_path: pathlib.Path) -> None:
    """A damaged record behind each two sound ones, 8 MB of them."""
    one = pcap(RECORDS[:1])
    record, count = one[24:], 20_000
    damaged = record[:8] + struct.pack("<II", 1 << 30, 1 << 30)
    start = time.process_time()
    datagrams, skipped = read(tmp_path, one[:24] + (record * 2 + damaged) * count)
    assert time.process_time() - start < 10
    assert len(datagrams) == 2 * count
    assert skipped == {"damaged stretch of the file": count}


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="measures memory as Linux counts it")
@pytest.mark.parametrize("family", mutate_packets.FAMILIES)
def test_captures_whose_fields_lie_are_read_or_counted(family: str, tmp_path: pathlib.Path) -> None:
    assert sum(mutate_packets.run_lies(family, 20, tmp_path).values()) >= 20
