"""Scenes from models and arrays."""
from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from underbrush import _core
from underbrush._core import Model, Scene


def scene_from_models(models: Sequence[Model], *, model: npt.ArrayLike, position: npt.ArrayLike,
                      rotation: npt.ArrayLike | None = None, scale: npt.ArrayLike | None = None,
                      classes: Sequence[str] | None = None, names: Sequence[str] | None = None,
                      materials: Sequence[str] | None = None) -> Scene:
    """Makes a scene of n instances of models: x_world = position + scale * R x.

    x is relative to the origin of the instance's model, which is copied. `model` (n,) is the number of each instance's
    model; `position` (n, 3) m, world; `rotation` (n, 4) unit quaternions x y z w, world from model, unturned where left
    out; `scale` (n,), 1 where left out. `classes` names the class of each instance, in `class_names()` or a new one.
    `names` and `materials` have one for each model; where its material is "" the class decides. To simulate objects
    that move, give `movers` to `simulate`.

    Raises `ValueError` for columns of different lengths, a model that is not there, or a rotation that is none.
    """
    numbers = np.ascontiguousarray(model, dtype=np.uint32)
    n = len(numbers)
    turned = np.tile([0.0, 0.0, 0.0, 1.0], (n, 1)) if rotation is None else rotation
    sizes = np.ones(n) if scale is None else scale
    return _core.scene_of_models(list(models), numbers, np.ascontiguousarray(position, dtype=np.float64),
                                 np.ascontiguousarray(turned, dtype=np.float64),
                                 np.ascontiguousarray(sizes, dtype=np.float32), list(classes or []),
                                 list(names or []), list(materials or []))
