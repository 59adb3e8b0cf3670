"""Runs: conditions, cells, metrics, timing, results and the command line."""
