"""Settings of tests with random examples."""

import os
from functools import partial

from hypothesis import settings

# A slow machine makes no test fail.  CI uses the same examples in every run, so that only a change of the code can.
examples = partial(settings, deadline=None, derandomize=bool(os.environ.get("CI")))
