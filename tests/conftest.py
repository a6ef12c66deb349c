"""How tests run: one thread of linear algebra a worker, random examples alike in continuous integration, no clock.

The threads of small matrix products cost more than they save, and the workers take all cores already.
"""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # read when numpy is first imported

from hypothesis import settings

settings.register_profile("stickslip", deadline=None, derandomize=bool(os.environ.get("CI")))
settings.load_profile("stickslip")
