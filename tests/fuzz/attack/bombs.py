"""Small files that ask for much: compressed zeros, counts without data, and parts that stand in each other."""
import json
import pathlib
import shutil
import struct
import tempfile
import zlib

import bounded

BIG = 100_000_000  # numbers that a bomb asks for


def deflated_zeros(count, wrap=-15, before=b""):
    """Zeros of four bytes each, compressed to a thousandth."""
    packer, out = zlib.compressobj(9, zlib.DEFLATED, wrap), []
    out.append(packer.compress(before))
    for _ in range(count * 4 >> 20):
        out.append(packer.compress(bytes(1 << 20)))
    out.append(packer.flush())
    return b"".join(out)


def npz(count, told):
    """An archive with an array of `count` points, whose directory tells `told` bytes."""
    text = f"{{'descr': '<f4', 'fortran_order': False, 'shape': ({count // 3}, 3), }}\n".encode()
    body = deflated_zeros(count, before=b"\x93NUMPY\x01\x00" + struct.pack("<H", len(text)) + text)
    told = told or 10 + len(text) + count * 4
    fields = struct.pack("<5H3I2H", 20, 0, 8, 0, 33, 0, len(body), told, 5, 0)
    directory = b"PK\1\2" + struct.pack("<H", 20) + fields + struct.pack("<3H2I", 0, 0, 0, 0, 0) + b"a.npy"
    file = b"PK\3\4" + fields + b"a.npy" + body
    return file + directory + b"PK\5\6" + struct.pack("<4H2IH", 0, 0, 1, 1, len(directory), len(file), 0)


def pcd(count, told):
    """A compressed PCD file whose data repeat one byte, 264 of them in each three."""
    whole = count * 12
    runs = b"\0\0" * (whole % 264 + 264) + b"\xe0\xff\0" * (whole // 264 - 1)
    head = (f"VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH {count}\nHEIGHT 1\n"
            f"VIEWPOINT 0 0 0 1 0 0 0\nPOINTS {count}\nDATA binary_compressed\n").encode()
    return head + struct.pack("<II", len(runs), told or whole) + runs


def tiff(side, deflate=True):
    """A map of one strip of zeros, of side × side cells."""
    strip = deflated_zeros(min(side * side, BIG), 15) if deflate else b"\0" * 64
    tags = [(256, 4, 1, side), (257, 4, 1, side), (258, 3, 1, 32), (259, 3, 1, 8 if deflate else 1), (277, 3, 1, 1),
            (278, 4, 1, side), (279, 4, 1, len(strip)), (339, 3, 1, 3)]
    end = 8 + 2 + 12 * (len(tags) + 3) + 4
    tags += [(273, 4, 1, end + 72), (33550, 12, 3, end), (33922, 12, 6, end + 24)]
    directory = b"".join(struct.pack("<HHII", *tag) for tag in sorted(tags))
    places = struct.pack("<9d", 1, 1, 0, 0, 0, 0, 0, 0, 0)
    return struct.pack("<2sHI", b"II", 42, 8) + struct.pack("<H", len(tags)) + directory + b"\0\0\0\0" + places + strip


def gltf(nodes, accessor):
    return json.dumps({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": nodes,
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "mode": 4}]}],
        "accessors": [{"componentType": 5126, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 1], **accessor}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64," + "A" * 48}]}).encode()


def tree_of_nodes(levels):
    """Nodes each of which has the next one twice, so that the last one stands 2^levels times."""
    return [{"children": [k + 1, k + 1]} for k in range(levels)] + [{"mesh": 0}]


LAUGHS = "a0: &a0 [x, x, x, x, x, x, x, x, x, x]\n" + "".join(
    f"a{k}: &a{k} [{', '.join([f'*a{k - 1}'] * 10)}]\n" for k in range(1, 10))
XML_LAUGHS = "<?xml version=\"1.0\"?>\n<!DOCTYPE d [<!ENTITY a0 \"xxxxxxxxxx\">" + "".join(
    f"<!ENTITY a{k} \"{f'&a{k - 1};' * 10}\">" for k in range(1, 10)) + "]>\n<document>&a9;</document>\n"
SIMULATE = "simulate model --sensor {} --trajectory poses.txt -o out.ply"
SENSOR = ("name: bomb\nkind: raster\nshots_per_s: 7200\nraster:\n  azimuth_deg: [-180, 180]\n  elevation_deg: [-60, 60]\n"
          "  step_deg: [{0}, {0}]\nmin_range_m: 0.5\nmax_range_m: 100\n")
VOX = ("VOXEL SPACE\n#min_corner: 0 0 0\n#max_corner: 20 20 10\n#split: {0} {0} {0}\n#res: 10 #lad_type:Spherical\n"
       "i j k PadBVTotal angleMean\n0 0 0 0.1 45\n")
PLY = "ply\nformat binary_little_endian 1.0\nelement {} {}\nproperty float x\nproperty float y\nproperty float z\nend_header\n"

#: Name: (file, bytes or a function that makes them, command).
BOMBS = {
    "npz of zeros": ("b.npz", lambda: npz(BIG, None), "import b.npz -o out.ply"),
    "npz that tells 100 bytes": ("b.npz", lambda: npz(BIG, 100), "import b.npz -o out.ply"),
    "npz that tells 4 GB": ("b.npz", lambda: npz(1 << 20, (1 << 32) - 2), "import b.npz -o out.ply"),
    "pcd of repeats": ("b.pcd", lambda: pcd(BIG // 30, None), "import b.pcd -o out.ply"),
    "pcd that tells 4 GB": ("b.pcd", lambda: pcd(10, (1 << 32) - 1), "import b.pcd -o out.ply"),
    "pcd of 4 GB": ("b.pcd", lambda: pcd(357_913_941, (1 << 32) - 4), "import b.pcd -o out.ply"),
    "GeoTIFF of zeros": ("height.tif", lambda: tiff(8_000), "info terrain.xml"),
    "GeoTIFF of 10^9 cells": ("height.tif", lambda: tiff(31_623), "info terrain.xml"),
    "GeoTIFF without cells": ("height.tif", lambda: tiff(60_000, False), "info terrain.xml"),
    "glTF without data": ("b.gltf", lambda: gltf([{"mesh": 0}], {"count": 3 << 29}), "meshes b.gltf -o out --sizes 1"),
    "glTF of 2^30 nodes": ("b.gltf", lambda: gltf(tree_of_nodes(30), {"bufferView": 0, "count": 3}),
                           "meshes b.gltf -o out --sizes 1"),
    "YAML of aliases, sensor": ("b.yaml", LAUGHS.encode(), SIMULATE.format("b.yaml")),
    "YAML of aliases, options": ("b.yaml", LAUGHS.encode(), "fit log.ply -o out --config b.yaml"),
    "XML of entities": ("b.xml", XML_LAUGHS.encode(), "info b.xml"),
    "sensor of 10^12 beams": ("b.yaml", SENSOR.format("0.0001").encode(), SIMULATE.format("b.yaml")),
    "sensor of 10^9 beams": ("b.yaml", SENSOR.format("0.005").encode(), SIMULATE.format("b.yaml")),
    "voxels 10^12": ("b.vox", VOX.format("10000").encode(), "info b.vox"),
    "voxels 10^9": ("b.vox", VOX.format("1000").encode(), "info b.vox"),
    "PLY of 2^62 points": ("b.ply", PLY.format("vertex", 1 << 62).encode() + bytes(1200), "import b.ply -o out.ply"),
    "PLY of 2^32 points": ("b.ply", PLY.format("vertex", 1 << 32).encode() + bytes(1200), "import b.ply -o out.ply"),
}


def attack(options, table):
    """Gives each bomb to its verb."""
    for name, (file, content, command) in BOMBS.items():
        folder = pathlib.Path(tempfile.mkdtemp(dir=options.scratch))
        for needed in ("model", "poses.txt", "log.ply", "terrain.xml"):
            source = options.inputs / needed
            shutil.copytree(source, folder / needed) if source.is_dir() else shutil.copy(source, folder)
        (folder / file).write_bytes(content() if callable(content) else content)
        done = bounded.run([options.program, *command.split()], folder)
        table.add("bombs", bounded.judged(done), name)
        shutil.rmtree(folder)
