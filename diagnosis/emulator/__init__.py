"""The simulator as the diagnosis knows it: models of it that are identified from its output."""
