"""The good files that are mutated: small inputs of every verb, made by the program from a made-up log."""
import base64
import json
import math
import pathlib
import shutil
import struct
import subprocess

SHARE = pathlib.Path(__file__).resolve().parents[2] / "share"
POINTS = [(1.0, 2.0, 3.0, 0.5, 0, 0), (-4.0, 5.0, 0.25, 0.25, 1, 100), (7.0, -8.0, 9.0, 1.0, 2, 200),
          (0.5, 11.0, 12.0, 0.0, 3, 300), (13.0, 14.0, -15.0, 0.75, 4, 400)]  # x y z intensity ring t (ns)
FIELDS = ("x", "y", "z", "intensity", "ring", "t")
TRAJECTORY = "0 0 0 2 0 0 0 1\n0.2 0.5 0 2 0 0 0 1\n"
KITTI_POSES = "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0.5 0 1 0 0 0 0 1 0\n"
DATES = "2011-09-26 13:02:25.900000000\n2011-09-26 13:02:26.000000000\n"
SPINNING = """name: small
title: A small spinning sensor
kind: spinning
rate_hz: 10
firing_period_us: 5000
rotation: counterclockwise
start_azimuth_deg: 180
firings_per_packet: 2
min_range_m: 0.5
max_range_m: 40
range_sigma_m: 0.01
range_resolution_m: 0.002
divergence_mrad: [2, 2]
aperture_mm: 5
profile: gaussian
growth: cone
encoder_step_deg: 0.1
sub_rays: [2, 2]
wavelength_nm: 905
receiver:
  pulse: gaussian
  pulse_ns: 5
  response_ns: 1
  sample_ns: 1
  timing: peak
  threshold_snr: 5
  detects: {range_m: 30, reflectance: 0.1}
  saturation_snr: 4000
  min_gap_m: 0.5
  returns: all
  max_echoes: 2
  intensity: reflectance
  intensity_scale: 100
  intensity_step: 1
  intensity_max: 255
  width_step_m: 0.01
channels:
  elevation_deg: [5, -5, -10, -15]
  azimuth_deg: [0, 1, 0, 1]
  time_us: [0, 1, 2, 3]
  z_mm: [0, 0, 40, 40]
sources:
  - "Made up."
"""
RASTER = """name: raster
kind: raster
shots_per_s: 1000
raster:
  azimuth_deg: [-20, 20]
  elevation_deg: [-20, 5]
  step_deg: [4, 5]
  order: columns
  serpentine: true
min_range_m: 0.5
max_range_m: 40
sub_rays: [1, 2]
divergence_mrad: [1, 1]
profile: table
profile_table: [[0, 1, 0], [1, 2, 1], [0, 1, 0]]
"""
TABLE = """name: table
kind: directions
rate_hz: 10
cycle_s: 0.1
directions: table.csv
firings_per_packet: 5
min_range_m: 0.5
max_range_m: 40
"""
DIRECTIONS = "azimuth_deg,elevation_deg,time_us,ring\n" + "".join(
    f"{18 * k},{-15 + k},{4000 * k},{k % 4}\n" for k in range(24))
PATH = "0 5 3 0 0 0 0 1\n0.2 5.5 3 0 0 0 0 1\n"
SIMULATE = "max-range: 35\ntau: 2\nthreads: 1\nseed: 7\nsuper-sample: 2x2\n" \
           "returns: strongest\nelement-ids: true\nvisibility: 200\nrain: 1\nsun: 0.5\n"
SEGMENT = "min-points: 5\ncell: 0.5\ngap: 0.6\ntile: 32\nspacing: 1.2\nprominence: 0.3\nfoot: 1\nmin-range: 1\n" \
          "ground-method: lower_envelope\ntree-height: 3\npatch-side: 4\n"
FIT = "fitter: hierarchical\ntile: 32\nmin-points: 4\ntau: 2.5\nclusters-per-point: 0.1\nmixture-rounds: 1\n" \
      "ground-method: lower_envelope\nground-spacing: 1\nground-smoothness: 0.05\nrange-noise: 0.02\n" \
      "covariance-prior: 1\nellipsoid-prior-hits: 50\ncredit: first\nellipsoid-prior-misses: 0\nsurface-carve: false\n" \
      "max-residual-for-hit: 0.75\nfree-space-below: 0.05\nmin-range: 0.5\n"
COMPOSE = "nearest: 2\nscale: true\nstrict: false\nclass-density: [large_shrub=0.5, small_tree=2]\nseed: 3\n"

EDITS = """{"format": "underbrush-actor-edits", "version": 1, "actors": "actors", "edits": [
  {"edit": "copy", "actor": "van-1", "as": "second"}, {"edit": "delay", "actor": "second", "by_s": 0.1},
  {"edit": "move", "actor": "second", "translation_m": [0, 4, 0], "yaw_rad": 0.5},
  {"edit": "shift", "actor": "second", "translation_m": [1, 0, 0], "at_s": 0.1, "within_s": 2},
  {"edit": "trajectory", "actor": "van-1", "trajectory": "path.txt"},
  {"edit": "model", "actor": "second", "model": "tree.obj"}]}
"""
PRIMITIVE_EDITS = """{"format": "underbrush-primitive-edits", "version": 1, "edits": [
  {"primitive": "large_shrub/0001", "class": "small_tree", "name": "olive", "comment": "tall"}]}
"""


def beams(scans=2, columns=20, rings=8):
    """Rows of a log: a turning sensor 2 m over flat ground, with posts and without an answer above the horizon."""
    rows = []
    for k in range(scans * columns * rings):
        scan, beam = divmod(k, columns * rings)
        azimuth, ring = 2 * math.pi * (beam // rings) / columns, beam % rings
        slope = 0.3 - 0.05 * ring
        post = beam // rings % 5 == 3
        far = 6.6 if post else 2 / slope if slope > 0.05 else 30
        x, y = far * math.cos(azimuth) + scan, far * math.sin(azimuth)
        rows.append((x, y, 2 - slope * far, 0.1 * scan + 1e-3 * (beam // rings), scan, 0, 2,
                     int(post or slope > 0.05), scan, ring, beam // rings))
    return rows


def csv(rows):
    return "x,y,z,time,ox,oy,oz,hit,scan,ring,packet\n" + "".join(
        ",".join(f"{v:.4f}" if isinstance(v, float) else str(v) for v in row) + "\n" for row in rows)


def ray_cloud(rows):
    """Returns a ray cloud as raycloudtools writes it."""
    kinds = ["double"] * 4 + ["float"] * 3 + ["uchar"] * 4
    names = ["x", "y", "z", "time", "nx", "ny", "nz", "red", "green", "blue", "alpha"]
    head = "ply\nformat binary_little_endian 1.0\ncomment generated by raycloudtools library\n" \
           f"element vertex {len(rows)}\n"
    head += "".join(f"property {k} {n}\n" for k, n in zip(kinds, names)) + "end_header\n"
    return head.encode() + b"".join(
        struct.pack("<4d3f4B", x, y, z, time, ox - x, oy - y, oz - z, 10, 200, 30, 255 * hit)
        for x, y, z, time, ox, oy, oz, hit, *_ in rows)


def packed(points):
    return b"".join(struct.pack("<4fHI", *p) for p in points)


def text(points, separator):
    return "".join(separator.join(str(v) for v in p) + "\n" for p in points).encode()


def point_ply(form):
    body = text(POINTS, " ") if form == "ascii" else \
        b"".join(struct.pack((">" if "big" in form else "<") + "4fHI", *p) for p in POINTS)
    kinds = ("float", "float", "float", "float", "ushort", "uint")
    return (f"ply\nformat {form} 1.0\nelement vertex 5\n" + "".join(
        f"property {k} {f}\n" for k, f in zip(kinds, FIELDS)) + "end_header\n").encode() + body


def pcd(form):
    head = (f"# .PCD v0.7\nVERSION 0.7\nFIELDS {' '.join(FIELDS)}\nSIZE 4 4 4 4 2 4\nTYPE F F F F U U\n"
            f"COUNT 1 1 1 1 1 1\nWIDTH 5\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 5\nDATA {form}\n").encode()
    if form == "ascii":
        return head + text(POINTS, " ")
    if form == "binary":
        return head + packed(POINTS)
    columns = b"".join(struct.pack("<5" + "ffffHI"[c], *(p[c] for p in POINTS)) for c in range(6))
    # LZF of literal runs: the length less 1, and as many bytes.
    runs = b"".join(bytes([len(columns[at:at + 32]) - 1]) + columns[at:at + 32] for at in range(0, len(columns), 32))
    return head + struct.pack("<II", len(runs), len(columns)) + runs


def npy():
    header = "{'descr': [('x', '<f4'), ('y', '<f4'), ('z', '<f4'), ('intensity', '<f4'), ('ring', '<u2'), " \
             "('t', '<u4')], 'fortran_order': False, 'shape': (5,), }\n"
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header.encode() + packed(POINTS)


def npz():
    array, name = npy(), b"cloud.npy"
    fields = struct.pack("<5H3I2H", 20, 0, 0, 0, 33, 0, len(array), len(array), len(name), 0)
    file = b"PK\3\4" + fields + name + array
    directory = b"PK\1\2" + struct.pack("<H", 20) + fields + struct.pack("<3H2I", 0, 0, 0, 0, 0) + name
    return file + directory + b"PK\5\6" + struct.pack("<4H2IH", 0, 0, 1, 1, len(directory), len(file), 0)


def kitti_bin(points):
    return b"".join(struct.pack("<4f", *p[:4]) for p in points)


def labels(n):
    return struct.pack(f"<{n}I", *((i + 7) << 16 | 70 + i % 3 for i in range(n)))


def gltf(buffer):
    """The JSON of a tetrahedron of 48 bytes of corners and 12 of indices; `buffer` has members of its buffer."""
    return {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
            "nodes": [{"children": [1], "translation": [0, 0.1, 0]},
                      {"mesh": 0, "scale": [1, 1, 1], "rotation": [0, 0, 0, 1]}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "mode": 4}]}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 4,
                           "min": [0, 0, 0], "max": [2, 4, 1]},
                          {"bufferView": 1, "componentType": 5123, "type": "SCALAR", "count": 6}],
            "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 48},
                            {"buffer": 0, "byteOffset": 48, "byteLength": 12}],
            "buffers": [{**buffer, "byteLength": 60}]}


def glb(content):
    body = json.dumps(gltf({})).encode()
    body += b" " * (-len(body) % 4)
    return b"glTF" + struct.pack("<II", 2, 28 + len(body) + len(content)) + struct.pack("<I", len(body)) + b"JSON" + \
        body + struct.pack("<I", len(content)) + b"BIN\0" + content


def meshes(put):
    corners, faces = [(0, 0, 0), (2, 0, 0), (0, 0, 1), (0, 4, 0)], [(0, 1, 3), (1, 2, 3)]
    content = b"".join(struct.pack("<3f", *c) for c in corners) + b"".join(struct.pack("<3H", *f) for f in faces)
    put("tree.bin", content)
    put("tree.gltf", json.dumps(gltf({"uri": "tree.bin"}), indent=1))
    inline = "data:application/octet-stream;base64," + base64.b64encode(content).decode()
    put("inline.gltf", json.dumps(gltf({"uri": inline}), indent=1))
    put("tree.glb", glb(content))
    put("tree.obj", "# a tree\nmtllib tree.mtl\no tree\nv 0 0 0\nv 2 0 0 0.5 0.5 0.5\nv 0 1 0\nv 0 0 4\nvn 0 0 1\n"
                    "vt 0 0\ng leaves\nusemtl leaf\ns off\nf 1/1/1 2/1/1 4/1/1\nf 2//1 3//1 -1//1\nf 1 2 3 4\n")
    put("tree.ply", "ply\nformat ascii 1.0\ncomment a tree\nelement vertex 4\nproperty float x\nproperty float y\n"
                    "property float z\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n"
                    "0 0 0\n2 0 0\n0 1 0\n0 0 4\n3 0 1 3\n3 1 2 3\n")
    put("binary.ply", (b"ply\nformat binary_little_endian 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
                       b"property float z\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n")
        + b"".join(struct.pack("<3f", x, z, y) for x, y, z in corners)
        + b"".join(struct.pack("<B3i", 3, *f) for f in faces))


def worlds(put):
    """Worlds in other formats: a mesh with materials, STL, voxels, and a survey of HELIOS++."""
    put("world.obj", "# a world\nmtllib world.mtl\nv 500 0 0\nv 520 0 0\nv 520 20 0.5\nv 500 20 0\nv 510 5 0\n"
                     "v 511 5 0\nv 510.5 5 3\no ground\nusemtl earth\nf 1 2 3 4\no wall\nusemtl paint\n"
                     "f 5/1 6/2 7/3\nl 1 2\n")
    put("world.mtl", "newmtl earth\nKd 0.5 0.5 0.5\nhelios_isGround true\nhelios_reflectance 0.3\nnewmtl paint\n"
                     "helios_classification 6\nhelios_spectra paint\n")
    put("paint.txt", "a line of the header\n" * 26 + "0.5\t20.0\n0.9\t40.0\n1.6\t30.0\n")
    put("pose.txt", "0 510.4 7 1.5 0 0 0 1\n")
    put("rock.stl", b"rock".ljust(80) + struct.pack("<I", 2) + b"".join(
        struct.pack("<12fH", 0, 0, 1, 505 + k, 0, 0, 515, 9, 1, 505, 9, k, 0) for k in range(2)))
    put("text.stl", "solid rock\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
                    "endloop\nendfacet\nendsolid rock\n")
    put("forest.vox", "VOXEL SPACE\n#min_corner: 500 0 0\n#max_corner: 520 20 10\n#split: 2 2 2\n"
                      "#res: 10 #lad_type:Spherical\ni j k PadBVTotal angleMean\n" + "".join(
                          f"{k >> 2} {k >> 1 & 1} {k & 1} {0.01 * k} 45\n" for k in range(8)))
    put("world.xml", """<?xml version="1.0"?>
<document><scene id="s" name="S">
<part id="1"><filter type="objloader"><param type="string" key="filepath" value="world.obj"/></filter></part>
<part><filter type="detailedvoxels"><param type="string" key="filepath" value="forest.vox"/></filter>
<filter type="rotate"><param type="rotation" key="rotation"><rot axis="z" angle_deg="10"/></param></filter>
<filter type="scale"><param type="double" key="scale" value="0.5"/></filter>
<filter type="translate"><param type="vec3" key="offset" value="250;1;2"/>
<param type="integer" key="onGround" value="1"/></filter></part>
</scene></document>
""")
    put("platforms.xml", """<document><platform id="p" name="P" type="linearpath"><scannerMount x="0" y="1" z="2">
<rot axis="x" angle_deg="-90"/></scannerMount></platform></document>
""")
    put("scanners.xml", """<document><scanner id="one" accuracy_m="0.01" beamDivergence_rad="0.001" pulseLength_ns="5"
rangeMin_m="0.5" rangeMax_m="250" scanAngleMax_deg="60" scanAngleEffectiveMax_deg="50" wavelength_nm="905" maxNOR="4"
optics="rotating"><FWFSettings beamSampleQuality="2"/><beamOrigin z="0.2"><rot axis="z" angle_deg="1"/></beamOrigin>
<headRotateAxis x="0" y="0" z="1"/></scanner></document>
""")
    put("flight.trj", "#HEADER: t roll pitch yaw x y z\n0,0,0,10,500,0,20\n1,1,0,10,510,0,20\n2,0,1,10,520,0,20\n")
    put("survey.xml", """<?xml version="1.0"?>
<document>
<scannerSettings id="t" active="true" pulseFreq_hz="1000" scanFreq_hz="10" scanAngle_deg="45"/>
<survey name="v" scene="world.xml#s" platform="platforms.xml#p" scanner="scanners.xml#one">
<leg><platformSettings x="500" y="1" z="20" movePerSec_m="5"/><scannerSettings template="t"/></leg>
<leg><platformSettings x="510" y="1" z="20" onGround="true"/><scannerSettings template="t" active="false"/></leg>
<leg><platformSettings trajectory="flight.trj" tStart="0" tEnd="1.5"/><scannerSettings template="t"/></leg>
</survey></document>
""")


def recordings(put):
    """Files and folders that import reads."""
    rows = beams()
    put("log.csv", csv(rows))
    put("cloud.ply", ray_cloud(rows))
    put("label.csv", "x,y,z,class,instance\n" + "".join(
        f"{x:.4f},{y:.4f},{z:.4f},{71 if at % 7 else 70},{at % 3}\n" for at, (x, y, z, *_) in enumerate(rows)))
    put("cloud.label", labels(len(rows)))
    for name, form in (("ascii", "ascii"), ("little", "binary_little_endian"), ("big", "binary_big_endian")):
        put(f"points-{name}.ply", point_ply(form))
    for name, form in (("ascii", "ascii"), ("binary", "binary"), ("compressed", "binary_compressed")):
        put(f"points-{name}.pcd", pcd(form))
    put("points.npy", npy())
    put("points.npz", npz())
    put("points.csv", b"x,y,z,intensity,ring,t\n" + text(POINTS, ","))
    put("000000.bin", kitti_bin(POINTS))
    put("points.label", labels(len(POINTS)))
    put("poses.txt", TRAJECTORY)
    put("timed.txt", "".join(f"{0.1 * k} {row}\n" for k, row in enumerate(KITTI_POSES.splitlines())))
    put("kitti.txt", KITTI_POSES)
    put("times.txt", "0\n0.1\n")
    for k, name in enumerate(("000000", "000001")):
        scan = kitti_bin((x + k, y, z, i, 0, 0) for x, y, z, i, *_ in POINTS)
        put(f"drive/velodyne/{name}.bin", scan)
        put(f"odometry/velodyne/{name}.bin", scan)
        put(f"odometry/labels/{name}.label", labels(len(POINTS)))
        put(f"raw/velodyne_points/data/0000{name}.bin", scan)
        put(f"raw/oxts/data/0000{name}.txt", f"49.0 {8.4 + 1e-5 * k} 100 0 0 {0.1 * k} 1 2 3\n")
        put(f"folder/{name}.pcd", pcd("binary"))
    put("drive/poses_velo.txt", KITTI_POSES)
    put("drive/times.txt", "0\n0.1\n")
    put("odometry/calib.txt", "P0: 1 2\nTr: 0 -1 0 0 0 0 -1 0 1 0 0 -0.5\n")
    put("odometry/poses.txt", KITTI_POSES)
    put("raw/velodyne_points/timestamps.txt", DATES)
    put("raw/oxts/timestamps.txt", DATES)
    put("raw/calib_imu_to_velo.txt", "R: 1 0 0 0 1 0 0 0 1\nT: -0.8 0 0\n")
    put("folder/poses.txt", TRAJECTORY)
    put("boxes.csv", "frame,track_id,class,cx,cy,cz,yaw,length,width,height\n"
        "0,0,Van,6,1,0,0.5,4.4,1.8,2.0\n1,0,Car,7,1,0,0.5,4.4,1.8,2.0\n")
    put("chain.yaml", "chain:\n  - strategy: front_end\n    sensor: spinning.yaml\n    max_echoes: 2\n"
        "  - strategy: alignment\n    deskew: true\n  - strategy: tracking\n    pipeline: real\n    gain: 0.3\n"
        "  - strategy: grid\n    half_side_m: 10\n    bearings: 20\n")
    put("van.csv", "time,id,class,x,y,z,yaw,length,width,height\n0,1,van,0,3,1,0,4,2,2\n0.2,1,van,1,3,1,0,4,2,2\n")
    put("edits.json", EDITS)
    put("primitive-edits.json", PRIMITIVE_EDITS)
    put("job.yaml", "command: simulate model --like log.ply --seed {seed} -o sim-{seed}.ply\nover:\n  seed: [1, 2]\n"
        "pieces: 2\n")
    put("rig.yaml", "name: rig\nsensors:\n  - {name: a, sensor: spinning.yaml, position_m: [1, 0, 0.5]}\n"
        "  - {name: b, sensor: spinning.yaml, rotation_deg: [0, 0, 90], latency_ms: 5}\n")
    put("van.txt", "0 0 3 1 0 0 0 1\n0.2 1 3 1 0 0 0 1\n")
    put("van.obj", "".join(f"v {x} {y} {z}\n" for x in (-2, 2) for y in (-1, 1) for z in (-1, 1)) +
        "f 1 2 4 3\nf 5 6 8 7\nf 1 2 6 5\nf 3 4 8 7\nf 1 3 7 5\nf 2 4 8 6\n")


MADE = (
    "import log.csv -o log.ply",
    "import log.ply -o log.ublog",
    "perceive log.ply --pipeline real --start-points 0 -o objects.csv",
    "perceive log.ply --pipeline real --start-points 0 -o objects.json",
    "osi record log.ply --truth objects.json -o views_sv_.osi",
    "osi convert objects.json -o data_sd_.osi",
    "segment log.ply -o labelled.ply --min-points 5",
    "fit log.ply -o model --min-points 4 --ground-spacing 2",
    "fit log.ply -o mesh --fitter surface --surface-cell 1 --ground-spacing 2",
    "extract model labelled.ply -o primitives",
    "annotate labelled.ply -o site.json --ground-spacing 2",
    "compose site.json primitives -o scene",
    "compose moving.json primitives -o moving",
    "regions scene --side 8 -o world",
    "annotate --generate forest --size 40 30 --ground-spacing 4 --parts 20 -o parts",
    "simulate model --like log.ply -o simulated.ply",
    "simulate model --sensor spinning.yaml --trajectory poses.txt --mover van.obj:van.txt -o passing.ply",
    "actors passing.ply --boxes van.csv --least-returns 10 -o actors",
    "plan job.yaml -o plan",
    "simulate model --sensor spinning.yaml --trajectory poses.txt --super-sample sensor -o echoes.ply",
    "import echoes.ply -o echoes.ublog",
    "import marv_forest.pcd -o scan.ply --unknown-below-deg -13",
    "split scan.ply --columns 24 --train rest.ply --test seen.ply",
    "split rest.ply --columns 23 --train others.ply --test more.ply",
    "fit seen.ply -o remembering",
    "optimize log.ply -o tuned.yaml --budget 3 --ground-spacing 2 --checkpoint state.json",
)


def make(folder, program):
    """Writes all seeds into the folder."""
    folder = pathlib.Path(folder)

    def put(name, content):
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(content.encode() if isinstance(content, str) else content)

    recordings(put)
    meshes(put)
    worlds(put)
    for name, content in (("spinning.yaml", SPINNING), ("raster.yaml", RASTER), ("table.yaml", TABLE),
                          ("table.csv", DIRECTIONS), ("simulate-options.yaml", SIMULATE), ("fit-options.yaml", FIT),
                          ("compose-options.yaml", COMPOSE), ("segment-options.yaml", SEGMENT),
                          ("path.txt", PATH)):
        put(name, content)
    shutil.copy(SHARE / "materials/materials.yaml", folder)
    shutil.copy(SHARE / "examples/marv_forest.pcd", folder)  # enough beams for keyframes
    for line in MADE:
        if "moving.json" in line:
            site = json.loads((folder / "site.json").read_text())
            del site["provenance"]
            site["objects"][0]["trajectory"] = "path.txt"
            put("moving.json", json.dumps(site, indent=1))
        done = subprocess.run([program, *line.split(), "--threads", "1"], cwd=folder, text=True,
                              stdin=subprocess.DEVNULL, capture_output=True, check=False)
        if done.returncode != 0:
            raise SystemExit(f"mutate: cannot make the seeds: underbrush {line}\n{done.stderr}")
