"""A log that has every feature at once: a sensor with a name, range offsets of its channels, recorded misses, several
scans, intensities, classes, several tiles, and two drives far from each other and from the origin of the world. It is
synthetic: the site of the demo, scanned with a coarse sensor."""
import json
import math
import pathlib
import re
import shutil
import struct

SHARE = pathlib.Path(__file__).resolve().parents[2] / "share"
FAR = (431000.0, 5412000.0, 210.0)  # m, as in UTM
SECOND_DRIVE = (150.0, -80.0, 2.0)  # m from the first one
TYPES = {"double": "d", "float": "f", "uchar": "B", "uint8": "B", "ushort": "H", "uint16": "H", "uint": "I",
         "uint32": "I", "int": "i", "short": "h", "char": "b"}


def coarse_sensor(file):
    """Writes the data file of a VLP-16 with few columns and two revolutions a second."""
    text = (SHARE / "sensors/velodyne-vlp16.yaml").read_text()
    for key, value in (("name", "coarse"), ("rate_hz", 2), ("firing_period_us", 2000)):
        text = re.sub(rf"^{key}: .*", f"{key}: {value}", text, flags=re.MULTILINE)
    pathlib.Path(file).write_text(text)


def offset_m(ring):
    """The range offset of a channel: up to 6 cm, zero on average."""
    return 0.02 * (ring * 5 % 7 - 3)


def intensity_of(label, range_m, row):
    """An intensity by class and range, with a spread of ten per cent."""
    spread = 1 + 0.1 * ((row * 2654435761 & 0xffff) / 0x8000 - 1)
    return (20 + 30 * (label % 5)) * spread / (1 + range_m / 40)


class Rows:
    """The rows of a ray cloud, which can be changed in place."""
    def __init__(self, file):
        content = pathlib.Path(file).read_bytes()
        end = content.index(b"end_header\n") + len(b"end_header\n")
        self.head = content[:end].decode()
        names = re.findall(r"^property (\w+) (\w+)$", self.head, re.MULTILINE)
        self.row = struct.Struct("<" + "".join(TYPES[kind] for kind, _ in names))
        self.at = {name: k for k, (_, name) in enumerate(names)}
        self.rows = [list(r) for r in self.row.iter_unpack(content[end:])]

    def column(self, name):
        return [r[self.at[name]] for r in self.rows]

    def write(self, file):
        pathlib.Path(file).write_bytes(self.head.encode() + b"".join(self.row.pack(*r) for r in self.rows))


def away_m(scan, scans):
    """Where the drive of a scan is."""
    second = scan >= scans // 2
    return [a + (b if second else 0.0) for a, b in zip(FAR, SECOND_DRIVE)]


def change(rows):
    """Adds to a log of the demo what it does not have."""
    scans = 1 + max(rows.column("scan"))
    at = rows.at
    for k, r in enumerate(rows.rows):
        end = [r[at[name]] for name in "xyz"]
        back = [r[at["n" + name]] for name in "xyz"]  # from the end to the origin of the beam
        away = away_m(r[at["scan"]], scans)
        longer = 0.0
        if r[at["alpha"]]:  # a return
            range_m = math.sqrt(sum(b * b for b in back))
            longer = offset_m(r[at["ring"]]) / range_m
            r[at["remission"]] = intensity_of(r[at["class"]], range_m, k)
        for axis, name in enumerate("xyz"):
            r[at[name]] = end[axis] + away[axis] - longer * back[axis]
            r[at["n" + name]] = (1 + longer) * back[axis]

    def moved_scan(match):
        words = match.group(0).split(" ")
        away = away_m(int(words[3]), scans)
        words[5:8] = [repr(float(word) + a) for word, a in zip(words[5:8], away)]
        return " ".join(words)
    rows.head = re.sub(r"^comment underbrush scan .*$", moved_scan, rows.head, flags=re.MULTILINE)


def make(call, folder):
    """Writes train.ply and test.ply, of scans that alternate, and model/, fitted to the first, into the folder. `call`
    runs the program. The log is too small for range offsets or much weight of keyframes, and its sensor moves, which
    teaches no correlation time of the matter, so these are set."""
    folder = pathlib.Path(folder)
    coarse_sensor(folder / "coarse.yaml")
    call("demo", "--only", "site", "--sensor", folder / "coarse.yaml", "--sub-rays", 1, "-o", folder / "demo")
    for name in ("train", "test"):
        rows = Rows(folder / "demo" / f"{name}.ply")
        change(rows)
        rows.write(folder / f"{name}.ply")
    call("fit", folder / "train.ply", "-o", folder / "model")
    manifest = folder / "model/model.json"
    model = json.loads(manifest.read_text())
    model["channels"] = [{"ring": ring, "range_offset_m": offset_m(ring), "standard_error_m": 0.002}
                         for ring in range(16)]
    model["sway_s"] = 1.5
    for trust in model["keyframes"]["trust"]:
        trust["elements"] = 0.5
        trust["pixels"] = [0.5 / len(trust["pixels"])] * len(trust["pixels"])
    manifest.write_text(json.dumps(model))


def make_unnamed(folder):
    """Writes what `make` has written once more without the sensor's name: unnamed.ply and the model unnamed/. In
    renumbered.ply the channels have other numbers, as those of another sensor do."""
    folder = pathlib.Path(folder)
    rows = Rows(folder / "test.ply")
    rows.head = re.sub(r"^comment underbrush sensor .*\n", "", rows.head, flags=re.MULTILINE)
    rows.head = re.sub(r'"sensor": ?"coarse"', '"sensor":""', rows.head)
    rows.write(folder / "unnamed.ply")
    ring = rows.at["ring"]
    for r in rows.rows:
        r[ring] = 15 - r[ring]
    rows.write(folder / "renumbered.ply")
    shutil.copytree(folder / "model", folder / "unnamed")
    manifest = folder / "unnamed/model.json"
    model = json.loads(manifest.read_text())
    for key in ("channels", "sensor_file"):
        model.pop(key, None)
    model["sensor"] = ""
    manifest.write_text(json.dumps(model))
