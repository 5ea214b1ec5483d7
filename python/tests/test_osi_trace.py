"""OSI traces in MCAP: there and back byte for byte, what other readers see, and damaged files."""
from __future__ import annotations

import pathlib
import struct

import pytest

mcap_reader = pytest.importorskip("mcap.reader", reason="mcap is not installed: pip install 'underbrush[formats]'")
sensorview = pytest.importorskip("osi3.osi_sensorview_pb2", reason="osi-python is not installed")

from format_data import data  # noqa: E402

from underbrush.cli import main  # noqa: E402
from underbrush.formats import FormatError, OptionMissing  # noqa: E402
from underbrush.formats.osi_trace import (  # noqa: E402
    kind_of_trace,
    mcap_to_osi,
    osi_to_mcap,
    read_mcap,
    read_osi,
)


def view(k: int) -> bytes:
    made = sensorview.SensorView()
    made.version.version_major, made.version.version_minor, made.version.version_patch = 3, 7, 1
    made.timestamp.seconds, made.timestamp.nanos = k // 10, k % 10 * 100_000_000
    made.host_vehicle_id.value = 5
    made.global_ground_truth.moving_object.add().base.position.x = k
    return bytes(made.SerializeToString())


def trace(path: pathlib.Path, count: int = 25) -> pathlib.Path:
    path.write_bytes(b"".join(struct.pack("<I", len(view(k))) + view(k) for k in range(count)))
    return path


def test_there_and_back_byte_for_byte(tmp_path: pathlib.Path) -> None:
    source = trace(tmp_path / "drive_sv_371.osi")
    assert osi_to_mcap(source, tmp_path / "drive.mcap", description="a drive") == 25
    assert mcap_to_osi(tmp_path / "drive.mcap", tmp_path / "back_sv_.osi") == 25
    assert (tmp_path / "back_sv_.osi").read_bytes() == source.read_bytes()
    assert list(read_mcap(tmp_path / "drive.mcap", "SensorView")) == list(read_osi(source))


def test_what_other_readers_see(tmp_path: pathlib.Path) -> None:
    osi_to_mcap(trace(tmp_path / "drive_sv_.osi"), tmp_path / "drive.mcap", description="a drive")
    with (tmp_path / "drive.mcap").open("rb") as stream:
        reader = mcap_reader.make_reader(stream)
        metadata = {m.name: m.metadata for m in reader.iter_metadata()}
        found = list(reader.iter_messages())
    assert metadata["net.asam.osi.trace"]["min_osi_version"] == "3.7.1"
    assert {"version", "max_osi_version", "min_protobuf_version", "max_protobuf_version", "zero_time"} \
        <= metadata["net.asam.osi.trace"].keys()
    schema, channel, _ = found[0]
    assert (schema.name, schema.encoding, channel.topic) == ("osi3.SensorView", "protobuf", "SensorView")
    assert channel.metadata["net.asam.osi.trace.channel.osi_version"] == "3.7.1"
    assert [m.log_time for _, _, m in found] == [k * 100_000_000 for k in range(25)]
    descriptor = pytest.importorskip("google.protobuf.descriptor_pb2").FileDescriptorSet.FromString(schema.data)
    pool = pytest.importorskip("google.protobuf.descriptor_pool").DescriptorPool()
    for file in descriptor.file:  # Each stands after those that it uses.
        pool.Add(file)
    factory = pytest.importorskip("google.protobuf.message_factory")
    decoded = factory.GetMessageClass(pool.FindMessageTypeByName("osi3.SensorView")).FromString(found[7][2].data)
    assert decoded.global_ground_truth.moving_object[0].base.position.x == 7


def test_kinds_by_name(tmp_path: pathlib.Path) -> None:
    names = {"a_sv_.osi": "SensorView", "20210818T150542Z_sd_370_f_3_x.osi": "SensorData", "gt_1.osi": "GroundTruth",
             "trace.osi": "", "sv.osi": "SensorView"}
    assert {name: kind_of_trace(name) for name in names} == names
    source = trace(tmp_path / "drive.osi", 3)
    with pytest.raises(OptionMissing, match="kind"):
        osi_to_mcap(source, tmp_path / "x.mcap")
    assert osi_to_mcap(source, tmp_path / "x.mcap", kind="SensorView") == 3


def test_damaged_traces_leave_nothing(tmp_path: pathlib.Path) -> None:
    source, target = trace(tmp_path / "drive_sv_.osi"), tmp_path / "out.mcap"
    whole = source.read_bytes()
    for bad, place in ((whole[:-1], "message 25"), (whole + b"\xff\xff\xff", "message 26"), (b"", "no message"),
                       (b"\xff\xff\xff\xff" + whole, "message 1"), (struct.pack("<I", 2) + b"\x0a\x55", "message 1")):
        source.write_bytes(bad)
        with pytest.raises(FormatError, match=place):
            osi_to_mcap(source, target)
    assert not target.exists()
    source.write_bytes(whole)
    osi_to_mcap(source, target)
    packed = target.read_bytes()
    for bad in (packed[:200], b"\x89MCAP0\r\n", packed[:len(packed) // 2] + b"\xff" * 60, b""):
        target.write_bytes(bad)
        with pytest.raises(FormatError):
            mcap_to_osi(target, tmp_path / "back.osi")
    assert not (tmp_path / "back.osi").exists()


def test_command(tmp_path: pathlib.Path, capsys: pytest.CaptureFixture[str]) -> None:
    source, packed, back = trace(tmp_path / "drive_sv_.osi"), tmp_path / "drive.mcap", tmp_path / "back.osi"
    assert main(["osi", "convert", str(source), "-o", str(packed)]) == 0
    assert main(["osi", "convert", str(packed), "-o", str(back)]) == 0
    assert "25 messages" in capsys.readouterr().out
    assert back.read_bytes() == source.read_bytes()
    for words, code in (([str(packed), "-o", str(tmp_path / "log.ply")], 2),
                        ([str(back), "-o", str(packed)], 2), ([str(tmp_path / "none.mcap"), "-o", str(back)], 4),
                        ([str(packed), "-o", str(back)], 4),
                        ([str(packed), "-o", str(back), "--topic", "x", "--force"], 3)):
        assert main(["osi", "convert", *words]) == code
        assert capsys.readouterr().err.startswith("underbrush: ")


def test_channels_that_are_not_osi(tmp_path: pathlib.Path) -> None:
    writing = pytest.importorskip("mcap.writer")
    with (tmp_path / "two.mcap").open("wb") as stream:
        writer = writing.Writer(stream)
        writer.start()
        for name in ("osi3.SensorView", "osi3.GroundTruth", "other.Thing"):
            channel = writer.register_channel(name, "protobuf", writer.register_schema(name, "protobuf", b""), {})
            writer.add_message(channel, log_time=1, publish_time=1, data=name.encode())
        writer.finish()
    with pytest.raises(OptionMissing, match=r"osi3\.SensorView, osi3\.GroundTruth"):
        list(read_mcap(tmp_path / "two.mcap"))
    assert list(read_mcap(tmp_path / "two.mcap", "osi3.GroundTruth")) == [b"osi3.GroundTruth"]
    with pytest.raises(FormatError, match="no channel"):
        list(read_mcap(tmp_path / "two.mcap", "other.Thing"))


def test_real_trace(tmp_path: pathlib.Path) -> None:
    source = data("osi") / "qc_example_sv_trace.osi"
    count = osi_to_mcap(source, tmp_path / "x.mcap")
    assert count == 547
    assert mcap_to_osi(tmp_path / "x.mcap", tmp_path / "x.osi") == count
    assert (tmp_path / "x.osi").read_bytes() == source.read_bytes()
