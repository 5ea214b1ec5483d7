"""The unit of the coordinates of a LAS file, from its coordinate reference system."""
from __future__ import annotations

import dataclasses
import re
from typing import Any

_FOOT, _US_FOOT = 0.3048, 1200 / 3937  # m
UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001, "ft": _FOOT}  #: Units that a user may name, in m.
_KEYS = {9001: 1.0, 9002: _FOOT, 9003: _US_FOOT, 9036: 1000.0}  # EPSG's codes of units, in m.
_PROJECTED = ("PROJCS", "PROJCRS", "PROJECTEDCRS", "LOCAL_CS", "ENGCRS", "ENGINEERINGCRS", "GEOCCS")
_GEOGRAPHIC = ("GEOGCS", "GEOGCRS", "GEOGRAPHICCRS", "GEODCRS", "GEODETICCRS")
_VERTICAL = ("VERT_CS", "VERTCS", "VERTCRS", "VERTICALCRS")
#: State Plane systems of NAD83 and of NAD83(HARN), all in feet: these in the international one, the others in the US's.
_STATE_PLANE = (range(2222, 2290), range(2867, 2931))
_INTERNATIONAL = {2222, 2223, 2224, 2251, 2252, 2253, 2256, 2265, 2266, 2269, 2270, 2273, 2280, 2281, 2282,
                  2867, 2868, 2869, 2896, 2897, 2898, 2901, 2909, 2910, 2913, 2914, 2921, 2922, 2923}
_NAVD88 = {6360: _US_FOOT, 8228: _FOOT, 5702: _US_FOOT}  # Heights in feet.

Node = list[Any]  # The name of a WKT element, then its values.


@dataclasses.dataclass(frozen=True)
class Units:
    """The units of x and y, and of z, in m; `degrees` where x and y are longitude and latitude."""

    flat_m: float = 1.0
    up_m: float = 1.0
    degrees: bool = False

    def names(self) -> str:
        """The units in words."""
        flat, up = ("degrees" if self.degrees else _name(self.flat_m)), _name(self.up_m)
        return flat if flat == up else f"{flat}, z in {up}"

    def note(self) -> str:
        """What was done with coordinates in other units than m; empty where nothing was."""
        if self.flat_m == self.up_m == 1:
            return ""
        return (f"the file's coordinates are in {self.names()}: they, and the places of the sensor, are multiplied by "
                f"{self.flat_m:.10g}" + (f" (z: {self.up_m:.10g})" if self.up_m != self.flat_m else ""))


def _name(unit_m: float) -> str:
    for unit, name in ((1.0, "m"), (_FOOT, "international feet"), (_US_FOOT, "US survey feet")):
        if abs(unit_m / unit - 1) < 1e-7:
            return name
    return f"units of {unit_m:.10g} m"


def units_of_wkt(text: str) -> Units | None:
    """The units of a coordinate reference system in WKT, of either version; None if it has none."""
    root = _parsed(text)
    vertical = _find(root, _VERTICAL)
    up = _unit(vertical) if vertical else None
    flat = _find(root, _PROJECTED)
    if flat is None:
        flat = _find(root, _GEOGRAPHIC)
        if flat is None or re.search(r"\bCS\s*\[\s*Cartesian", text, re.I):
            return None
        return Units(1.0, up or 1.0, degrees=True)
    unit = _unit(flat)
    return None if unit is None else Units(unit, up or unit)


def units_of_keys(keys: dict[int, int], doubles: dict[int, float], text: str) -> Units | None:
    """The units in GeoTIFF keys: the values of keys with short values, those with doubles, and all texts."""
    system, height = keys.get(3072, 0), keys.get(4096, 0)
    up = _KEYS.get(keys.get(4099, 0), _NAVD88.get(height))
    if keys.get(1024) == 2 or (1024 not in keys and 2048 in keys and not system):
        return Units(1.0, up or 1.0, degrees=True)
    flat = _KEYS.get(keys.get(3076, 0), doubles.get(3077))
    if flat is None and any(system in codes for codes in _STATE_PLANE):
        flat = _FOOT if system in _INTERNATIONAL else _US_FOOT
    if flat is None and 3076 not in keys:
        flat = _US_FOOT if re.search(r"ftus|us[ _-]?survey|us[ _-]?f(oo|ee)?t|f(oo|ee)t[ _]us", text, re.I) else (
            _FOOT if re.search(r"\b(ft|foot|feet)\b", text, re.I) else None)
    if flat is None:
        return Units(1.0, up) if up else None
    return Units(flat, up or flat)


def _parsed(text: str) -> Node:
    """The elements of a WKT, nested."""
    stack: list[Node] = [[""]]
    for word in re.findall(r'"[^"]*"|[\[\](),]|[^\[\](),"\s]+', text):
        if word in "[(":
            name = stack[-1].pop() if len(stack[-1]) > 1 and isinstance(stack[-1][-1], str) else ""
            node: Node = [name.upper()]
            stack[-1].append(node)
            stack.append(node)
        elif word in "])":
            if len(stack) > 1:
                stack.pop()
        elif word != ",":
            stack[-1].append(word)
    return stack[0]


def _find(node: Node, names: tuple[str, ...]) -> Node | None:
    """The first element of one of these names, from the outside in."""
    queue = [node]
    while queue:
        one = queue.pop(0)
        if one[0] in names:
            return one
        queue += [child for child in one[1:] if isinstance(child, list)]
    return None


def _unit(node: Node) -> float | None:
    """The unit (m) of an element, or of its first axis."""
    for child in node[1:]:
        if isinstance(child, list) and child[0] in ("UNIT", "LENGTHUNIT") and len(child) > 2:
            try:
                return float(child[2])
            except (TypeError, ValueError):
                return None
    for child in node[1:]:
        if isinstance(child, list) and child[0] == "AXIS":
            return _unit(child)
    return None
