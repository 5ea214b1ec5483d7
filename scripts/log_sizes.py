#!/usr/bin/env python3
"""Bytes a beam and processor seconds of the formats of logs, as a Markdown table.

    PYTHONPATH=build/python/package scripts/log_sizes.py LOG...

Each log is written and read again as a ray cloud, a compact log, LAZ (laspy), MCAP with zstd (rosbags) and Parquet with
zstd (pyarrow); a format whose library is not installed has a dash. LAZ holds the returns alone, in whole millimetres,
and MCAP the points as a sensor's driver publishes them; the others hold every bit. Reading is that of the format's own library.
"""
import pathlib
import sys
import tempfile
import time
import typing

import numpy as np

import underbrush
from underbrush.formats.log import columns_of, export_log

underbrush.set_threads(1)


def read_laz(path: pathlib.Path) -> None:
    import laspy
    np.asarray(laspy.read(path).x)


def read_mcap(path: pathlib.Path) -> None:
    from rosbags.highlevel import AnyReader
    with AnyReader([path]) as reader:
        for connection, _, raw in reader.messages():
            reader.deserialize(raw, connection.msgtype)


def flat(log: typing.Any) -> dict[str, typing.Any]:
    """Columns of one number a row."""
    out: dict[str, typing.Any] = {}
    for name, column in columns_of(log).items():
        parts = column.T if column.ndim == 2 else [column]
        out.update({name + "xyz"[k] * (column.ndim - 1): np.ascontiguousarray(part) for k, part in enumerate(parts)})
    return out


def write_parquet(log: typing.Any, path: pathlib.Path) -> None:
    import pyarrow
    import pyarrow.parquet
    pyarrow.parquet.write_table(pyarrow.table(flat(log)), path, compression="zstd")


def read_parquet(path: pathlib.Path) -> None:
    import pyarrow.parquet
    pyarrow.parquet.read_table(path, use_threads=False)


FORMATS: dict[str, tuple[typing.Any, typing.Any]] = {
    "ply": (lambda log, path: underbrush.write_log(path, log), underbrush.read_log),
    "ublog": (lambda log, path: underbrush.write_log(path, log), underbrush.read_log),
    "laz": (lambda log, path: export_log(log, path), read_laz),
    "mcap": (lambda log, path: export_log(log, path, compress=True), read_mcap),
    "parquet": (write_parquet, read_parquet),
}


def seconds_of(call: typing.Callable[[], object]) -> float:
    start = time.process_time()
    call()
    return time.process_time() - start


def cell(log: typing.Any, name: str, folder: pathlib.Path) -> str:
    path = folder / ("log." + name)
    write, read = FORMATS[name]
    try:
        written, taken = seconds_of(lambda: write(log, path)), seconds_of(lambda: read(path))
    except ImportError:
        return "–"
    return f"{path.stat().st_size / len(log):.2f} B, {written:.2f} s, {taken:.2f} s"


def main() -> None:
    print("| log | beams | " + " | ".join(f"`.{name}`" for name in FORMATS) + " |")
    print("|---" * (2 + len(FORMATS)) + "|")
    for file in map(pathlib.Path, sys.argv[1:]):
        log = underbrush.read_log(file)
        with tempfile.TemporaryDirectory() as folder:
            cells = [cell(log, name, pathlib.Path(folder)) for name in FORMATS]
        print(f"| {file} | {len(log)} | " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()
