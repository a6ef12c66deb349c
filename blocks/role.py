"""The role of a block in a loop.  Each block declares one; pictures, linearisation and studies use it.

    source       gives a signal that stands or follows a plan: a set point, a feed, a pressure outside
    disturbance  gives a signal that nobody asked for: noise, slugs
    controller   drives OP from SP and PV               valve      moves MV after OP: a stem, or the flow
    process      what is controlled: vessels, pipes, machines, valve bodies, and any system that says no more
    sensor       measures                               filter     takes noise out of a measured signal
    detector     judges measured signals                historian  keeps them as a plant's archive does
    arithmetic   adds, scales or limits signals

Which port plays which part (SP, PV, OP, MV) is the other half of it: see ``Block.loop_signal``.
"""

from enum import StrEnum


class Role(StrEnum):
    """The role of a block; ``Role("valve") is Role.VALVE``, and it is its own word.

    >>> print(Role.VALVE, Role("valve") is Role.VALVE)
    valve True
    """

    SOURCE = "source"
    DISTURBANCE = "disturbance"
    CONTROLLER = "controller"
    VALVE = "valve"
    PROCESS = "process"
    SENSOR = "sensor"
    HISTORIAN = "historian"
    FILTER = "filter"
    DETECTOR = "detector"
    ARITHMETIC = "arithmetic"

    @property
    def drives(self) -> bool:
        """Whether such a block gives a signal from outside the loop: a source or a disturbance."""
        return self in (Role.SOURCE, Role.DISTURBANCE)
