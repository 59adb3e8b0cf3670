"""Effects that can explain a gap, one file each; third parties add theirs through ``hystbench.effects``."""

from .base import Effect, Form, Parameter, Scene

__all__ = ["Effect", "Form", "Parameter", "Scene"]
