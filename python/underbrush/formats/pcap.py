"""Reader of network captures (pcap and pcapng, also compressed with gzip): UDP datagrams with their times."""
from __future__ import annotations

import collections
import gzip
import pathlib
import struct
import zlib
from collections.abc import Callable, Iterator
from typing import IO, NamedTuple

from underbrush.errors import FormatError

_MAX_RECORD = 1 << 18  #: Bytes; tools store no longer packets, so a greater length is damaged.
_MAX_SEARCH = 1 << 22  #: Bytes in which a sound record is looked for after a damaged one.
_MAX_BLOCK = 1 << 24  #: Bytes; other blocks of pcapng may be longer than packets.
_MAX_PARTIAL_BYTES = 8 << 20  #: Memory for datagrams whose fragments have not all come.

#: Magic of a classic capture -> (ticks a second, bytes of a record's header).
_PCAP = {0xA1B2C3D4: (10**6, 16), 0xA1B23C4D: (10**9, 16), 0xA1B2CD34: (10**6, 24)}
_PCAPNG = b"\x0a\x0d\x0d\x0a"

#: Link type -> (offset of the EtherType, offset of what follows it); see tcpdump.org/linktypes.html.
_LINK = {1: (12, 14), 113: (14, 16), 276: (0, 20)}
_RAW_IP = (12, 14, 101, 228, 229)
_LOOPBACK = (0, 108)
_VLAN = (b"\x81\x00", b"\x88\xa8", b"\x91\x00")

_CUT = "packets cut off by the capture (its snapshot length was too small)"
_LOST = "datagrams with lost fragments"
_CUT_OFF = "record cut off at the end of the file"
_DAMAGED = "damaged stretch of the file"


class Datagram(NamedTuple):
    """One UDP datagram, put together from its fragments."""

    time_s: float  #: Time of capture (of its last fragment), s since 1970.
    source: bytes  #: Address of the sender: 4 bytes for IPv4, 16 for IPv6.
    port: int  #: Destination port.
    data: bytes


class Capture:
    """A capture file. It is read in bounded memory, one packet at a time.

    `skipped` counts what was left out, by reason; packets that are no UDP are not counted.
    """

    def __init__(self, path: str | pathlib.Path) -> None:
        """Opens `path`. Raises OSError, or FormatError where the file is no capture."""
        self.path = pathlib.Path(path)
        self.skipped: collections.Counter[str] = collections.Counter()
        self._ahead, self._at = b"", 0  # Bytes that were read ahead, and the place of the next one.
        self._raw = self.path.open("rb")
        self.bytes_total = self.path.stat().st_size
        magic = self._raw.read(4)
        self._raw.seek(0)
        self._file: IO[bytes] = self._raw
        if magic[:2] == b"\x1f\x8b":
            self._file = gzip.GzipFile(fileobj=self._raw)  # type: ignore[assignment]
            magic = self._read(4)
            self._file.seek(0)
        self._is_ng = magic == _PCAPNG
        self._order = next((o for o in "<>" if len(magic) == 4 and struct.unpack(o + "I", magic)[0] in _PCAP), "")
        if not self._is_ng and not self._order:
            self._raw.close()
            raise FormatError(path, "byte 0", "is no capture (pcap or pcapng)")
        self._fragments: dict[bytes, _Fragments] = {}
        self._fragment_bytes = 0

    @property
    def bytes_done(self) -> int:
        """Bytes of the file read so far."""
        return self.bytes_total if self._raw.closed else min(self._raw.tell(), self.bytes_total)

    def datagrams(self) -> Iterator[Datagram]:
        """Yields all UDP datagrams in order and closes the file. It can be called once."""
        with self._raw:
            for time_s, link, frame, length in self._packets_ng() if self._is_ng else self._packets():
                try:
                    datagram = self._datagram(time_s, link, frame, length)
                except (struct.error, IndexError):
                    self.skipped["packets with a damaged header"] += 1
                    continue
                if datagram is not None:
                    yield datagram
            if self._fragments:
                self.skipped[_LOST] += len(self._fragments)

    def _read(self, size: int) -> bytes:
        data = self._ahead[self._at:self._at + size]
        self._at += len(data)
        return data + self._from_file(size - len(data)) if len(data) < size else data

    def _from_file(self, size: int) -> bytes:
        try:
            return self._file.read(size)
        except (EOFError, zlib.error, gzip.BadGzipFile):
            self.skipped["damaged gzip stream; the rest of the file is left out"] += 1
            return b""

    def _give_back(self, data: bytes) -> None:
        before = self._at - len(data)
        if before >= 0 and self._ahead[before:self._at] == data:
            self._at = before
        else:
            self._ahead, self._at = data + self._ahead[self._at:], 0

    def _resume(self, damaged: bytes, sound: Callable[[bytes, int], bool], reason: str) -> bool:
        """Goes on where `sound(data, place)` first holds after the start of a damaged record; False: nowhere.

        It reads ahead more than it searches, so that many damaged records do not each copy what was read."""
        self.skipped[reason] += 1
        self._give_back(damaged[1:])
        if len(self._ahead) - self._at < _MAX_SEARCH:
            self._ahead, self._at = self._ahead[self._at:] + self._from_file(2 * _MAX_SEARCH), 0
        end = min(len(self._ahead), self._at + _MAX_SEARCH)
        place = next((place for place in range(self._at, end - 16) if sound(self._ahead, place)), None)
        if place is None:
            self._at = end
            if self._read(1):
                self.skipped["damaged file; its rest is left out"] += 1
            return False
        self._at = place
        return True

    def _packets(self) -> Iterator[tuple[float, int, bytes, int]]:
        header = self._read(24)
        if len(header) < 24:
            self.skipped[_CUT_OFF] += 1
            return
        ticks, header_bytes = _PCAP[struct.unpack(self._order + "I", header[:4])[0]]
        link = struct.unpack(self._order + "I", header[20:])[0] & 0xFFFF
        record = struct.Struct(self._order + "IIII")
        last = 0

        def sound(data: bytes, place: int, follow: bool = True) -> bool:
            if place + 16 > len(data):
                return not follow
            seconds, fraction, stored, length = record.unpack_from(data, place)
            return (0 < stored <= length <= _MAX_RECORD and fraction < ticks and abs(seconds - last) < 86400
                    and (not follow or sound(data, place + header_bytes + stored, False)))

        while head := self._read(header_bytes):
            if len(head) < header_bytes:
                self.skipped[_CUT_OFF] += 1
                return
            seconds, fraction, stored, length = record.unpack_from(head)
            if stored > _MAX_RECORD or (stored > length and fraction >= ticks):
                if not self._resume(head, sound, _DAMAGED):
                    return
                continue
            frame = self._read(stored)
            if len(frame) < stored:
                if not self._resume(head + frame, sound, _CUT_OFF):
                    return
                continue
            last = seconds
            yield seconds + fraction / ticks, link, frame, length

    def _packets_ng(self) -> Iterator[tuple[float, int, bytes, int]]:
        order, interfaces, last_s = "<", list[tuple[int, int, int]](), 0.0

        def sound(data: bytes, place: int) -> bool:
            kind, size = struct.unpack_from(order + "II", data, place)
            end = place + size
            return kind in (3, 5, 6) and 16 <= size <= _MAX_RECORD and data[end - 4:end] == data[place + 4:place + 8]

        while head := self._read(8):
            if head[:4] == _PCAPNG:
                mark = self._read(4)
                order, interfaces = ">" if mark == b"\x1a\x2b\x3c\x4d" else "<", []
                self._give_back(mark)
            if len(head) < 8:
                self.skipped[_CUT_OFF] += 1
                return
            kind, size = struct.unpack(order + "II", head)
            body = self._read(size - 8) if 12 <= size <= _MAX_BLOCK else b""
            if body[-4:] != head[4:] or len(body) + 8 != size:
                if not self._resume(head + body, sound, _CUT_OFF if len(body) + 8 < size else _DAMAGED):
                    return
                continue
            try:
                if kind == 1:
                    interfaces.append(_interface(order, body))
                elif kind in (2, 6):  # Packet (old) and enhanced packet.
                    number, high, low, stored, length = struct.unpack_from(order + "IIIII", body)
                    link, ticks, offset = interfaces[number & 0xFFFF if kind == 2 else number]
                    last_s = ((high << 32) | low) / ticks + offset
                    yield last_s, link, body[20:min(20 + stored, len(body) - 4)], length
                elif kind == 3:  # Simple packet, which has no time: it gets the time before it.
                    length = struct.unpack_from(order + "I", body)[0]
                    yield last_s, interfaces[0][0], body[4:min(4 + length, len(body) - 4)], length
            except (struct.error, IndexError):
                self.skipped["damaged block"] += 1

    def _datagram(self, time_s: float, link: int, frame: bytes, length: int) -> Datagram | None:
        start = _ip_start(link, frame)
        if start is None:
            return None
        version = frame[start] >> 4
        more, offset = False, 0
        if version == 4:
            header = (frame[start] & 15) * 4
            total, identity, flags = struct.unpack_from(">HHH", frame, start + 2)
            protocol, addresses = frame[start + 9], frame[start + 12:start + 20]
            more, offset = bool(flags & 0x2000), (flags & 0x1FFF) * 8
            end, begin = start + (total or length - start), start + header  # Offloading leaves a total of 0.
            key = addresses + struct.pack(">HB", identity, protocol)
        elif version == 6:
            total, protocol = struct.unpack_from(">HB", frame, start + 4)
            addresses = frame[start + 8:start + 40]
            begin, end = start + 40, start + 40 + total
            if protocol == 44:
                protocol, _, flags, identity = struct.unpack_from(">BBHI", frame, begin)
                more, offset, begin = bool(flags & 1), flags & 0xFFF8, begin + 8
                key = addresses + struct.pack(">IB", identity, protocol)
        else:
            return None
        if protocol != 17:
            return None
        if end > len(frame):
            self.skipped[_CUT if length > len(frame) else "packets shorter than stated in their header"] += 1
            return None
        payload: bytes | None = frame[begin:end]
        if more or offset:
            payload = self._join(key, offset, frame[begin:end], more)
            if payload is None:
                return None
        assert payload is not None
        _, port, size = struct.unpack_from(">HHH", payload)
        if size > len(payload):
            self.skipped["datagrams shorter than stated in their header"] += 1
            return None
        source = addresses[:len(addresses) // 2]
        return Datagram(time_s, source, port, payload[8:size or len(payload)])

    def _join(self, key: bytes, offset: int, part: bytes, more: bool) -> bytes | None:
        """Keeps a fragment. Returns the payload once all its fragments are there."""
        fragments = self._fragments.setdefault(key, _Fragments())
        self._fragment_bytes -= fragments.cost
        fragments.add(offset, part, more)
        self._fragment_bytes += fragments.cost
        if fragments.size == fragments.end:
            self._fragment_bytes -= self._fragments.pop(key).cost
            return fragments.joined()
        while self._fragment_bytes > _MAX_PARTIAL_BYTES:
            self._fragment_bytes -= self._fragments.pop(next(iter(self._fragments))).cost
            self.skipped[_LOST] += 1
        return None


class _Fragments:
    """The fragments of one datagram that have come."""

    def __init__(self) -> None:
        self.parts: dict[int, bytes] = {}
        self.size, self.end = 0, -1

    @property
    def cost(self) -> int:
        """Memory in use, bytes."""
        return self.size + 200 * len(self.parts)

    def add(self, offset: int, part: bytes, more: bool) -> None:
        self.size += len(part) - len(self.parts.get(offset, b""))
        self.parts[offset] = part
        if not more:
            self.end = offset + len(part)

    def joined(self) -> bytes:
        return b"".join(part for _, part in sorted(self.parts.items()))


def _ip_start(link: int, frame: bytes) -> int | None:
    """Where the IP packet begins in a frame of the link layer; None for other protocols."""
    if link in _RAW_IP:
        return 0
    if link in _LOOPBACK:
        return 4
    if link not in _LINK:
        return None
    at, start = _LINK[link]
    kind = frame[at:at + 2]
    while kind in _VLAN:
        kind, start = frame[start + 2:start + 4], start + 4
    return start if kind in (b"\x08\x00", b"\x86\xdd") else None


def _interface(order: str, body: bytes) -> tuple[int, int, int]:
    """Link type, ticks a second and offset (s) of an interface description."""
    link, ticks, offset, at = struct.unpack_from(order + "H", body)[0], 10**6, 0, 8
    while at + 4 <= len(body):
        code, size = struct.unpack_from(order + "HH", body, at)
        if code == 0:
            break
        if code == 9:  # if_tsresol
            value = body[at + 4]
            ticks = 1 << (value & 0x7F) if value & 0x80 else 10**value
        elif code == 14:  # if_tsoffset
            offset = struct.unpack_from(order + "q", body, at + 4)[0]
        at += 4 + (size + 3) // 4 * 4
    return link, ticks, offset
