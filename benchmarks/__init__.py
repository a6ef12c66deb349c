"""What the house is worth, measured: speed beside peers, detection, the gap; each part is run by itself."""

import os

from stickslip.__main__ import LINEAR_ALGEBRA

for name in LINEAR_ALGEBRA:  # as the command line does, and before numpy is first imported
    os.environ.setdefault(name, "1")
