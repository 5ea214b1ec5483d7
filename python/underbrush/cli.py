"""The command `underbrush`: the program that the wheel brings, and the package's readers behind `import` and `info`."""
from __future__ import annotations

import os
import pathlib
import shlex
import subprocess
import sys
from collections.abc import Sequence

#: Ends of names of recordings that the program does not read by itself.
RECORDINGS = (".bag", ".mcap", ".db3", ".las", ".laz", ".pcap", ".pcapng", ".e57", ".xyz")

#: Verbs that read logs, and options whose values they do not read as logs.
LOG_VERBS = ("fit", "simulate", "score", "serve", "split", "movers", "segment", "extract", "perceive", "optimize",
             "rasters")
OTHER_FILES = ("-o", "--output", "--json", "--report", "--truth", "--write-truth")


def program() -> pathlib.Path:
    """Returns the path of the program beside this file. Raises `FileNotFoundError`."""
    found = pathlib.Path(__file__).parent / "bin" / "underbrush"
    if not found.exists():
        raise FileNotFoundError(f"{found}: the package was installed without its program")
    return found


def is_recording(name: str) -> bool:
    """Whether the program leaves the file or folder to the package's readers (a ROS 2 bag is a folder)."""
    path = pathlib.Path(name)
    return name.lower().endswith(RECORDINGS) or (path / "metadata.yaml").is_file()


def recording_of(words: Sequence[str]) -> str | None:
    """Returns the recording that the words `import FILE …` or `info FILE …` name, or None."""
    if not words or words[0] not in ("import", "info"):
        return None
    return next((w for before, w in zip(words, words[1:])
                 if not w.startswith("-") and before not in OTHER_FILES and is_recording(w)), None)


def advice(words: Sequence[str]) -> str:
    """What to do where a verb that reads logs is given a recording; empty where it is not."""
    if not words or words[0] not in LOG_VERBS:
        return ""
    for before, word in zip(words, words[1:]):
        option, _, value = word.partition("=") if word.startswith("-") else (before, "", word)
        if value and option not in OTHER_FILES and is_recording(value) and pathlib.Path(value).exists():
            log = pathlib.Path(value.rstrip("/")).with_suffix(".ply").name
            return (f"{value}: is a recording and no log: 'underbrush import {shlex.quote(value)} -o {shlex.quote(log)}' "
                    "makes one of it")
    return ""


def import_help(words: Sequence[str]) -> bool:
    """Whether the words ask for the help of `import`, which has two parts."""
    return list(words[:1]) == ["import"] and any(word in ("-h", "--help", "--help-all") for word in words[1:])


def is_mcap_trace(words: Sequence[str]) -> bool:
    """Whether the words are `osi convert …` with an MCAP file, which the program leaves to the package."""
    return list(words[:2]) == ["osi", "convert"] and any(w.lower().endswith(".mcap") for w in words[2:])


def main(words: Sequence[str] | None = None) -> int:
    """Runs the command with the words after its name and returns its exit code; the program takes this process over."""
    given = list(sys.argv[1:] if words is None else words)
    if recording_of(given) is not None:
        from underbrush.import_recording import run  # reads only now what readers need
        return run(given[1:], describe_only=given[0] == "info")
    if is_mcap_trace(given):
        from underbrush.convert_trace import run as convert
        return convert(given[2:])
    if line := advice(given):
        print(f"underbrush: {line}", file=sys.stderr)
        return 3
    found = program()
    if import_help(given):
        from underbrush.formats.import_options import parser
        code = subprocess.run([str(found), *given], check=False).returncode
        print("\nRecordings (bags, MCAP, LAS, LAZ, pcap, E57) are read by the Python package:\n\n" + parser().format_help(),
              end="")
        return code
    os.execv(found, ["underbrush", *given])


if __name__ == "__main__":
    sys.exit(main())
