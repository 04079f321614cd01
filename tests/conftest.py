"""Settings for all tests."""

import os

from hypothesis import settings

# In CI the same examples every time: a run that fails must be one that the change made fail.
settings.register_profile("ci", derandomize=True)
if os.environ.get("CI"):
    settings.load_profile("ci")
