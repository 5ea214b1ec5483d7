"""The command `underbrush`: the program of the wheel, and the package's readers for `import` and `info`."""
from __future__ import annotations

import os
import pathlib
import subprocess
import sys
from collections.abc import Sequence

from underbrush.errors import failed
from underbrush.recorded import is_recording, log_of
from underbrush.written_log import output_of, run as run_and_write

#: Verbs that read logs, and options whose values they do not read as logs.
LOG_VERBS = ("fit", "simulate", "score", "serve", "split", "movers", "actors", "segment", "extract", "perceive",
             "optimize")
OTHER_FILES = ("-o", "--output", "--json", "--report", "--truth", "--write-truth", "--test", "--trajectory")


#: Options of `import` for recordings; other verbs accept them for the recordings that they read.
IMPORT_OPTIONS = ("--topic", "--position", "--frame", "--clock", "--metadata", "--infer-misses", "--unknown-below-deg",
                  "--poses", "--frames", "--keep")


def program() -> pathlib.Path:
    """Returns the path of the program beside this file. Raises `FileNotFoundError`."""
    found = pathlib.Path(__file__).parent / "bin" / "underbrush"
    if not found.exists():
        raise FileNotFoundError(f"{found}: the package was installed without its program")
    return found


def recording_of(words: Sequence[str]) -> str | None:
    """Returns the recording in the words `import FILE …` or `info FILE …`, or None."""
    if not words or words[0] not in ("import", "info"):
        return None
    return next((w for before, w in zip(words, words[1:])
                 if not w.startswith("-") and before not in OTHER_FILES and is_recording(w)), None)


def with_logs(words: Sequence[str]) -> list[str]:
    """The words, with a log in the cache for each recording that a verb reads as a log (see `log_of`).

    Options of `import` for recordings are removed from the words then. Imports are reported on standard error.
    """
    out: list[str] = []
    options: list[str] = []
    places: list[int] = []  # Of recordings among `out`.
    for word in words:
        before = out[-1] if out else ""
        option, equals, value = word.partition("=") if word.startswith("--") else (before, "", word)
        if option in IMPORT_OPTIONS:
            if option == before:
                out.pop()
            if equals or option == before:
                options.append(f"{option}={value}")
                continue
        elif (len(out) and option not in OTHER_FILES and (words[0], option) != ("split", "--train")
              and is_recording(value) and pathlib.Path(value).exists()):
            places.append(len(out))
        out.append(word)
    if not places or words[0] not in LOG_VERBS:
        return list(words)
    for k in places:
        option, equals, value = out[k].rpartition("=") if out[k].startswith("--") else ("", "", out[k])
        log = log_of(value, lambda note: print(f"underbrush: {note}", file=sys.stderr), options)
        print(f"underbrush: {value}: its log is {log}", file=sys.stderr)
        out[k] = f"{option}{equals}{log}"
    return out


def import_help(words: Sequence[str]) -> bool:
    """Whether the words request the help of `import`, which has two parts."""
    return list(words[:1]) == ["import"] and any(word in ("-h", "--help", "--help-all") for word in words[1:])


def is_mcap_trace(words: Sequence[str]) -> bool:
    """Whether the words are `osi convert …` with an MCAP file, which the program leaves to the package."""
    return list(words[:2]) == ["osi", "convert"] and any(w.lower().endswith(".mcap") for w in words[2:])


def main(words: Sequence[str] | None = None) -> int:
    """Runs the command with the words after its name and returns its exit code; the program may replace the process."""
    given = list(sys.argv[1:] if words is None else words)
    if output_of(given):
        try:
            return run_and_write(given)
        except (ValueError, ImportError, OSError) as e:
            return failed(e)
    if recording_of(given) is not None:
        from underbrush.import_recording import run  # reads only now what readers need
        return run(given[1:], describe_only=given[0] == "info")
    if is_mcap_trace(given):
        from underbrush.convert_trace import run as convert
        return convert(given[2:])
    try:
        given = with_logs(given)
    except (ValueError, ImportError, OSError) as e:
        return failed(e)
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
