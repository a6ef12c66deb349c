"""Load compiled code without waking the compiler.

Before it loads anything numba reads in all that it would need to compile something: about a hundred modules, half of
what a short simulation costs.  Code that is ready needs numba's runtime only; what has to be compiled wakes the
compiler itself.
"""

from typing import Any

from numba.core.caching import FunctionCache
from numba.core.runtime import rtsys


class ReadyCache(FunctionCache):  # type: ignore[misc]
    """Numba's cache of one function, loading what is there as it is."""

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Return the compiled function of a signature, or None if it is not there."""
        rtsys.initialize(target_context)
        with self._guard_against_spurious_io_errors():
            return self._load_overload(sig, target_context)
