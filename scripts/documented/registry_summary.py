"""The tables that repeat figures of others: the first ones of the README and of docs/results.md. A view names, for each
of its cells, the cells of the other table and the numbers of their figures, counted from 0; so that it is measured as
the other table is, and its printed figures are held against the printed ones of the other (tests/rules/results.py)."""
from .jobs import Measured, Part
from .tables import figures

FOREST, STREET, STILL = "kitti_0027_forest", "kitti_0005_city", "kitti_0052_static"
INSIDE = {log: log for log in (FOREST, STREET, STILL, "rellis_000104", "marv_forest")}
SOURCES = {"draw": "default", "median": "default, median", "mesh": "mesh", "look-up": "look-up, 2 scans",
           "always hit": "always hit"}
PLACES = {f"{FOREST}/inside the stretch": "forest, inside the stretch", f"{FOREST}/5 m beyond": "forest, 5 m beyond",
          f"{FOREST}/20 m beyond": "forest, 20 m beyond", f"{STREET}/5 m beyond": "street, 5 m beyond",
          f"{FOREST}/denser": "forest, between rings", f"{STREET}/denser": "street, between rings",
          f"{STILL}/denser": "standing vehicle, between rings", "rellis_000104/denser": "rellis_000104, between rings",
          "marv_forest/denser": "marv_forest, between rings"}
SCENES = {"draw": "primitives", "mesh": "meshes (generated sites", "always hit": "always hit"}


def looked_up(column, other, rows):
    """Cells of the table `look-up`: {(row, column): [(table, row, column, number)]}."""
    return {(row, f"{column}{source}"): [("look-up", f"{log}/{model}", other, 0)]
            for log, row in rows.items() for source, model in SOURCES.items()}


def beyond(column, other, rows):
    """Cells of the table `extrapolation`, whose cells have the default, two meshes, the look-up and always hit."""
    return {(row, f"{column}{source}"): [("extrapolation", place, other, number)]
            for place, row in rows.items() for source, number in (("draw", 0), ("mesh", 1), ("look-up", 3),
                                                                          ("always hit", 4))}


VIEWS = {
    "readme": {
        **looked_up("", "capped error, m", {FOREST: "a drive through a forest", STREET: "a drive along a street",
                                            STILL: "a standing vehicle", "rellis_000104": "one scan of RELLIS",
                                            "marv_forest": "one scan of ROUGH"}),
        **looked_up("", "informedness", {FOREST: "informedness: the forest", STREET: "the street",
                                         STILL: "the standing vehicle", "rellis_000104": "RELLIS-3D",
                                         "marv_forest": "ROUGH"}),
        **beyond("", "capped error, m", {f"{FOREST}/20 m beyond": "20 m beyond", f"{STREET}/5 m beyond": "5 m beyond",
                                         f"{FOREST}/denser": "between rings, forest",
                                         f"{STREET}/denser": "between rings, street"}),
        **{("composed scene", source): [("scenes", row, "drive: cloud error, m", 0)]
           for source, row in SCENES.items()}},
    "summary-inside": {**looked_up("capped error, m: ", "capped error, m", INSIDE), **looked_up("informedness: ", "informedness", INSIDE),
                       **looked_up("F1 of misses: ", "F1 of misses", INSIDE)},
    "summary-beyond": {**beyond("informedness: ", "informedness", PLACES),
                       **beyond("capped error, m: ", "capped error, m", PLACES)},
    "summary-scenes": {(row, column): [("scenes", row, f"drive: {column}", 0)]
                       for row in ("primitives", "meshes (generated sites", "fit of the test log", "replay", "always hit")
                       for column in ("cloud error, m", "packet error, m", "F1")},
}


def broken(view, table, found):
    """Lists what a view prints that is not printed in the table that it repeats, `found[name]`."""
    out = []
    for place, cells in view.items():
        row, column = table.row(place[0]), table.column(place[1])
        printed = figures(table.cell(row, column)) if None not in (row, column) else []
        if len(printed) != len(cells):
            out.append(f"{len(printed)} figures in {' | '.join(place)}, {len(cells)} in the tables that it repeats")
        for figure, (name, to_row, to_column, number) in zip(printed, cells):
            other = found[name]
            to = other.row(to_row), other.column(to_column)
            value = figures(other.cell(*to))[number].value if None not in to else float("nan")
            if not abs(value - figure.value) <= figure.half_unit * (1 + 1e-6):
                out.append(f"{' | '.join(place)}: {figure.text} is {value:g} in the table '{name}'")
    return out


def measured(view, tables):
    """How a view is measured: by the jobs of the tables that it repeats."""
    wanted = {}
    for place, cells in view.items():
        for table, row, column, number in cells:
            wanted.setdefault((table, row, column), []).append((place, number))

    def repeat(name, part):
        def cells(*folders):
            for row, column, figures in part.cells(*folders):
                for (to_row, to_column), number in wanted.get((name, row, column), ()):
                    yield to_row, to_column, [figures[number]]
        return Part(part.jobs, cells)
    return Measured(tuple(repeat(name, part) for name in dict.fromkeys(key[0] for key in wanted)
                          for part in tables[name].parts))
