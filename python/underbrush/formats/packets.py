"""Recordings of the packets of lidars in network captures: Velodyne's, Ouster's, Hesai's and Livox's."""
from __future__ import annotations

import collections
import datetime
import ipaddress
import itertools
import math
import pathlib
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from underbrush.errors import FormatError
from underbrush.formats import ouster, velodyne
from underbrush.formats.makers import MAKERS, Decoder, Maker, Probe
from underbrush.formats.ouster_metadata import SIZES, Metadata
from underbrush.formats.pcap import Capture, Datagram
from underbrush.formats.scans import Poses, Scan, middles

Floats = npt.NDArray[np.float64]
_PROBE_PACKETS = 9_000  #: The calibration of an HDL-64E takes 4160 packets to come, wherever it begins.
_PROBE_DATAGRAMS = 1_000_000
_PROBE_BYTES = 16 << 20
_BATCH_BYTES = 1 << 20


class _Stream(NamedTuple):
    """Where packets come from and go to."""

    source: bytes
    port: int

    def __str__(self) -> str:
        return f"{ipaddress.ip_address(self.source)}:{self.port}" if self.port >= 0 else self.source.decode()


class PacketRecording:
    """A capture (pcap or pcapng) of one sensor's packets, misses included. It is read in bounded memory.

    Scans have beams (`direction`, `range_m`, `origin` where beams do not start at the sensor's origin). A revolution
    of a Velodyne begins at the rear and that of a Hesai at the maker's y axis, as in the sensor catalogue; a scan of an
    Ouster is one frame, and that of a Livox 0.1 s long. Partial revolutions at both ends of the file are scans, too.
    Rows are in order of time; rows of one beam follow each other in order of range, and equal ranges of a beam are one
    row. Intensity is the reflectivity of Velodyne, Hesai and Livox (0 to 255) and Ouster's signal, or its reflectivity
    where the profile has no signal; all of Ouster's fields and Livox's tag are in `extra`.
    """

    numbered = True
    crs = ""
    world = False
    poses: Poses | None = None

    def __init__(self, path: str | pathlib.Path, metadata: str | pathlib.Path | None = None, sensor: str | None = None,
                 stream: str | None = None, clock: str = "auto") -> None:
        """Opens the capture and finds its sensor.

        `metadata` is the JSON file of an Ouster (default: FILE.json or FILE_0.json beside the capture), the calibration
        of a Velodyne (XML of VeloView or YAML of the ROS driver), or the angle correction of a Hesai (CSV, DAT of an
        AT128, or a folder with the files of angles and of firing times). `sensor` is a name of the catalogue, for
        sensors whose packets do not contain their model. `stream` is 'ADDRESS:PORT', 'ADDRESS' or 'PORT', where several
        sensors are in one capture. `clock` 'sensor' takes the sensor's stamps as they are, 'capture' takes their
        intervals only and begins with the time of capture, and 'auto' chooses as described at `Clock`. Raises OSError,
        or FormatError with one line that names what is missing.
        """
        self.path = pathlib.Path(path)
        self.skipped: collections.Counter[str] = collections.Counter()
        self._metadata_path = pathlib.Path(metadata) if metadata is not None else None
        self._sensor_given = sensor
        self._wanted = stream
        self._clock = clock
        self._totals = _Totals()
        self._capture: Capture | None = None
        self.bytes_total = self.path.stat().st_size
        self._ouster: Metadata | None = None
        self._reference_s = 0.0
        self._probe(self._captured())
        self._decoder = self._open(collections.Counter())
        self.sensor: str = sensor or self._decoder.sensor
        self.organised = self._decoder.organised

    @property
    def bytes_done(self) -> int:
        """Bytes read so far, for progress."""
        return self._capture.bytes_done if self._capture is not None else 0

    def found(self) -> list[str]:
        """Lines that describe the recording.

        Counts are those of the scans read so far; if none have been read, those of the first packets, with a note.
        """
        decoder, totals, skipped = self._decoder, self._totals, self.skipped
        note = ""
        if not totals.packets:
            skipped, totals = collections.Counter(), _Totals()
            decoder = self._open(skipped)
            limit = 4 * 1024 * 1024 // decoder.packet_bytes
            for _ in self._scans(self._captured(), decoder, skipped, totals, limit):
                pass
            note = " (of the file's beginning)" if totals.packets >= limit else ""
        lines = [f"sensor: {decoder.title}" + (f" ({decoder.sensor})" if decoder.sensor else "")
                 + f", {' and '.join(sorted(decoder.modes)) or 'strongest return'}, from {self._stream}"]
        lines += [line + note for line in totals.lines()] + decoder.found()
        return lines + [f"left out: {count} {reason}" for reason, count in sorted(skipped.items()) if count]

    def scans(self) -> Iterator[Scan]:
        """Yields all scans in order. Each call reads the file anew; broken packets are counted in `skipped`."""
        self.skipped.clear()
        self._totals = _Totals()
        self._capture = self._captured()
        yield from self._scans(self._capture, self._open(self.skipped), self.skipped, self._totals)

    def pose_times(self) -> Floats:
        """Times (s) of the middles of the scans, where poses have none."""
        return middles(self.scans())

    def _captured(self) -> Any:
        """The packets from the beginning: what has `datagrams`, `skipped` and `bytes_done`."""
        return Capture(self.path)

    def _metadata_inside(self) -> tuple[Metadata | None, str]:
        """The metadata of an Ouster in the recording itself, and their place."""
        return None, ""

    def _scans(self, capture: Capture, decoder: Decoder, skipped: collections.Counter[str], totals: _Totals,
               limit: float = math.inf) -> Iterator[Scan]:
        self._decoder = decoder
        batches = self._batches(capture, decoder, skipped, limit)
        for batch in batches:
            captured_s = np.array([datagram.time_s for datagram in batch])
            totals.add_packets(len(batch))
            yield from map(totals.add, decoder.decode([datagram.data for datagram in batch], captured_s))
        yield from map(totals.add, decoder.finish())
        skipped.update(capture.skipped)
        for reason in [reason for reason, count in skipped.items() if not count]:
            del skipped[reason]

    def _batches(self, capture: Capture, decoder: Decoder, skipped: collections.Counter[str],
                 limit: float) -> Iterator[list[Datagram]]:
        """The stream's packets, without those that were captured twice in a row, many at a time."""
        batch: list[Datagram] = []
        last, count = b"", 0
        for datagram in capture.datagrams():
            if datagram.port != self._stream.port or datagram.source != self._stream.source:
                skipped["datagrams to other ports or of other senders"] += 1
            elif reason := decoder.unfit(datagram.data):
                skipped[reason] += 1
            elif datagram.data == last:
                skipped["packets captured twice"] += 1
            else:
                batch.append(datagram)
                last, count = datagram.data, count + 1
                if len(batch) * len(last) >= _BATCH_BYTES or count >= limit:
                    yield batch
                    batch = []
                    if count >= limit:
                        return
        if batch:
            yield batch

    def _probe(self, capture: Capture) -> None:
        """Reads the beginning of the file: finds the sensor's stream, metadata and reference of time."""
        unread = self._read_metadata()
        size = self._ouster.packet.itemsize if self._ouster is not None else None
        streams: dict[_Stream, list[Datagram]] = {}
        makers: dict[_Stream, collections.Counter[Maker]] = {}
        lengths: collections.Counter[tuple[int, int]] = collections.Counter()
        fitting = set()
        for datagram in itertools.islice(capture.datagrams(), _PROBE_DATAGRAMS):
            key, data = _Stream(datagram.source, datagram.port), datagram.data
            lengths[datagram.port, len(data)] += 1
            if len(data) == velodyne.POSITION_BYTES and not self._reference_s:
                utc = velodyne.utc_of(data)
                self._reference_s = 0.0 if utc is None else utc - datagram.time_s
            maker = next((maker for maker in MAKERS if maker.recognise(data)), None)
            if len(data) == size:
                fitting.add(key)
            elif maker is None and len(data) not in SIZES:
                continue
            streams.setdefault(key, []).append(datagram)
            makers.setdefault(key, collections.Counter()).update([maker] if maker is not None else [])
            if len(streams[key]) >= _PROBE_PACKETS or len(streams[key]) * len(data) > _PROBE_BYTES:
                break
        self._stream = self._choose(streams, lengths, fitting, capture.skipped)
        first, found = streams[self._stream], makers[self._stream].most_common(1)
        if self._stream in fitting:
            return
        if self._ouster is not None and (not found or self._metadata_path is not None):
            raise self._error(f"packets of {len(first[0].data)} bytes from {self._stream} do not fit the metadata "
                              f"{self._metadata_name}, whose packets "
                              f"({self._ouster.profile_name}, {self._ouster.rows} rows) have {size} bytes")
        if not found:
            hint = ", ".join(sorted(path.name for path in self.path.parent.glob("*.json"))[:4])
            raise unread or self._error(
                f"packets of {len(first[0].data)} bytes from {self._stream} look like an Ouster's, which need its "
                f"metadata: add --metadata {self._beside()[0].name}" + (f" (beside it lie {hint})" if hint else ""))
        self._ouster, self._maker = None, found[0][0]
        known = [datagram for datagram in first if self._maker.recognise(datagram.data)]
        self._first = Probe([datagram.data for datagram in known], np.array([datagram.time_s for datagram in known]),
                             self._sensor_given, self._metadata_path, self._reference_s, self._clock)

    def _beside(self) -> list[pathlib.Path]:
        """Where the metadata of an Ouster lie by default."""
        stem = self.path.name.removesuffix(".gz").rpartition(".")[0] or self.path.name
        return [self.path.with_name(stem + end) for end in (".json", "_0.json")]

    def _read_metadata(self) -> FormatError | None:
        """Reads an Ouster's metadata; an error of those beside the capture matters for an Ouster only."""
        given = self._metadata_path
        if given is not None and given.suffix.lower() == ".json":
            self._ouster, self._metadata_name = Metadata.read(given), str(given)
        if given is not None:
            return None
        for path in self._beside():
            if path.is_file():
                try:
                    self._ouster, self._metadata_name = Metadata.read(path), path.name
                except FormatError as error:
                    return error
                return None
        self._ouster, self._metadata_name = self._metadata_inside()
        return None

    def _choose(self, streams: dict[_Stream, list[Datagram]], lengths: collections.Counter[tuple[int, int]],
                fitting: set[_Stream], skipped: collections.Counter[str]) -> _Stream:
        if self._wanted is not None:
            streams = {key: value for key, value in streams.items()
                       if self._wanted in (str(key), str(key.port), str(ipaddress.ip_address(key.source)))}
        elif self._ouster is not None:
            ported = {key for key in fitting if key.port == self._ouster.port} or fitting
            streams = {key: value for key, value in streams.items() if key in ported} or streams
        # A few packets that only have the right length are no sensor.
        most = max(map(len, streams.values()), default=0)
        streams = {key: value for key, value in streams.items() if len(value) * 20 >= most}
        if not streams:
            usual = ", ".join(f"{count} of {length} bytes to port {port}"
                              for (port, length), count in lengths.most_common(3))
            wanted = f" of '{self._wanted}'" if self._wanted is not None else ""
            reasons = "".join(f"; {count} {reason}" for reason, count in skipped.items())
            raise self._error(f"has no packets{wanted} of a Velodyne, Ouster, Hesai or Livox; it has "
                              f"{usual or 'no UDP datagrams'}{reasons}")
        if len(streams) > 1:
            names = [str(key) for key in streams]
            raise self._error(f"has {len(names)} sensors: add " + " or ".join(f"--topic {name}" for name in names))
        return next(iter(streams))

    def _open(self, skipped: collections.Counter[str]) -> Decoder:
        """A new decoder, which counts in `skipped` what it leaves out."""
        try:
            if self._ouster is not None:
                return ouster.Decoder(self._ouster, skipped, self._clock)
            return self._maker.decoder(self._first, skipped)
        except FormatError:
            raise
        except ValueError as error:
            raise self._error(str(error)) from error

    def _error(self, reason: str) -> FormatError:
        return FormatError(self.path, "", reason)


class _Totals:
    """Counts over all scans."""

    def __init__(self) -> None:
        self.packets = self.scans = self.beams = self.returns = self.misses = 0
        self.first_s, self.last_s = math.inf, -math.inf

    def add_packets(self, count: int) -> None:
        self.packets += count

    def add(self, scan: Scan) -> Scan:
        assert scan.range_m is not None and scan.beam_time_s is not None and scan.echo is not None
        self.scans += 1
        self.returns += int(np.count_nonzero(scan.echo))
        self.misses += len(scan) - int(np.count_nonzero(scan.echo))
        self.beams += int(np.count_nonzero(scan.echo <= 1))
        self.first_s = min(self.first_s, float(scan.beam_time_s.min()))
        self.last_s = max(self.last_s, float(scan.beam_time_s.max()))
        return scan

    def lines(self) -> list[str]:
        if not self.beams:
            return [f"{self.packets} packets without a sound beam"]
        span = self.last_s - self.first_s
        rate = f", {self.packets / span:.0f} packets/s" if span > 0 else ""
        return [f"{self.packets} packets in {span:.3f} s{rate}, {self.scans} scans, from {_utc(self.first_s)} to "
                f"{_utc(self.last_s)}",
                f"{self.beams} beams: {self.returns} returns, {self.misses} misses "
                f"({100 * self.misses / self.beams:.1f} % of the beams)"]


def _utc(time_s: float) -> str:
    """A time as text."""
    if not 0 <= time_s < 4e9:
        return f"{time_s:.6f} s"
    return datetime.datetime.fromtimestamp(time_s, datetime.timezone.utc).strftime("%Y-%m-%dT%H:%M:%S.%fZ")
