#!/usr/bin/env python3
"""Makes the GeoTIFF files of this folder with GDAL: `pip install rasterio`, then `make.py`.

The cell of row r and column c has the height 100 + r / 4 + (c % 7) / 8 m, or its whole part; row 3 has no data in
columns 5 and 6. The corner is at (412000, 5646000), cells are 2 m wide.
"""
import pathlib

import numpy as np
import rasterio
from rasterio.transform import from_origin

ROWS, COLUMNS, NOTHING = 37, 53, -9999
KINDS = [("none", 1), ("lzw", 1), ("lzw", 2), ("lzw", 3), ("deflate", 1), ("deflate", 2), ("deflate", 3), ("packbits", 1)]


def main():
    r, c = np.mgrid[:ROWS, :COLUMNS]
    height = 100 + r / 4 + (c % 7) / 8
    height[3, 5:7] = NOTHING
    folder = pathlib.Path(__file__).parent
    for kind, predictor in KINDS:
        for tiled, dtype, big in ((False, "float32", False), (True, "float32", True), (True, "int16", False),
                                  (False, "float64", True)):
            if predictor == 3 and dtype == "int16":
                continue
            name = f"{kind}{predictor}_{'tiles' if tiled else 'strips'}_{dtype}_{'big' if big else 'little'}.tif"
            options = {"tiled": True, "blockxsize": 16, "blockysize": 32} if tiled else {"blockysize": 8}
            if kind in ("lzw", "deflate"):
                options["predictor"] = predictor
            with rasterio.open(folder / name, "w", driver="GTiff", width=COLUMNS, height=ROWS, count=1, dtype=dtype,
                               nodata=NOTHING, transform=from_origin(412000, 5646000, 2, 2), compress=kind,
                               endianness="BIG" if big else "LITTLE", **options) as out:
                out.write(np.floor(height).astype(dtype) if dtype == "int16" else height.astype(dtype), 1)
    r, c = np.mgrid[:96, :96]
    with rasterio.open(folder / "lzw_long.tif", "w", driver="GTiff", width=96, height=96, count=1, dtype="int16",
                       transform=from_origin(0, 96, 1, 1), compress="lzw", blockysize=96) as out:
        out.write(((r * 7919 + c * 104729) % 65521 - 32760).astype(np.int16), 1)  # Fills the table of codes.
    with rasterio.open(folder / "zstd.tif", "w", driver="GTiff", width=2, height=2, count=1, dtype="float32",
                       transform=from_origin(0, 2, 1, 1), compress="zstd") as out:
        out.write(np.zeros((2, 2), np.float32), 1)


if __name__ == "__main__":
    main()
