import pytest

from armour.sweeps.plan import duration


@pytest.mark.parametrize(
    ("seconds", "words"),
    [
        (0.2, "1 second"),
        (119.0, "119 seconds"),
        (121.0, "2 minutes"),
        (7201.0, "2 hours"),
        (400000.0, "5 days"),
        (3e10, "951 years"),
    ],
)
def test_lengths_of_time_in_words(seconds: float, words: str):
    assert duration(seconds) == words
