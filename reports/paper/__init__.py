"""The two source papers, regenerated and audited: ``hystbench paper``."""
