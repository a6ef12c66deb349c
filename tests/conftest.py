"""How random tests are drawn: the same examples every time in continuous integration, and no clock in judgement."""

import os

from hypothesis import settings

settings.register_profile("stickslip", deadline=None, derandomize=bool(os.environ.get("CI")))
settings.load_profile("stickslip")
