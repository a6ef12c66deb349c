"""The ``stickslip`` command: demonstrations, simulations and verdicts from the shell.

The work is done by the packages beside this one: ``blocks``, ``plant``, ``detect``, ``logs``, ``cases``.
"""

__version__ = "0.1.0"
