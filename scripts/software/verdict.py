"""The verdict of the study: thresholds that were fixed before the figures were seen."""
import dataclasses
import math
import typing

from .figures import Figures

RATIOS = (0.9, 1.1)
LEAST_CORRELATION = 0.7
DIFFERENCES = (0.75, 1.25)     # of successive scans, over the real ones'
LEAST_OF_FLOOR = 0.9           # agreement in ground over that of two real scans


@dataclasses.dataclass(frozen=True)
class Check:
    """A value and the bounds within which it holds. A NaN does not hold."""
    what: str
    value: float
    at_least: float = -math.inf
    at_most: float = math.inf

    def holds(self) -> bool:
        return self.at_least <= self.value <= self.at_most

    def as_json(self) -> dict[str, typing.Any]:
        bounds = {"at_least": self.at_least, "at_most": self.at_most}
        return {"what": self.what, "value": self.value, "holds": self.holds(),
                **{name: bound for name, bound in bounds.items() if math.isfinite(bound)}}

    def __str__(self) -> str:
        bounds = [f"at least {self.at_least:g}"] if math.isfinite(self.at_least) else []
        bounds += [f"at most {self.at_most:g}"] if math.isfinite(self.at_most) else []
        return f"{self.what}: {self.value:.3g}, must be {' and '.join(bounds)}"


def checks(figures: Figures, ours: str, floor: str, standing: str) -> list[Check]:
    """The checks of the source `ours`. On the log `standing` the source `floor` is another real scan of the beams."""
    out = []
    for log, sources in figures["odometry"].items():
        for part in ("translation", "rotation"):
            found = sources[ours][part]
            out.append(Check(f"{log}: RMSE of {part} over that of the real scans", found["ratio"], *RATIOS))
            out.append(Check(f"{log}: correlation of the errors in {part}", found["correlation"], LEAST_CORRELATION))
    for log, sources in figures["scans"].items():
        found = sources[ours]
        out.append(Check(f"{log}: share of ground over the real one", found["ground_share_ratio"], *RATIOS))
        if not math.isnan(found["difference_ratio"]):
            out.append(Check(f"{log}: difference of successive scans over the real one", found["difference_ratio"],
                             *DIFFERENCES))
        if log == standing:
            out.append(Check(f"{log}: agreement in ground over that of two real scans",
                             found["ground_agreement"] / sources[floor]["ground_agreement"], LEAST_OF_FLOOR))
    return out


def verdict(found: typing.Sequence[Check]) -> str:
    """'holds', or 'falls short: ' and each check that does not hold."""
    broken = [str(check) for check in found if not check.holds()]
    return "falls short: " + "; ".join(broken) if broken else "holds"
