"""Logs from Arrow's tables, and as folders of Parquet files (`pip install 'underbrush[arrow]'`).

The way into Arrow needs no function: `pyarrow.table(log)`, `polars.DataFrame(log)` and `duckdb.sql("from log")` take a
`BeamLog`, a `Model` or a `LogReader` as it is.
"""
from __future__ import annotations

import json
import os
from collections.abc import Callable
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from underbrush._core import BeamLog, LogInfo, LogReader
from underbrush.files import PathLike, need, written_whole
from underbrush.logs import log_from_columns

_NEEDED = ("origin", "direction", "range_m")
_GEOMETRY = "geometry"
#: Of GeoParquet 1.1. The log's frame is the user's, so that it has no coordinate reference system.
_GEO = {"version": "1.1.0", "primary_column": _GEOMETRY,
        "columns": {_GEOMETRY: {"encoding": "WKB", "geometry_types": ["Point Z"], "crs": None}}}
_NAMED = (*_NEEDED, "intensity", "time_s", "ring", "scan", "packet", "flags")


def log_from_arrow(table: Any) -> BeamLog:
    """Makes a log from a table of Arrow, or a value that pyarrow reads as one; its rows are copied.

    The columns have the names, shapes and units of `log_from_columns`, where those with several numbers a row are lists.
    Other columns become further columns of the log, except the points of GeoParquet (a binary column `geometry`). The
    facts about the log come from the schema, where `pyarrow.table` and `write_parquet` put them; the poses of its scans
    are not among them.

    Raises `ValueError` for a column that is missing or has nulls, and what `log_from_columns` raises.
    """
    found = need("pyarrow", "arrow").table(table)
    for name in _NEEDED:
        if name not in found.column_names:
            raise ValueError(f"log: the table has no column {name}")
    columns = {name: _values(found.column(name), name) for name in found.column_names
               if name != _GEOMETRY or str(found.column(name).type) not in ("binary", "large_binary")}
    facts = (found.schema.metadata or {}).get(b"underbrush")
    named: dict[str, Any] = {name: columns.pop(name) for name in _NAMED if name in columns}
    return log_from_columns(**named, extra=columns, info=None if facts is None else _info(facts))


def _values(column: Any, name: str) -> npt.NDArray[Any]:
    if column.null_count:
        raise ValueError(f"log: the column {name} has nulls")
    values = column.combine_chunks()
    if not hasattr(values, "flatten") or not hasattr(values.type, "value_type"):
        return np.asarray(values.to_numpy(zero_copy_only=False))
    numbers = values.flatten().to_numpy(zero_copy_only=False)
    return np.asarray(numbers.reshape(len(values), -1) if len(values) else numbers.reshape(0, 3))


def _info(facts: bytes) -> LogInfo:
    info = LogInfo()
    for name, value in json.loads(facts).items():
        setattr(info, name, value)
    return info


def write_parquet(folder: PathLike, log: BeamLog | PathLike, *, partition: Literal["minute", "scan"] = "minute",
                  geometry: bool = False) -> None:
    """Writes a log as a folder of Parquet files, which Dask, DuckDB, Spark and pandas read as one table.

    There is a folder `minute=N` for each minute of the log's clock (`time_s` from 60 N to 60 (N + 1)), or with
    `partition` "scan" one for each scan, and readers make that name a column. Rows keep their order within a folder. The
    log of a path is read in chunks, so it may be larger than memory. The folder appears whole or not at all.

    With `geometry` the files are GeoParquet, as QGIS and GeoPandas read it: a column `geometry` has the end point of each
    return (m, frame of the log, without a coordinate reference system), and nothing for a miss.

    Raises `FileExistsError` where something stands at `folder`, `ValueError` for another `partition` and for a log that
    has a column of the name `minute` or `geometry` already, `FormatError`, `OSError`.
    """
    if partition not in ("minute", "scan"):
        raise ValueError(f"write_parquet: the partition {partition!r} is neither minute nor scan")
    arrow, dataset = need("pyarrow", "arrow"), need("pyarrow.dataset", "arrow")
    if os.path.lexists(folder):
        raise FileExistsError(17, "exists; remove it or name another", os.fspath(folder))
    chunks = arrow.RecordBatchReader.from_stream(log if isinstance(log, BeamLog) else LogReader(log))
    added: dict[Any, Callable[[Any, Any], Any]] = {}
    if partition == "minute":
        added[arrow.field("minute", arrow.int32())] = _minutes
    if geometry:
        added[arrow.field(_GEOMETRY, arrow.large_binary())] = _points
    for field in added:
        if field.name in chunks.schema.names:
            raise ValueError(f"write_parquet: the log has a column {field.name} already")
    schema = arrow.schema([*chunks.schema, *added],
                          {**(chunks.schema.metadata or {}), **({b"geo": json.dumps(_GEO)} if geometry else {})})
    by = dataset.partitioning(arrow.schema([schema.field(partition)]), flavor="hive")
    rows = arrow.RecordBatchReader.from_batches(schema, (
        arrow.RecordBatch.from_arrays([*chunk.columns, *(make(arrow, chunk) for make in added.values())], schema=schema)
        for chunk in chunks))
    with written_whole(folder) as target:
        target.mkdir()
        dataset.write_dataset(rows, target, format="parquet", partitioning=by, use_threads=False,
                              basename_template="part-{i}.parquet", max_partitions=1 << 20)


def _minutes(arrow: Any, chunk: Any) -> Any:
    return arrow.array(np.floor(chunk.column("time_s").to_numpy() / 60).astype(np.int32))


def _points(arrow: Any, chunk: Any) -> Any:
    """The end points of the returns as well-known binary (ISO), null for a miss."""
    range_m = chunk.column("range_m").to_numpy()
    hit = np.isfinite(range_m)
    origin, direction = (chunk.column(name).flatten().to_numpy().reshape(-1, 3)[hit] for name in ("origin", "direction"))
    points = np.empty(len(origin), [("little_endian", "u1"), ("type", "<u4"), ("place", "<f8", 3)])
    points["little_endian"], points["type"] = 1, 1001  # A point with z.
    points["place"] = origin + direction.astype(np.float64) * range_m[hit, None]
    ends = np.concatenate([[0], np.cumsum(hit)]).astype(np.int64) * points.itemsize
    return arrow.Array.from_buffers(arrow.large_binary(), len(hit), [
        arrow.py_buffer(np.packbits(hit, bitorder="little")), arrow.py_buffer(ends), arrow.py_buffer(points)])
