"""Two models: one on the base class, one that only has fit and predict."""

import numpy as np

from hystbench.models import HysteresisModel, Stepper


class SpringAndStop(HysteresisModel):
    """y = k x + c s with one stop operator s of threshold r, found by search over r."""

    id = "sample-stop"
    title = "spring & <stop>"
    summary = "one spring and one stop operator"
    source = "this file"

    def __init__(self, candidates=20):
        self.candidates = candidates

    def _identify(self, runs):
        best = None
        for r in np.linspace(0.02, 0.5, self.candidates) * max(np.ptp(run.x) for run in runs):
            design = np.concatenate([np.column_stack([run.x, _stop(run.x, r)]) for run in runs])
            target = np.concatenate([run.y for run in runs])
            weights, *_ = np.linalg.lstsq(design, target)
            error = np.sum((design @ weights - target) ** 2)
            if best is None or error < best[0]:
                best = error, weights, r
        return {"spring": best[1][0], "stop": best[1][1], "threshold": best[2]}

    @classmethod
    def _check_parameters(cls, spring, stop, threshold):
        return {"spring": float(spring), "stop": float(stop), "threshold": float(threshold)}

    def _predict_run(self, x):
        p = self.parameters_
        return p["spring"] * x + p["stop"] * _stop(x, p["threshold"])

    def stepper(self):
        return StopStepper(**self.parameters_)


class StopStepper(Stepper):
    """The same, sample by sample: for real-time use and for the inverse by search."""

    def __init__(self, spring, stop, threshold):
        self.spring, self.stop, self.threshold = spring, stop, threshold
        self.reset()

    def reset(self):
        self.state = self.last = 0.0

    def _moved(self, x):
        return min(max(self.state + x - self.last, -self.threshold), self.threshold)

    def peek(self, x):
        return self.spring * x + self.stop * self._moved(x)

    def step(self, x):
        self.state, self.last = self._moved(x), x
        return self.spring * x + self.stop * self.state


def _stop(x, threshold):
    out = np.empty_like(x)
    state = last = 0.0
    for k, value in enumerate(x):
        state = min(max(state + value - last, -threshold), threshold)
        last = value
        out[k] = state
    return out


class Duck:
    """Neither base class nor inverse nor stepper: a straight line."""

    def fit(self, x, y, groups=None):
        self.line_ = np.polyfit(x, y, 1)
        return self

    def predict(self, x, groups=None):
        return np.polyval(self.line_, x)
