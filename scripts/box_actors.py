#!/usr/bin/env python3
"""Writes a list of edits that gives each labelled object a mesh: its box, from 0.2 m above the ground on. The meshes
are written beside the list."""
import argparse
import csv
import json
import pathlib

FACES = ((1, 2, 6), (1, 6, 5), (2, 4, 8), (2, 8, 6), (4, 3, 7), (4, 7, 8), (3, 1, 5), (3, 5, 7), (5, 6, 8), (5, 8, 7))
CLEARANCE_M = 0.2


def write_box(file, length, width, height):
    """Writes a box without a floor, with the origin in the middle of the labelled one."""
    corners = [(x, y, z) for z in (CLEARANCE_M - height / 2, height / 2) for y in (-width / 2, width / 2)
               for x in (-length / 2, length / 2)]
    file.write_text("".join("v {:g} {:g} {:g}\n".format(*corner) for corner in corners)
                    + "".join("f {} {} {}\n".format(*face) for face in FACES), encoding="utf-8")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("boxes", type=pathlib.Path, help="labelled boxes (CSV)")
    parser.add_argument("actors", help="the folder of the actors, seen from that of the list")
    parser.add_argument("output", type=pathlib.Path, help="the list of edits (JSON)")
    arguments = parser.parse_args()
    sizes = {}
    with open(arguments.boxes, encoding="utf-8") as file:
        for row in csv.DictReader(file):
            name = f"{row['class'].lower()}-{int(row['track_id']) + 1}"
            sizes.setdefault(name, [float(row[key]) for key in ("length", "width", "height")])
    for name, size in sizes.items():
        write_box(arguments.output.parent / f"{name}.obj", *size)
    edits = [{"edit": "model", "actor": name, "model": f"{name}.obj"} for name in sizes]
    arguments.output.write_text(json.dumps({"format": "underbrush-actor-edits", "version": 1,
                                            "actors": arguments.actors, "edits": edits}, indent=1), encoding="utf-8")
