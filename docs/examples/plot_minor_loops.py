"""
Who remembers minor loops?
==========================

A model without memory cannot follow loops within the loop. The test motion shrinks step by step.
"""

import matplotlib.pyplot as plt

from hystbench import datasets, models
from hystbench.bench.metrics import score
from hystbench.datasets import concatenate

data = datasets.get("vsa-minor-loops")().load()
x, y, groups = concatenate(data.train)
test = data.test[0]
names = ("cubic", "bouc-wen", "preisach", "maxwell-slip")
fig, axes = plt.subplots(1, len(names), figsize=(11, 3), sharey=True, layout="constrained")
for axis, name in zip(axes, names, strict=True):
    model = models.get(name)().fit(x, y, groups=groups)
    predicted = model.predict(test.x)
    error = score(test.y[test.warm_up :], predicted[test.warm_up :])["nrmse"]
    axis.plot(test.x, predicted - test.y, linewidth=0.7)
    axis.set(title=f"{name}\nNRMSE {error:.2%}", xlabel="deflection, rad")
axes[0].set_ylabel("error, N·m")
plt.show()
