"""Pictures of logs, models and scores with Matplotlib (`pip install 'underbrush[plot]'`).

Each function draws into the axes `ax`, or into a figure of its own, and returns the axes, so that titles, limits and
further artists can be added. People with any of the usual forms of colour blindness can distinguish the colours:
`cividis` for amounts, `PuOr` for signed errors, and the colours of Okabe and Ito for kinds.
"""
from __future__ import annotations

try:
    import matplotlib as _matplotlib
except ImportError as error:
    raise ImportError("underbrush.plot needs Matplotlib: pip install 'underbrush[plot]'") from error

from underbrush.plot.images import Panorama, error_map, panorama, range_image
from underbrush.plot.scores import range_error_histogram, reliability, score_by_range
from underbrush.plot.section import ellipses_in_plane, section

__all__ = ["Panorama", "ellipses_in_plane", "error_map", "panorama", "range_error_histogram", "range_image",
           "reliability", "score_by_range", "section"]

del _matplotlib
