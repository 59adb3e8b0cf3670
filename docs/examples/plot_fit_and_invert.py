"""
Fit, predict, invert
====================

A loop that never closes exactly because of sensor noise, the model that an identification makes of it, and the deflection
that the model asks for to get a wanted torque.
"""

import matplotlib.pyplot as plt
import numpy as np

from hystbench import datasets, models
from hystbench.bench.conditions import apply
from hystbench.datasets import concatenate

data = datasets.get("vsa-published")().load()
seen = apply(data, "kalman", seed=0)
x, y, groups = concatenate(seen.train)
model = models.get("maxwell-slip")().fit(x, y, groups=groups)

# %%
# The fit says what it found out about itself.

for condition in model.conditions_:
    print("holds   " if condition.holds else "VIOLATED", condition.name, "|", condition.detail)
print(*model.notes_, sep="\n")

# %%
# Prediction against the plant's true torque.

test = data.test[0]
fig, (left, right) = plt.subplots(1, 2, figsize=(9, 3.6), layout="constrained")
left.plot(x, y, color="0.7", linewidth=2, label="filtered recording")
left.plot(test.x, model.predict(test.x), linewidth=0.9, label="model")
left.set(xlabel="deflection, rad", ylabel="torque, N·m")
left.legend(frameon=False)

# %%
# The inverse: which deflection gives a sinusoidal torque of 4 N·m? Driving the plant with it shows what is left.

time = np.arange(1200) / 100.0
wanted = 4.0 * np.sin(2.0 * np.pi * 0.25 * time)
deflection = model.invert(wanted)
right.plot(time, data.plant(time, deflection) - wanted, linewidth=0.9)
right.set(xlabel="time, s", ylabel="torque error after compensation, N·m")
plt.show()
