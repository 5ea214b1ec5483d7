"""The command `underbrush`: the program that the wheel brings, and the package's readers behind `import`."""
from __future__ import annotations

import os
import pathlib
import sys
from collections.abc import Sequence

#: Ends of names of recordings that the program does not read by itself.
RECORDINGS = (".bag", ".mcap", ".db3", ".las", ".laz", ".pcap", ".pcapng", ".e57", ".xyz")


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
    """Returns the recording that the words `import FILE …` name, or None."""
    if not words or words[0] != "import":
        return None
    return next((w for w in words[1:] if not w.startswith("-") and is_recording(w)), None)


def is_mcap_trace(words: Sequence[str]) -> bool:
    """Whether the words are `osi convert …` with an MCAP file, which the program leaves to the package."""
    return list(words[:2]) == ["osi", "convert"] and any(w.lower().endswith(".mcap") for w in words[2:])


def main(words: Sequence[str] | None = None) -> int:
    """Runs the command with the words after its name and returns its exit code; the program takes this process over."""
    given = list(sys.argv[1:] if words is None else words)
    if recording_of(given) is not None:
        from underbrush.import_recording import run  # reads only now what readers need
        return run(given[1:])
    if is_mcap_trace(given):
        from underbrush.convert_trace import run as convert
        return convert(given[2:])
    found = program()
    os.execv(found, ["underbrush", *given])


if __name__ == "__main__":
    sys.exit(main())
