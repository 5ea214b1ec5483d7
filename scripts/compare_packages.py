#!/usr/bin/env python3
"""Compares this package with others for Python people who work on lidar and geometry, point by point.

    scripts/compare_packages.py --wheel build/wheel/underbrush-*.whl --work build/compare

installs each into an environment of its own under the work folder (over the network, about 1.5 GB), probes it there and
prints the table of docs/explanation/python-packages.md. `--only NAME` probes one of them.

What is probed:
  install    seconds of `pip install` with what the package needs, MB on disk, number of packages, wheel, import
  stubs      whether types are there, and the errors of `mypy --strict` in three lines that use the package
  arrays     whether an array that is read twice has one address, and whether an array that is given is used in place
  GIL        how fast another thread counts during a call of about a second, against its speed alone
  errors     what a damaged file raises, and whether its text names the file
  docs       share of public classes, functions, methods and properties with a docstring beyond a signature
"""
from __future__ import annotations

import argparse
import importlib
import inspect
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import threading
import time
import venv
from collections.abc import Callable, Iterator
from typing import Any

NAMES = ("underbrush", "small_gicp", "kiss-icp", "manifold3d", "open3d")
#: Three lines that use each package, for the type checker.
PROGRAMS = {
    "underbrush": "import underbrush\nlog = underbrush.read_log('a.ply')\nprint(underbrush.fit(log).ellipsoids.mean)\n",
    "small_gicp": "import small_gicp\ncloud = small_gicp.read_ply('a.ply')\nprint(cloud.points())\n",
    "kiss-icp": "import numpy as np\nfrom kiss_icp.voxelization import voxel_down_sample\n"
                "print(voxel_down_sample(np.zeros((9, 3)), 1.0))\n",
    "manifold3d": "import manifold3d\nsolid = manifold3d.Manifold.sphere(1.0, 32)\n"
                  "print(solid.to_mesh().vert_properties)\n",
    "open3d": "import open3d\ncloud = open3d.io.read_point_cloud('a.ply')\nprint(cloud.points)\n",
}


# --- Probes; they run in the environment of the package ---


def same_memory(one: Any, other: Any) -> bool:
    """Whether two arrays that are both alive begin at one address."""
    return bool(one.__array_interface__["data"][0] == other.__array_interface__["data"][0])


def counting(call: Callable[[], object]) -> float:
    """Speed at which this thread counts during a call in another one, relative to its speed alone."""
    def speed(until: Callable[[], bool]) -> float:
        start, n = time.perf_counter(), 0
        while until():
            n += 1
        return n / (time.perf_counter() - start)

    end = time.perf_counter() + 0.5
    alone = speed(lambda: time.perf_counter() < end)
    other = threading.Thread(target=call)
    other.start()
    return speed(lambda: (time.perf_counter(), other.is_alive())[1]) / alone


def outcome(call: Callable[[], object], file: str) -> str:
    """What a call with a damaged file ends in."""
    try:
        made = call()
    except (Exception, SystemExit) as error:  # what it is, is the question
        names = "names the file" if pathlib.Path(file).name in str(error) else "does not name the file"
        return f"`{type(error).__name__}`, {names}"
    points = made[0] if isinstance(made, tuple) else made
    return f"no error, a {type(points).__name__} of {size_of_cloud(points)} points"


def size_of_cloud(cloud: Any) -> int:
    """The number of points of a cloud of any of these packages."""
    return len(cloud.points) if hasattr(cloud, "points") and not callable(cloud.points) else \
        cloud.size() if callable(getattr(cloud, "size", None)) else len(cloud)


def public(module: Any, prefix: str) -> Iterator[tuple[str, Any]]:
    """The public classes and functions of a module and its submodules, and the public members of its classes."""
    seen: set[int] = set()
    left = [(module, prefix)]
    while left:
        here, name = left.pop()
        if id(here) in seen:
            continue
        seen.add(id(here))
        members = {key: value for key, value in vars(here).items() if not key.startswith("_")}
        for key, value in members.items():
            owner = getattr(value, "__module__", "") or ""
            if inspect.ismodule(value):
                if value.__name__.startswith(prefix):
                    left.append((value, f"{name}.{key}"))
            elif inspect.isclass(value) and owner.startswith(prefix) and id(value) not in seen:
                seen.add(id(value))
                yield f"{name}.{key}", value
                for inner, member in vars(value).items():
                    if not inner.startswith("_") and (callable(member) or hasattr(member, "__get__")):
                        yield f"{name}.{key}.{inner}", member
            elif callable(value) and (owner.startswith(prefix) or not owner) and id(value) not in seen:
                seen.add(id(value))
                yield f"{name}.{key}", value


def is_documented(thing: Any) -> bool:
    """Whether a docstring says more than a signature."""
    text = inspect.getdoc(thing.__func__ if isinstance(thing, (staticmethod, classmethod)) else thing) or ""
    if inspect.isclass(thing) and "__doc__" in vars(thing):
        text = vars(thing)["__doc__"]
    if not isinstance(text, str):
        return False
    said = [line for line in text.splitlines() if not re.match(r"\s*(\d+\. )?[\w.]+\(.*\)( -> .*)?$|Overloaded", line)]
    return len(re.findall(r"[A-Za-z]", " ".join(said))) >= 10


def docs_of(module: str) -> str:
    """Share of the public names with a docstring."""
    names = dict(public(importlib.import_module(module), module))
    return f"{sum(map(is_documented, names.values())) / max(len(names), 1):.0%} of {len(names)}"


def probe_underbrush(file: str) -> dict[str, Any]:
    """This package: a log's column, a fit, a cut ray cloud."""
    import numpy as np
    import underbrush
    n = 200_000
    log = underbrush.BeamLog(n)
    generator = np.random.default_rng(1)
    log.direction[:] = generator.normal(size=(n, 3))
    log.direction[:] /= np.linalg.norm(log.direction, axis=1, keepdims=True)
    log.range_m[:] = generator.uniform(1, 30, n)
    underbrush.set_threads(1)
    return {"out": same_memory(log.range_m, log.range_m), "in": False,
            "gil": counting(lambda: underbrush.fit(log)), "errors": outcome(lambda: underbrush.read_log(file), file),
            "docs": docs_of("underbrush")}


def probe_small_gicp(file: str) -> dict[str, Any]:
    """small_gicp: a cloud's points, its preprocessing, a cut PLY file."""
    import numpy as np
    import small_gicp
    points = np.random.default_rng(1).uniform(0, 100, (300_000, 4))
    points[:, 3] = 1
    cloud = small_gicp.PointCloud(points)
    return {"out": same_memory(cloud.points(), cloud.points()), "in": same_memory(cloud.points(), points),
            "gil": counting(lambda: small_gicp.preprocess_points(cloud, 0.01)),
            "errors": outcome(lambda: small_gicp.read_ply(file), file), "docs": docs_of("small_gicp")}


def probe_kiss_icp(file: str) -> dict[str, Any]:
    """kiss-icp: the points of its map, its registration, a cut KITTI scan in a folder of its own."""
    import numpy as np
    from kiss_icp.config import KISSConfig
    from kiss_icp.datasets import dataset_factory
    from kiss_icp.kiss_icp import KissICP
    config = KISSConfig()
    config.data.max_range, config.mapping.voxel_size = 100.0, 0.5
    odometry = KissICP(config)
    points = np.random.default_rng(1).uniform(-50, 50, (400_000, 3))
    grid = odometry.local_map
    grid.add_points(points)

    def frames() -> None:
        for _ in range(4):
            odometry.register_frame(points, np.zeros(0))

    for module in ("kiss_icp.kiss_icp", "kiss_icp.mapping", "kiss_icp.preprocess", "kiss_icp.registration",
                   "kiss_icp.voxelization", "kiss_icp.pipeline", "kiss_icp.metrics"):
        importlib.import_module(module)
    scans = pathlib.Path(file).parent / "scans"
    scans.mkdir()
    (scans / "damaged.bin").write_bytes(bytes(1001))
    return {"out": same_memory(grid.point_cloud(), grid.point_cloud()), "in": False, "gil": counting(frames),
            "errors": outcome(lambda: dataset_factory("generic", data_dir=scans)[0], "damaged.bin"),
            "docs": docs_of("kiss_icp")}


def probe_manifold3d(file: str) -> dict[str, Any]:
    """manifold3d: a mesh's vertices, a union of spheres, a mesh that is no solid (it reads no files)."""
    import manifold3d
    import numpy as np
    mesh = manifold3d.Manifold.sphere(1.0, 64).to_mesh()
    given, triangles = np.array(mesh.vert_properties, np.float32), np.array(mesh.tri_verts, np.uint32)
    made = manifold3d.Mesh(vert_properties=given, tri_verts=triangles)
    balls = [manifold3d.Manifold.sphere(1.0, 1500).translate((0.3 * k, 0.1 * k, 0)) for k in range(4)]

    def union() -> None:
        (balls[0] + balls[1] + balls[2] + balls[3]).num_tri()

    open_mesh = manifold3d.Mesh(vert_properties=given, tri_verts=triangles[1:].copy())
    return {"out": same_memory(made.vert_properties, made.vert_properties),
            "in": same_memory(made.vert_properties, given), "gil": counting(union),
            "errors": f"reads no files; an open mesh: {manifold3d.Manifold(open_mesh).status()}",
            "docs": docs_of("manifold3d")}


def probe_open3d(file: str) -> dict[str, Any]:
    """open3d: a cloud's points, its normals, a cut PLY file."""
    import numpy as np
    import open3d
    points = np.random.default_rng(1).uniform(0, 100, (400_000, 3))
    cloud = open3d.geometry.PointCloud(open3d.utility.Vector3dVector(points))
    tensor = open3d.core.Tensor.from_numpy(points)
    return {"out": same_memory(np.asarray(cloud.points), np.asarray(cloud.points)),
            "in": same_memory(tensor.numpy(), points), "gil": counting(lambda: cloud.estimate_normals()),
            "errors": outcome(lambda: open3d.io.read_point_cloud(file), file), "docs": docs_of("open3d")}


def probe(name: str) -> None:
    """Runs the probe of a package on a damaged file and prints its findings."""
    with tempfile.TemporaryDirectory() as folder:
        file = os.path.join(folder, "damaged.ply")
        header = "ply\nformat binary_little_endian 1.0\nelement vertex 1000\n" + "".join(
            f"property float {axis}\n" for axis in "xyz") + "end_header\n"
        pathlib.Path(file).write_bytes(header.encode() + bytes(100))
        print("\n" + json.dumps(globals()["probe_" + name.replace("-", "_")](file)))


# --- The table ---


def size_of(folder: pathlib.Path) -> float:
    """MB of files in an environment's packages, without pip and setuptools."""
    own = ("pip", "setuptools", "_distutils_hack", "pkg_resources", "mypy", "ast_serialize", "librt")
    return sum(path.stat().st_size for path in folder.rglob("*") if path.is_file() and "__pycache__" not in path.parts
               and not path.relative_to(folder).parts[0].startswith(own)) / 1e6


def installed(name: str, source: str, work: pathlib.Path) -> tuple[pathlib.Path, dict[str, Any]]:
    """Makes the environment of a package; returns its Python, and what the installation took."""
    folder = work / name
    venv.create(folder, with_pip=True, clear=True)
    python = folder / "bin" / "python"
    pip = [str(python), "-m", "pip", "install", "-q", "--disable-pip-version-check"]
    start = time.monotonic()
    subprocess.run([*pip, source], check=True)
    took = time.monotonic() - start
    packages = next((folder / "lib").glob("python*/site-packages"))
    facts = {"seconds": took, "mb": size_of(packages),
             "packages": len([p for p in packages.glob("*.dist-info") if not p.name.startswith(("pip", "setuptools"))])}
    found = next(packages.glob(f"{name.replace('-', '_')}-*.dist-info"))
    facts["version"] = found.name.split("-")[1].removesuffix(".dist")
    facts["tag"] = re.findall(r"^Tag: (.*)$", (found / "WHEEL").read_text(encoding="utf-8"), re.M)[-1]
    facts["stubs"] = any(re.match(rf"{name.replace('-', '_')}(/|\.pyi|-stubs)", line) and
                         re.match(r"[^,]*(\.pyi|py\.typed),", line)
                         for line in (found / "RECORD").read_text(encoding="utf-8").splitlines())
    subprocess.run([*pip, "mypy"], check=True)
    return python, facts


def row_of(name: str, source: str, work: pathlib.Path) -> list[str]:
    """The cells of a package's column."""
    python, facts = installed(name, source, work)
    program = work / "program.py"
    program.write_text(PROGRAMS[name], encoding="utf-8")
    checked = subprocess.run([python, "-m", "mypy", "--strict", "--cache-dir", "/dev/null", program], check=False,
                             capture_output=True, text=True).stdout.strip().splitlines()
    module = name.replace("-", "_")
    alone = subprocess.run([python, "-c", f"import {module}"], check=False, capture_output=True, text=True)
    note = ""
    if alone.returncode:  # a package that does not declare what it needs
        note = f", after `{alone.stderr.strip().splitlines()[-1]}`"
        subprocess.run([python, "-m", "pip", "install", "-q", "numpy"], check=True)
    times = []
    for _ in range(4):
        start = time.monotonic()
        subprocess.run([python, "-c", f"import {module}"], check=True, capture_output=True)
        times.append(time.monotonic() - start)
    lines = subprocess.run([python, __file__, "--probe", name], check=True, capture_output=True, text=True).stdout
    found = json.loads(lines.strip().splitlines()[-1])
    errors = 0 if "Success" in checked[-1] else int(re.findall(r"Found (\d+) error", checked[-1])[0])
    return [facts["version"], f"{facts['mb']:.0f} MB, {facts['packages']} packages, {facts['seconds']:.0f} s",
            facts["tag"], f"{min(times):.2f} s{note}", ("yes" if facts["stubs"] else "no") + f", {errors} errors",
            f"{'in place' if found['out'] else 'a copy'}, {'in place' if found['in'] else 'a copy'}",
            f"{'released' if found['gil'] > 0.1 else 'held'} ({found['gil']:.0%})", found["errors"], found["docs"]]


def main() -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--wheel", help="this package's wheel")
    parser.add_argument("--work", type=pathlib.Path, help="folder for the environments")
    parser.add_argument("--only", action="append", choices=NAMES, help="probe this one; may be repeated")
    parser.add_argument("--probe", choices=NAMES, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.probe:
        probe(options.probe)
        return
    if not options.work:
        parser.error("--work is needed")
    options.work.mkdir(parents=True, exist_ok=True)
    names = options.only or list(NAMES)
    if "underbrush" in names and not options.wheel:
        parser.error("--wheel is needed for underbrush")
    columns = [row_of(name, options.wheel if name == "underbrush" else name, options.work) for name in names]
    heads = ("version", "installed", "wheel", "import", "types, mypy --strict", "array read, array given", "GIL",
             "a damaged file", "docstrings")
    print("| | " + " | ".join(names) + " |\n|---" * 1 + "|---" * len(names) + "|")
    for head, cells in zip(heads, zip(*columns, strict=True), strict=True):
        print(f"| {head} | " + " | ".join(cells) + " |")


if __name__ == "__main__":
    sys.exit(main())
