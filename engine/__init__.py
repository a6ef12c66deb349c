"""The compiled simulator: arrays and kernel addresses, no names."""

import logs.compiled  # noqa: F401  (it chooses where compiled code is kept)
