"""What all pictures share: axes, and colours that colour-blind people can distinguish."""
from __future__ import annotations

import matplotlib.pyplot as plt
import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes

Array = npt.NDArray[np.float64]

#: Colours for kinds, by Okabe and Ito.
KINDS = ("#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9", "#D55E00", "#F0E442", "#000000")
AMOUNT = "cividis"  #: Map for amounts.
SIGNED = "PuOr"  #: Map for signed errors; its middle is white.
MISS = "#BBBBBB"  #: A beam without a return.
FALSE_HIT = "#000000"  #: The simulation has a return where there was none.
FALSE_MISS = "#009E73"  #: The simulation has no return where there was one.


def axes_or_new(ax: Axes | None, width_in: float = 8.0, height_in: float = 3.5) -> Axes:
    """Returns the axes, or those of a new figure of a size in inches."""
    if ax is not None:
        return ax
    return plt.subplots(figsize=(width_in, height_in), layout="constrained")[1]
