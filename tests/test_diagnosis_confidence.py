"""What is stated of a verdict beside what was thought of it while it was chosen."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from hystbench.diagnosis.verdict.calibration import stated

probabilities = st.floats(0.0, 1.0)


@given(probabilities, probabilities)
def test_the_likelier_verdict_is_never_stated_with_less(one: float, other: float) -> None:
    assert (stated(one) <= stated(other)) == (np.clip(one, 0.02, 0.995) <= np.clip(other, 0.02, 0.995)) or stated(
        one
    ) == stated(other)


@given(probabilities)
def test_neither_certainty_nor_impossibility_is_stated(probability: float) -> None:
    assert 0.02 <= stated(probability) <= 0.995


def test_a_doubtful_verdict_is_right_more_often_than_it_says_and_a_sure_one_is_not() -> None:
    assert stated(0.55) > 0.58
    assert abs(stated(0.97) - 0.97) < 0.01
