"""What a verdict may name besides effects, and the effect that is hard to tell from it."""

__all__ = ["GAIN", "MISCALIBRATION", "UNKNOWN"]

MISCALIBRATION, UNKNOWN = "miscalibration", "unknown"
GAIN = "torque_gain"
