"""The options of `underbrush import` for recordings; those of the program for other formats have the same names."""
from __future__ import annotations

import argparse
import pathlib
from collections.abc import Sequence
from typing import Any, NoReturn

from .._core import import_options
from ..errors import FormatError
from .las_units import UNITS

_MOST_THREADS, _FARTHEST_M, _MOST_FRAMES = 1024, 1e6, 1 << 32
_EPILOG = """examples:
  underbrush import drive.bag                                    what the bag holds
  underbrush import drive.bag --infer-misses velodyne-hdl64e -o drive.ply
  underbrush import drive.mcap --topic /velodyne_packets --frames 0:100 -o drive.ply
  underbrush import plot.laz -o plot.ply                         an aircraft's positions are estimated
  underbrush import plot.laz --poses flight.txt -o plot.ply      t x y z of the scanner, GPS time
  underbrush import station.e57 --topic 2 -o station.ply         one station
  underbrush import vlp16.pcap --position 0,0,1.8 -o vlp16.ply"""


class Parser(argparse.ArgumentParser):
    """Prints an error in one line, as the program does."""

    def error(self, message: str) -> NoReturn:
        self.exit(2, f"underbrush: {' '.join(message.split())} (see underbrush import --help)\n")


def parser() -> Parser:
    """Returns the parser."""
    p = Parser(prog="underbrush import", epilog=_EPILOG, formatter_class=argparse.RawDescriptionHelpFormatter,
               description="Convert a recording to a ray cloud PLY.", allow_abbrev=False)
    p.add_argument("file", metavar="FILE", help="bag, MCAP, LAS, LAZ, pcap, pcapng, E57 or HELIOS++ .xyz")
    p.add_argument("-o", "--output", metavar="LOG.ply",
                   help="the log; without it, a description of the recording is printed")
    p.add_argument("--topic", default="", metavar="NAME",
                   help="the topic (bags), ADDRESS:PORT (captures) or station (E57: its number or name) to read")
    p.add_argument("--poses", metavar="FILE|TOPIC",
                   help="poses of the sensor; default: the recording's own, or those estimated from an airborne survey")
    p.add_argument("--position", metavar="X,Y,Z", type=_place, help="place of a sensor that stands still, in the coordinates of the recording")
    p.add_argument("--unit", default="", choices=tuple(UNITS),
                   help="unit of the coordinates of a bag's clouds, of an E57, LAS or LAZ file and its sensor's places; default: "
                        "that of its CRS, or m")
    p.add_argument("--frame", default="", metavar="NAME", help="frame of the poses (bags)")
    p.add_argument("--clock", default="stamp", choices=("stamp", "bag"), help="clock of the scans (bags)")
    p.add_argument("--point-times", default="after", choices=("after", "before", "until"),
                   help="how times of points count (bags): after the scan's time; before it, back from its last point; or "
                        "until it, the time of the last point")
    p.add_argument("--metadata", metavar="FILE",
                   help="the sensor's metadata (Ouster JSON, Velodyne YAML or XML, Hesai CSV or DAT, or a folder with a "
                        "Hesai's two CSV files, of angles and of firing times)")
    p.add_argument("--sensor", default="", metavar="SENSOR", help="the sensor; default: that of the recording")
    p.add_argument("--infer-misses", default="", metavar="SENSOR",
                   help="infer misses from this sensor's scan pattern, for point clouds of bags that drop them")
    p.add_argument("--unknown-below-deg", type=_number(-90, 90), metavar="X",
                   help="infer no misses that point lower than this elevation; default: -13")
    p.add_argument("--frames", type=frames, metavar="A:B[:STEP]", help="scans to read, by number, half-open")
    p.add_argument("--keep", type=_keep, metavar="COLUMN=VALUE",
                   help="read only the points with this value of a column, such as return_number=1")
    p.add_argument("--label-set", default="", choices=("underbrush", "semantickitti", "rellis"),
                   help="label set of the column class")
    p.add_argument("--max-range", metavar="M", type=_number(0, _FARTHEST_M), default=0.0,
                   help="range of a miss, m; 0 = the sensor's, or that of the longest return")
    p.add_argument("--float", action="store_true", help="write coordinates as float instead of double")
    p.add_argument("--json", metavar="FILE|-", help="write the counts, or what the recording holds, as JSON")
    p.add_argument("--config", metavar="FILE.yaml", help="read options from a YAML file; flags override it")
    p.add_argument("--force", action="store_true", help="replace files that underbrush did not write")
    p.add_argument("--threads", type=_whole(_MOST_THREADS), default=0, metavar="N", help="threads, 0 = one a core")
    p.add_argument("--seed", type=_whole((1 << 64) - 1), default=1, metavar="N",
                   help="seed of random choices, of which a recording needs none")
    return p


def parsed(words: Sequence[str]) -> argparse.Namespace:
    """Returns the options in the words and in their `--config`. Raises `FormatError`, `OSError`."""
    p = parser()
    words = list(words)
    for k in range(len(words) - 1, 0, -1):
        if words[k - 1] == "--position" and words[k].startswith("-"):  # A place, and no option.
            words[k - 1:k + 1] = ["--position=" + words[k]]
    given = p.parse_args(words)
    return p.parse_args([*_words_of(p, given.config), *words]) if given.config else given


def _words_of(p: Parser, path: str) -> list[str]:
    """The words that a file of lines NAME: VALUE stands for."""
    from ._files import need
    yaml = need("yaml")
    try:
        root = yaml.load(pathlib.Path(path).read_text(encoding="utf-8"), yaml.BaseLoader)  # Values stay texts.
    except yaml.MarkedYAMLError as error:
        line = error.problem_mark.line + 1 if error.problem_mark else 1
        raise FormatError(path, f"line {line}", str(error.problem)) from error
    except (ValueError, RecursionError, OSError) as error:
        raise FormatError(path, "", "cannot be read") from error
    if root in (None, ""):
        return []
    if not isinstance(root, dict):
        raise FormatError(path, "", "expected lines of NAME: VALUE")
    options: dict[str, Any] = {name[2:]: action for action in p._actions for name in action.option_strings
                               if name.startswith("--") and name not in ("--help", "--config", "--force", "--json")}
    defaults = {name: default for name, _, default, *_ in import_options()}  # Recordings do not need all of them.
    words = []
    for name, value in root.items():
        if not isinstance(value, str):
            raise FormatError(path, str(name), "expected a value")
        if name not in options:
            if name not in defaults:
                raise FormatError(path, str(name), "no such option of 'import' (see dump-config)")
            if value != defaults[name]:
                raise FormatError(path, str(name), "is not for recordings")
            continue
        if options[name].nargs == 0:
            if value not in ("true", "false"):
                raise FormatError(path, name, "expected true or false")
            words += ["--" + name] if value == "true" else []
        elif value and value != defaults.get(name):
            words += [f"--{name}={value}"]
    return words


def frames(text: str) -> range:
    """The numbers of scans that A:B or A:B:STEP names."""
    parts = text.split(":")
    if not 2 <= len(parts) <= 3 or not all(part == "" or part.isdecimal() for part in parts):
        raise argparse.ArgumentTypeError(f"expected A:B or A:B:STEP, not {text}")
    numbers = [int(part) if part else usual for part, usual in zip([*parts, ""], (0, _MOST_FRAMES, 1))]
    if not numbers[2] or not numbers[0] < numbers[1] <= _MOST_FRAMES:
        raise argparse.ArgumentTypeError(f"no frame lies in {text}")
    return range(*numbers)


def _keep(text: str) -> tuple[str, float]:
    name, _, value = text.partition("=")
    try:
        return name, float(value if name else "")
    except ValueError:
        raise argparse.ArgumentTypeError(f"expected COLUMN=NUMBER, not {text}") from None


def _place(text: str) -> tuple[float, float, float]:
    try:
        x, y, z = (float(word) for word in text.split(","))
    except ValueError:
        raise argparse.ArgumentTypeError(f"expected X,Y,Z, not {text}") from None
    return x, y, z


def _number(least: float, most: float) -> Any:
    def number(text: str) -> float:
        try:
            value = float(text)
        except ValueError:
            value = float("nan")
        if not least <= value <= most:
            raise argparse.ArgumentTypeError(f"must be from {least:g} to {most:.7g}, not {text}")
        return value
    return number


def _whole(most: int) -> Any:
    def whole(text: str) -> int:
        if not text.isdecimal() or int(text) > most:
            raise argparse.ArgumentTypeError(f"expected a whole number from 0 to {most}, not {text}")
        return int(text)
    return whole
