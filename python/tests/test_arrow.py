"""Logs and models as Arrow's tables: nothing is copied, tables outlive what they are of, and logs come back."""
from __future__ import annotations

import gc
import pathlib

import duckdb
import numpy as np
import pyarrow as pa
import pyarrow.dataset
import pytest

import underbrush

COLUMNS = ("origin", "direction", "range_m", "intensity", "time_s", "ring", "scan", "packet", "flags")


def numbers(column: pa.ChunkedArray) -> np.ndarray:
    """The numbers of a column, those of lists one after the other."""
    values = column.combine_chunks()
    return np.asarray((values.flatten() if pa.types.is_fixed_size_list(values.type) else values).to_numpy())


def three_minutes(log: underbrush.BeamLog) -> underbrush.BeamLog:
    """A copy of the log with its beams spread over three minutes, some before zero, and with further columns."""
    out = log.copy()
    out.time_s[:] = np.linspace(-30, 100, len(out))
    out.add_column("class", np.uint8)[:] = np.arange(len(out)) % 7
    out.add_column("noise", np.float64)[:] = np.linspace(0, 1, len(out))
    return out


def same(one: underbrush.BeamLog, other: underbrush.BeamLog) -> bool:
    """Whether two logs have the same columns to the bit."""
    columns = all(getattr(one, name).tobytes() == getattr(other, name).tobytes() for name in COLUMNS)
    return columns and {k: v.tobytes() for k, v in one.extra.items()} == {k: v.tobytes() for k, v in other.extra.items()}


def test_a_table_shares_the_memory_of_its_log(log: underbrush.BeamLog) -> None:
    rich = three_minutes(log)
    for table in (pa.table(rich), pa.Table.from_batches([pa.record_batch(rich)])):
        assert table.column_names == [*COLUMNS, "class", "noise"] and table.schema.equals(pa.schema(rich))
        for name in table.column_names:
            of_log = rich.extra[name] if name in rich.extra else getattr(rich, name)
            values = table.column(name).chunk(0)
            buffer = (values.flatten() if name in ("origin", "direction") else values).buffers()[1]
            assert buffer.address == of_log.ctypes.data, name
            assert numbers(table.column(name)).tobytes() == of_log.tobytes(), name
        rich.range_m[3] = 12.5
        assert table.column("range_m")[3].as_py() == 12.5


def test_a_table_outlives_its_log(log_file: pathlib.Path) -> None:
    one = underbrush.read_log(log_file)
    kept = {name: getattr(one, name).tobytes() for name in COLUMNS}
    table, capsule = pa.table(one), one.__arrow_c_stream__()
    ranges = table.column("range_m")
    del one, capsule
    gc.collect()
    waste = [underbrush.BeamLog(100_000) for _ in range(4)]  # takes over memory that was freed
    assert {name: numbers(table.column(name)).tobytes() for name in COLUMNS} == kept
    del table, waste
    gc.collect()
    assert numbers(ranges).tobytes() == kept["range_m"]


def test_tables_release_their_log() -> None:
    before = pa.total_allocated_bytes()
    resident = [0, 0]
    for k in range(40):
        big = underbrush.BeamLog(1_000_000)  # 71 MB
        big.origin[:] = 1
        table = pa.table(big)
        pa.record_batch(big)
        big.__arrow_c_array__()
        del big, table
        resident[k >= 20] = max(resident[k >= 20], int(pathlib.Path("/proc/self/statm").read_text().split()[1]) * 4096)
    assert resident[1] < resident[0] + 50_000_000 and pa.total_allocated_bytes() == before


def test_a_reader_is_a_stream_of_its_chunks(log: underbrush.BeamLog, log_file: pathlib.Path, tmp_path: pathlib.Path) -> None:
    stream = pa.RecordBatchReader.from_stream(underbrush.LogReader(log_file, chunk_size=1000))
    first = stream.read_next_batch()
    assert len(first) == 1000
    table = pa.Table.from_batches([first, *stream])
    assert same(underbrush.log_from_arrow(table), underbrush.read_log(log_file))
    cut = tmp_path / "cut.ublog"
    underbrush.write_log(cut, log)
    data = bytearray(cut.read_bytes())
    data[len(data) // 2] ^= 1
    cut.write_bytes(data)
    with pytest.raises((OSError, underbrush.FormatError), match="cut.ublog"):
        pa.table(underbrush.LogReader(cut))


def test_logs_come_back_from_tables(log: underbrush.BeamLog) -> None:
    rich = three_minutes(log)
    rich.info.classes, rich.info.element_classes = "goose", ["rock"]
    table = pa.table(rich)
    for given in (rich, table, pa.concat_tables([table.slice(0, 100), table.slice(100)])):
        back = underbrush.log_from_arrow(given)
        assert same(back, rich) and not np.shares_memory(back.range_m, rich.range_m)
        for fact in ("sensor", "sensor_file", "min_range_m", "max_range_m", "has_misses", "classes", "element_classes",
                     "deskewed"):
            assert getattr(back.info, fact) == getattr(rich.info, fact), fact
    assert len(underbrush.log_from_arrow(underbrush.BeamLog(0))) == 0
    with pytest.raises(ValueError, match="no column range_m"):
        underbrush.log_from_arrow(table.drop_columns(["range_m"]))
    nulls = pa.array([None] * len(rich), pa.float32())
    with pytest.raises(ValueError, match="range_m has nulls"):
        underbrush.log_from_arrow(table.set_column(2, "range_m", nulls))


def test_a_model_is_a_table_of_its_elements(model: underbrush.Model) -> None:
    table = pa.table(model)
    triangles = len(model.ground) + len(model.surface)
    assert table.num_rows == len(model) and triangles > 0 and len(model.ellipsoids) > 0
    assert (numbers(table.column("kind")) == np.repeat([0, 1, 2], [len(model.ground), len(model.surface),
                                                                    len(model.ellipsoids)])).all()
    covariance = table.column("covariance").combine_chunks()
    assert covariance.null_count == triangles and not covariance.is_valid()[triangles - 1].as_py()
    assert np.array_equal(covariance[triangles:].flatten().to_numpy().reshape(-1, 6), model.ellipsoids.covariance)
    centre = numbers(table.column("centre")).reshape(-1, 3)
    assert np.array_equal(centre[triangles:], model.origin + model.ellipsoids.mean.astype(float))
    corners = model.ground.vertices.astype(float)[model.ground.triangles]
    assert np.allclose(centre[:len(model.ground)], model.origin + corners.mean(axis=1), atol=1e-9)
    for name in ("hit_probability", "hits", "misses"):
        parts = [getattr(part, name) for part in (model.ground, model.surface, model.ellipsoids)]
        assert np.array_equal(numbers(table.column(name)), np.concatenate(parts)), name
    assert np.array_equal(numbers(table.column("label"))[triangles:], model.ellipsoids.label)
    named = duckdb.from_arrow(pa.table(model)).aggregate("kind, count(*) as n").order("kind").fetchall()
    assert dict(named).get(2) == len(model.ellipsoids)


def test_parquet_folders(log: underbrush.BeamLog, tmp_path: pathlib.Path) -> None:
    rich = three_minutes(log)
    underbrush.write_log(tmp_path / "log.ublog", rich)
    underbrush.write_parquet(tmp_path / "memory", rich)
    underbrush.write_parquet(tmp_path / "file", tmp_path / "log.ublog")
    for name in ("memory", "file"):
        folder = tmp_path / name
        assert {path.name for path in folder.iterdir()} == {"minute=-1", "minute=0", "minute=1"}
        rows = duckdb.sql(f"select * exclude (minute) from read_parquet('{folder}/*/*.parquet', hive_partitioning=true) "
                          "order by time_s").to_arrow_table()
        back = underbrush.log_from_arrow(rows)
        assert same(back, rich if name == "memory" else underbrush.read_log(tmp_path / "log.ublog"))
    hits = duckdb.sql(f"select minute, count(*) from read_parquet('{tmp_path}/memory/*/*.parquet', hive_partitioning=true)"
                      " where range_m < 'infinity' group by minute order by minute").fetchall()
    minute = np.floor(rich.time_s / 60).astype(int)
    assert hits == [(m, int((np.isfinite(rich.range_m) & (minute == m)).sum())) for m in (-1, 0, 1)]
    underbrush.write_parquet(tmp_path / "scans", rich, partition="scan")
    assert len(list((tmp_path / "scans").iterdir())) == len(np.unique(rich.scan))


def test_polars_pandas_and_duckdb_read_a_log(log: underbrush.BeamLog) -> None:
    polars = pytest.importorskip("polars", reason="polars is not installed")
    pandas = pytest.importorskip("pandas", reason="pandas is not installed")
    rich = three_minutes(log)
    frames = {"polars": polars.DataFrame(rich), "polars, as structs": polars.from_arrow(rich).struct.unnest(),
              "pandas": pa.table(rich).to_pandas()}
    if hasattr(pandas.DataFrame, "from_arrow"):  # Since version 3.
        frames["pandas, by capsule"] = pandas.DataFrame.from_arrow(rich)
    for name, frame in frames.items():
        assert list(frame.columns) == [*COLUMNS, "class", "noise"], name
        for column in frame.columns:
            of_log = rich.extra[column] if column in rich.extra else getattr(rich, column)
            values = np.stack(frame[column].to_numpy()) if of_log.ndim == 2 else frame[column].to_numpy()
            assert values.dtype == of_log.dtype and values.tobytes() == of_log.tobytes(), (name, column)
    counted = duckdb.sql("select class, count(*), sum(ring) from rich group by class order by class").fetchall()
    classes = [rich.extra["class"] == k for k in range(7)]
    assert counted == [(k, int(of.sum()), int(rich.ring[of].sum())) for k, of in enumerate(classes)]


def test_dask_reads_a_folder(log: underbrush.BeamLog, tmp_path: pathlib.Path) -> None:
    frames = pytest.importorskip("dask.dataframe", reason="dask's data frames are not installed")
    rich = three_minutes(log)
    underbrush.write_parquet(tmp_path / "folder", rich)
    frame = frames.read_parquet(tmp_path / "folder")
    assert frame.npartitions >= 3 and len(frame) == len(rich)
    hits = frame[np.isfinite(frame.range_m)].groupby("ring").range_m.agg(["count", "max"]).compute().sort_index()
    rings = [(rich.ring == ring) & np.isfinite(rich.range_m) for ring in hits.index]
    assert list(hits["count"]) == [int(of.sum()) for of in rings] and hits["count"].sum() == np.isfinite(rich.range_m).sum()
    assert list(hits["max"]) == [rich.range_m[of].max() for of in rings]


def test_geoparquet(log: underbrush.BeamLog, tmp_path: pathlib.Path) -> None:
    geopandas = pytest.importorskip("geopandas", reason="geopandas is not installed")
    rich = three_minutes(log)
    hit = np.isfinite(rich.range_m)
    assert hit.any() and not hit.all()
    for partition in ("minute", "scan"):
        folder = tmp_path / partition
        underbrush.write_parquet(folder, rich, partition=partition, geometry=True)  # type: ignore[arg-type]
        back = geopandas.read_parquet(folder)
        assert back.crs is None and list(back.columns)[-1] in ("geometry", partition)
        back = back.sort_values("time_s", kind="stable")
        order = np.argsort(rich.time_s, kind="stable")
        assert (back.geometry.notna().to_numpy() == hit[order]).all()
        ends = (rich.origin + rich.direction.astype(np.float64) * rich.range_m[:, None])[order][hit[order]]
        found = back.geometry[back.geometry.notna()]
        np.testing.assert_array_equal(np.stack([found.x, found.y, found.z], axis=1), ends)
        assert back.total_bounds == pytest.approx([*ends.min(axis=0)[:2], *ends.max(axis=0)[:2]])
    rows = pa.dataset.dataset(tmp_path / "scan", partitioning="hive").to_table()  # The scans are signed numbers there.
    assert same(underbrush.log_from_arrow(rows.sort_by("time_s")), rich)
    for name, options in (("geometry", {"geometry": True}), ("minute", {})):
        own = three_minutes(log)
        own.add_column(name, np.uint8)[:] = 3
        assert underbrush.log_from_arrow(pa.table(own)).extra[name][0] == 3
        with pytest.raises(ValueError, match=f"the log has a column {name} already"):
            underbrush.write_parquet(tmp_path / "twice", own, **options)  # type: ignore[arg-type]
        assert not (tmp_path / "twice").exists()
    for scan in (-1, 1 << 32):
        beyond = rows.set_column(rows.column_names.index("scan"), "scan", pa.array([scan] * len(rows)))
        with pytest.raises(ValueError, match="the column scan has numbers beyond 0 to 4294967295"):
            underbrush.log_from_arrow(beyond)


def test_parquet_refuses(log: underbrush.BeamLog, tmp_path: pathlib.Path) -> None:
    (tmp_path / "there").mkdir()
    with pytest.raises(FileExistsError):
        underbrush.write_parquet(tmp_path / "there", log)
    with pytest.raises(ValueError, match="hour"):
        underbrush.write_parquet(tmp_path / "new", log, partition="hour")  # type: ignore[arg-type]
    cut = tmp_path / "cut.ublog"
    underbrush.write_log(cut, log)
    data = bytearray(cut.read_bytes())
    data[len(data) // 2] ^= 1
    cut.write_bytes(data)
    with pytest.raises((OSError, underbrush.FormatError)):
        underbrush.write_parquet(tmp_path / "new", cut)
    assert not [path for path in tmp_path.iterdir() if path.name.startswith((".underbrush", "new"))]
