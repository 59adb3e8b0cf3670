"""
Sample by sample
================

In a control loop a model gets one sample at a time. A stepper equals ``predict`` to the last bit of its kernel, and its
``peek`` answers "what if" without moving.
"""

import matplotlib.pyplot as plt
import numpy as np

from hystbench import models

model = models.get("prandtl-ishlinskii").from_parameters(weights=[1.0, -0.3, -0.2], thresholds=[0.0, 0.1, 0.3])
x = np.sin(np.linspace(0.0, 6.0 * np.pi, 600)) * np.linspace(1.0, 0.2, 600)
stepper = model.stepper()
stepped = np.array([stepper.step(value) for value in x])
assert np.array_equal(stepped, model.predict(x))
ahead = [stepper.peek(float(value)) for value in np.linspace(-1.0, 1.0, 50)]

fig, axis = plt.subplots(figsize=(5, 3.6), layout="constrained")
axis.plot(x, stepped, linewidth=0.9, label="stepped")
axis.plot(np.linspace(-1.0, 1.0, 50), ahead, "--", color="0.4", linewidth=0.9, label="peek from the last sample")
axis.set(xlabel="x", ylabel="y")
axis.legend(frameon=False)
plt.show()
