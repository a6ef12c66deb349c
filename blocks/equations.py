"""A block from one or two plain Python functions, whose arguments are read by name.

    dx/dt = der(...)          y = out(...)

Every argument of ``der`` and ``out`` is the name of a state, an input, a parameter, or ``t``, the time [s]; an argument
with a default is a parameter.  ``der`` returns one rate per state, ``out`` one value per output, as a number or as a
tuple.  Without ``out`` the outputs are states.  The outputs follow at once the inputs that ``out`` takes, and no
others: an integral that tracks what a selector behind the block lets through makes no algebraic loop.

The functions are compiled for the engine and may use numbers, ``math``, ``numpy`` and other such functions; what they
reach outside, such as numbers, arrays and helpers, is taken as it is when a run begins.  A function that cannot be
compiled is called in Python instead, and ``run.in_python`` says how often, for how long and why.

Where ``out`` or ``der`` take ``t``, a run tries them at 256 instants before it begins, bounds its steps by how fast
they change, and says so in ``run.notes``.  What lasts less than a 256th of the run needs ``max_step=`` [s].

Every value is a float: write ``int(n)`` where a whole number is needed.  A block of equations has no dead time of its
own: wire a ``DeadTime`` in front of the input that is late.  It counts as a process; ``with_role`` makes a controller,
a valve or a sensor of it and says which port is SP, PV, OP or MV, as pictures and ``gap`` want to know.

Valid for equations that do not switch; not for events (subclass ``Block`` with ``zc`` and ``jump`` for those).
See also: sampled_function (a function called every dt), state_space, transfer_function.
"""

from collections.abc import Mapping, Sequence

from stickslip.blocks.block import Block, Kernels
from stickslip.blocks.kernel_source import arguments, called, copied, generated, names, where, with_defaults
from stickslip.blocks.kernels import Function, fed_by
from stickslip.blocks.ports import BlockError, Port, nearest
from stickslip.blocks.role import Role


class Equations(Block):
    """A continuous block from the functions ``der`` and ``out``; see the module docstring.

    ``states`` maps each state to its start value, ``params`` each parameter to its value; ``inputs`` and ``outputs``
    are the names of the ports, and the signals unless ``labels`` says otherwise (``labels={"h": "level"}``).

    Raises ``BlockError`` for an argument that is none of these names, a name used twice, or a function that returns
    another number of values than there are states or outputs.

    >>> from stickslip.diagram import drive
    >>> lag = Equations(
    ...     "lag", der=lambda PV, MV, K, tau: (K * MV - PV) / tau,
    ...     states={"PV": 0.0}, inputs=["MV"], params={"K": 3.0, "tau": 10.0},
    ... )
    >>> drive(lag, 20.0, every=10.0, MV=1.0).log["PV"].round(4).tolist()  # 3 (1 - exp(-t/10))
    [0.0, 1.8964, 2.594]
    """

    role = Role.PROCESS

    def __init__(
        self,
        name: str,
        *,
        der: Function | None = None,
        out: Function | None = None,
        states: Mapping[str, float] | None = None,
        inputs: str | Sequence[str] = (),
        outputs: str | Sequence[str] | None = None,
        params: Mapping[str, float] | None = None,
        labels: Mapping[str, str] | None = None,
        units: Mapping[str, str] | None = None,
    ) -> None:
        if not isinstance(states, Mapping | None):
            raise BlockError(
                f"{name}: states = {states!r}, but each needs its start value; give {{'{names(states)[0]}': 0.0}}"
            )
        states = dict(states or {})
        ins = names(inputs)
        outs = names(outputs) if outputs is not None else tuple(states)
        given = with_defaults(name, (der, out), params, {*states, *ins, "t"})
        places = where(name, {"x": states, "u": ins, "p": given})
        if (der is None) != (not states):
            raise BlockError(f"{name}: der gives the rates of the states; give both der= and states=, or neither")
        if not outs or (out is None and not set(outs) <= set(states)):
            raise BlockError(f"{name}: outputs = {list(outs)!r} are not all states; give out= for them")
        values = {**states, **given, **dict.fromkeys((*ins, "t"), 0.0)}
        self.ports_in, self.ports_out = tuple(map(Port, ins)), tuple(map(Port, outs))
        rates, given_out = [f"out[{i}]" for i in range(len(states))], [f"out[{i}]" for i in range(len(outs))]
        puts = copied(places, outs) if out is None else called(name, "out", out, places, values, given_out)
        self.kernels = Kernels(
            der=None if der is None else generated(called(name, "der", der, places, values, rates), der),
            out=generated(puts, out),
            feeds=out is not None and fed_by(key in arguments(name, "out", out) for key in ins),
            timed=any(f is not None and "t" in arguments(name, what, f) for what, f in (("der", der), ("out", out))),
        )
        if not ins and not states:
            self.role = Role.SOURCE
        signals = dict(labels or {})
        for key in signals:
            if key not in (*ins, *outs):
                raise BlockError(f"block '{name}' has no port '{key}'; {nearest(key, [*ins, *outs])}")
        super().__init__(
            name=name, params=given, states=states, inputs=[signals.get(key, key) for key in ins],
            outputs=[signals.get(key, key) for key in outs], units=units,
        )  # fmt: skip
