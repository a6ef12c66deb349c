"""The compiled simulator: arrays and kernel addresses, no names."""

import stickslip.logs.compiled  # noqa: F401  (it chooses where compiled code is kept)
