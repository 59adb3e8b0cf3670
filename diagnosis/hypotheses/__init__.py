"""Sets of effects as explanations of a gap: how they are fitted, searched, and judged on samples that no fit saw."""
