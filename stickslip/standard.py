"""Notice when a file of the user's, such as ``random.py`` or ``json.py``, hides a module of Python's own.

Asked after something has failed, and with ``os`` and ``sys`` only, which no file can hide: many such names do no harm.
"""

import os
import sys


def hidden() -> str | None:
    """Return a message naming such files in the present folder, or None if there are none that Python would find.

    >>> hidden() is None
    True
    """
    here = os.getcwd()
    if here not in sys.path and "" not in sys.path:
        return None
    found = []
    for entry in sorted(os.listdir(here)):
        name, ending = os.path.splitext(entry)
        package = os.path.isfile(os.path.join(here, entry, "__init__.py"))
        if name in sys.stdlib_module_names and name not in sys.builtin_module_names and (ending == ".py" or package):
            found.append(os.path.join(here, entry))
    if not found:
        return None
    return (
        f"{', '.join(repr(path) for path in found)} may hide what Python itself needs; rename it, "
        "or run stickslip from another folder"
    )
