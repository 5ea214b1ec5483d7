"""`underbrush osi convert` between `.osi` and MCAP traces."""
from __future__ import annotations

import argparse
from collections.abc import Sequence

from underbrush._core import check_outputs
from underbrush.errors import failed


def parser() -> argparse.ArgumentParser:
    """Returns the parser of the options."""
    p = argparse.ArgumentParser(prog="underbrush osi convert", description="Convert an OSI trace to MCAP or back.")
    p.add_argument("file", metavar="TRACE", help="trace: .osi or .mcap")
    p.add_argument("-o", "--output", metavar="TRACE", required=True, help="trace of the other kind")
    p.add_argument("--topic", help="the channel to read, where an MCAP file has several")
    p.add_argument("--force", action="store_true", help="replace a file that underbrush did not write")
    p.add_argument("--kind", default="", help="the kind of messages, if it is not in the name of the .osi file")
    return p


def run(words: Sequence[str]) -> int:
    """Runs `underbrush osi convert WORDS` and returns the exit code: 0, 2 wrong usage, 3 bad input, 4 failure."""
    from underbrush.formats.osi_trace import mcap_to_osi, osi_to_mcap
    options = parser().parse_args(words)
    names = [str(name).lower() for name in (options.file, options.output)]
    try:
        check_outputs([("--output", options.output)], [options.file], options.force)
        if names[0].endswith(".mcap") and names[1].endswith(".osi"):
            count = mcap_to_osi(options.file, options.output, topic=options.topic)
        elif names[0].endswith(".osi") and names[1].endswith(".mcap"):
            count = osi_to_mcap(options.file, options.output, kind=options.kind)
        else:
            raise ValueError("MCAP traces are converted to .osi and from it")
    except (ValueError, ImportError, OSError) as e:
        return failed(e)
    print(f"{count} messages\n  trace       {options.output}")
    return 0
