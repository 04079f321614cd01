"""Settings for all tests."""

import os

from hypothesis import settings

# CI uses the same examples in every run, so that only a change of the code can make it fail.
settings.register_profile("ci", derandomize=True)
if os.environ.get("CI"):
    settings.load_profile("ci")
