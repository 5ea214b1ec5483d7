#!/usr/bin/env python3
"""What the leaf inclinations of a single labelled scan depend on: its points by range, height, sector, with rings
or points of a ring left out, with more noise. DATA has kitti00_labelled and rellis_000104."""
import argparse
import json
import pathlib
import subprocess
import tempfile

import numpy

SCANS = {  # file, label file, numbers of vegetation, columns of 64 rings first?
    "kitti00_labelled (HDL-64E)": ("kitti00_labelled/kitti00_000000.bin", "kitti00_labelled/kitti00_000000.label",
                                   [70, 71], False),
    "rellis_000104 (OS1-64)": ("rellis_000104/000104.bin", "rellis_000104/000104.label", [4, 19], True),
}


def leaves(program, points):
    table = numpy.zeros(len(points), [(axis, "<f4") for axis in "xyz"])
    for k, axis in enumerate("xyz"):
        table[axis] = points[:, k]
    head = ["ply", "format binary_little_endian 1.0", f"element vertex {len(points)}",
            *(f"property float {axis}" for axis in "xyz"), "end_header"]
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder, "points.ply")
        file.write_bytes(("\n".join(head) + "\n").encode() + table.tobytes())
        done = subprocess.run([program, "info", file, "--leaves", "all", "--json", "-"], check=True,
                              stdout=subprocess.PIPE)
    return json.loads(done.stdout)


def parts(points, vegetation, by_columns):
    """Names and points of the scan's parts and variants."""
    index = numpy.arange(len(points))
    reach = numpy.linalg.norm(points, axis=1)
    azimuth = numpy.degrees(numpy.arctan2(points[:, 1], points[:, 0]))
    ring = index % 64 if by_columns else numpy.cumsum(numpy.diff(azimuth % 360, prepend=0) < -180)
    step = index // 64 if by_columns else index
    elevation = numpy.degrees(numpy.arcsin(points[:, 2] / numpy.maximum(reach, 0.1)))
    chosen = vegetation & (reach > 3) & (reach < 25)
    yield "all", points[chosen]
    for near, far in ((3, 8), (8, 12), (12, 16), (16, 25)):
        yield f"{near} to {far} m", points[chosen & (reach > near) & (reach < far)]
    yield "below +2°", points[chosen & (elevation < 2)]
    for start in range(-180, 180, 45):
        yield f"azimuth {start}° to {start + 45}°", points[chosen & (azimuth >= start) & (azimuth < start + 45)]
    yield "every second ring", points[chosen & (ring % 2 == 0)]
    for n in (2, 4):
        yield f"every {n}th point of a ring", points[chosen & (step % n == 0)]
    random = numpy.random.default_rng(1)
    for sigma in (0.02, 0.05, 0.1):
        longer = 1 + sigma * random.standard_normal(len(points)) / numpy.maximum(reach, 0.1)
        yield f"{100 * sigma:.0f} cm more noise", (points * longer[:, None])[chosen]
    longer = 1 + 0.03 * random.standard_normal(ring.max() + 1)[ring] / numpy.maximum(reach, 0.1)
    yield "lasers off by 3 cm", (points * longer[:, None])[chosen]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("data", type=pathlib.Path)
    parser.add_argument("--program", default="build/bin/underbrush")
    options = parser.parse_args()
    for name, (file, labels, numbers, by_columns) in SCANS.items():
        points = numpy.fromfile(options.data / file, "<f4").reshape(-1, 4)[:, :3].astype(float)
        vegetation = numpy.isin(numpy.fromfile(options.data / labels, "<u4") & 0xFFFF, numbers)
        print(f"\n| {name} | points | μ | σ | ε |\n|---|---:|---:|---:|---:|")
        for part, cloud in parts(points, vegetation, by_columns):
            if len(cloud) < 1000:
                continue
            j = leaves(options.program, cloud)
            print(f"| {part} | {j['points']} | {j['mean_rad']:.3f} | {j['sigma_rad']:.3f} | {j['epsilon']:.3f} |")


if __name__ == "__main__":
    main()
