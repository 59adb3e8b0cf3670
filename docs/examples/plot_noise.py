"""
What a filter does to reversals
===============================

Noise makes a slowly moving input turn at almost every sample. Models with memory see each turn.
"""

import matplotlib.pyplot as plt

from hystbench import datasets
from hystbench.bench.conditions import apply

data = datasets.get("vsa-published")().load()
fig, axis = plt.subplots(figsize=(7, 3), layout="constrained")
for condition in ("noisy", "kalman", "smoothed"):
    seen = apply(data, condition, seed=0)
    told = f"{condition}: {seen.filter['false_reversals']:.0f} false reversals"
    axis.plot(seen.test[0].time[280:330], seen.test[0].x[280:330], linewidth=0.9, label=told)
axis.plot(data.test[0].time[280:330], data.test[0].x[280:330], color="0.4", linewidth=0.6, label="truth")
axis.set(xlabel="time, s", ylabel="deflection, rad")
axis.legend(frameon=False)
plt.show()
