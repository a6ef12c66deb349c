"""A nonlinear system of python-control (``ct.nlsys``, ``ct.interconnect``) as a block.

    dx/dt = f(t, x, u)   y = h(t, x, u)          continuous (dt = 0 or None)
    x_(k+1) = f(...)     y_k = h(...)            sampled every dt [s], y held until t_(k+1)

The ports, the states and the name are those of the system; its numeric ``params`` are parameters of the block.  So are
the constant defaults of ``params.get("m", 1600.0)`` where the functions are compiled.

The functions are compiled where that is possible: if they use numbers, arrays, ``math`` and ``numpy``, and read
``params`` only as ``params["m"]`` or ``params.get("m", ...)``.  If not, and always for ``ct.interconnect``, the engine
calls them in Python, and ``run.in_python`` says how often, for how long and why.

Functions that read ``t`` are tried before a run, and bound its steps (see equations).

An output counts as following the inputs at once if ``h`` mentions them, and in ``ct.interconnect`` those that reach
it.  The states start at 0 unless ``start={"name.state": ...}`` says otherwise.  See also: equations (the same without
python-control).
"""

import math
import threading
from collections.abc import Mapping
from types import FunctionType
from typing import Any

import control as ct
import numpy as np
from stickslip.blocks.block import Block, Kernel, Kernels
from stickslip.blocks.kernel_source import generated
from stickslip.blocks.kernels import Function, fed_by
from stickslip.blocks.parameters_by_number import Compilable, NotReadable, compilable, is_number, mentions
from stickslip.blocks.ports import BlockError, Port, require
from stickslip.blocks.role import Role

UPDATE, OUTPUT = "the update function", "the output function"


class NonlinearSystem(Block):
    """A nonlinear python-control system as a block; ``wire`` makes one of every such system it is given.

    Raises ``BlockError`` for an unspecified sampling period (dt = True), or a function that returns another number of
    values than there are states or outputs.

    >>> import control as ct
    >>> from stickslip.diagram import drive
    >>> tank = ct.nlsys(
    ...     lambda t, x, u, params: u - 0.5 * np.sqrt(x), None, inputs=["q"], outputs=["h"], states=["h"], name="tank"
    ... )
    >>> drive(NonlinearSystem(tank), 1000.0, every=500.0, q=1.0).log["h"].round(3).tolist()  # (1 / 0.5)^2
    [0.0, 4.0, 4.0]
    """

    role = Role.PROCESS

    def __init__(self, system: ct.NonlinearIOSystem) -> None:
        name, n = system.name, system.nstates or 0
        dt = sampling_period(system)
        self.ports_in = tuple(Port(label) for label in system.input_labels)
        self.ports_out = tuple(Port(label) for label in system.output_labels)
        params = {key: float(value) for key, value in system.params.items() if is_number(value)}
        follows = _follows(system)
        try:
            readable = compilable(system, params)
            params = readable.params
            der, out, step = _compiled_kernels(system, readable, follows)
        except NotReadable as reason:
            der, out, step = _python_kernels(system, tuple(params), str(reason), follows)
        if not self.ports_in and not n:
            self.role = Role.SOURCE
        names = system.state_labels[:n]
        params["dt"] = dt
        states = dict.fromkeys(names, 0.0)
        if dt:
            self.period_param = "dt"
            self.kernels = Kernels(step=step, feeds=any(follows))
            super().__init__(name=name, params=params, memory=states, **_labels(system))
        else:
            self.kernels = Kernels(der=der if n else None, out=out, feeds=fed_by(follows), timed=_timed(system))
            super().__init__(name=name, params=params, states=states, **_labels(system))

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` for a negative sampling period."""
        require(params["dt"] >= 0.0, name, "dt", params["dt"], "a sampling period is not negative", "give seconds")


def sampling_period(system: ct.InputOutputSystem) -> float:
    """Return the sampling period of a python-control system [s], 0 for a continuous one."""
    if system.dt is True:
        raise BlockError(
            f"{system.name}: dt = True, a sampling period without a number, but a diagram runs in seconds; "
            "give dt= in seconds"
        )
    return float(system.dt or 0.0)


def _refuse_other(name: str, what: str, given: int, needed: int) -> None:
    """Raise ``BlockError`` unless a function of the system ``name`` gives as many values as are needed."""
    if given != needed:
        each = "state" if what == UPDATE else "output"
        values, are = "value" if given == 1 else "values", "is" if needed == 1 else "are"
        raise BlockError(
            f"{name}: {what} returns {given} {values}, but {needed} {are} needed; return one value per {each}"
        )


def _labels(system: ct.InputOutputSystem) -> dict[str, Any]:
    return {"inputs": list(system.input_labels), "outputs": list(system.output_labels)}


# --- does the output follow the inputs at once? ----------------------------------------------------------------


def _follows(system: ct.InputOutputSystem) -> list[bool]:
    """Return for each input whether an output follows it at once."""
    n = system.ninputs or 0
    if isinstance(system, Block):
        return system.kernels.follows(n)
    if isinstance(system, ct.StateSpace):
        return [bool(column.any()) for column in system.D.T]
    if isinstance(system, ct.InterconnectedSystem):
        return _pass_through(system)
    function = system.outfcn
    return [function is not None and (not isinstance(function, FunctionType) or mentions(function, 2))] * n


def _timed(system: ct.NonlinearIOSystem) -> bool:
    """Return whether rates or outputs look at the time; those of an interconnection, or of a class, may."""
    functions = (system.updfcn, system.outfcn)
    return any(f is not None and (not isinstance(f, FunctionType) or mentions(f, 0)) for f in functions)


def _pass_through(system: ct.InterconnectedSystem) -> list[bool]:
    """Return for each input whether a way leads to an output through subsystems that all pass on at once."""
    outputs = [k for k, part in enumerate(system.syslist) for _ in range(part.noutputs)]
    inputs = [k for k, part in enumerate(system.syslist) for _ in range(part.ninputs)]
    passing = np.array([follows for part in system.syslist for follows in _follows(part)], dtype=bool)
    within = np.equal.outer(outputs, inputs) & passing  # [output, input] of one subsystem
    step = (np.asarray(system.connect_map) != 0.0) @ within  # [input, input]: one leads to the other at once
    reached = np.asarray(system.input_map) != 0.0
    for _ in inputs:
        reached = reached | (step.astype(int) @ reached > 0)
    shown = np.vstack([within.astype(int) @ reached > 0, reached])  # an output may be a subsystem's input
    return [bool(one) for one in ((np.asarray(system.output_map) != 0.0).astype(int) @ shown > 0).any(axis=0)]


# --- compiled -------------------------------------------------------------------------------------------------


def _compiled_kernels(
    system: ct.NonlinearIOSystem, made: Compilable, follows: list[bool]
) -> tuple[Kernel | None, Kernel, Kernel]:
    n, m, q = system.nstates or 0, system.ninputs, system.noutputs
    params = f"({''.join(f'p[{i}], ' for i in range(len(made.params)))})" if made.params else "(0.0,)"
    values = tuple(made.params.values()) or (0.0,)
    take_u = [f"U = np.empty({m})", *(f"U[{j}] = u[{j}]" for j in range(m))]
    seen = (f"U[{j}] = u[{j}]" for j in range(m) if follows[j])
    take_seen = [f"U = np.zeros({m})", *seen]  # by the outputs

    def take_x(array: str) -> list[str]:
        return [f"X = np.empty({n})", *(f"X[{i}] = {array}[{i}]" for i in range(n))]

    def put(function: Function, what: str, count: int, array: str, result: str) -> list[str]:
        shape = _shape(function, n, m, values)
        _refuse_other(system.name, what, math.prod(shape), count)
        if shape == () and count == 1:
            return [f"{array}[0] = {result}"]
        if shape != (count,):
            raise NotReadable(f"its functions return an array of shape {shape}, not ({count},)")
        return [f"{array}[{i}] = {result}[{i}]" for i in range(count)]

    f, h = made.update, made.output
    if h is None:
        out_lines = [f"out[{i}] = x[{i}]" for i in range(q)]
        out = generated(out_lines)
        given = [line.replace("= x[", "= d[") for line in out_lines]
    else:
        ask = f"y = function(t, X, U, {params})"
        out = generated([*take_x("x"), *take_seen, ask, *put(h, OUTPUT, q, "out", "y")], h)
        given = [ask.replace("function", "output"), *put(h, OUTPUT, q, "out", "y")]
    if f is None:
        return None, out, generated([*take_x("d"), *take_u, *given], output=h)
    ask = f"r = function(t, X, U, {params})"
    der = generated([*take_x("x"), *take_u, ask, *put(f, UPDATE, n, "out", "r")], f)
    step = generated([*take_x("d"), *take_u, *given, ask, *put(f, UPDATE, n, "d", "r")], f, output=h)
    return der, out, step


def _shape(function: Function, n: int, m: int, params: tuple[float, ...]) -> tuple[int, ...]:
    """Return the shape of what a function returns, tried at zeros and at ones."""
    for value in (0.0, 1.0):
        try:
            with np.errstate(all="ignore"):
                return np.shape(function(0.0, np.full(n, value), np.full(m, value), params))
        except Exception as error:
            reason = error
    raise NotReadable(f"its functions cannot be tried at zeros or ones: {reason}")


# --- called in Python -----------------------------------------------------------------------------------------


def _python_kernels(
    system: ct.NonlinearIOSystem, names: tuple[str, ...], reason: str, follows: list[bool]
) -> tuple[Kernel, Kernel, Kernel]:
    n, m, q = system.nstates or 0, system.ninputs, system.noutputs
    lock = threading.Lock()  # a system keeps the parameters of its last call
    whole = {key for key in names if isinstance(system.params.get(key), int | np.integer)}

    def given_as(key: str, value: float) -> float:
        return int(value) if key in whole and value.is_integer() else value

    def ask(what: str, count: int, t: float, x: Any, u: Any, p: Any) -> list[float]:
        params = {**system.params, **{key: given_as(key, float(p[i])) for i, key in enumerate(names)}}
        state, given = np.array([x[i] for i in range(n)]), np.array([u[j] for j in range(m)])
        try:
            with lock:
                function = system.dynamics if what == UPDATE else system.output
                values = np.asarray(function(t, state, given, params=params), dtype=float).reshape(-1)
        except Exception as error:
            broken = [f"{key} = {params[key]!r}" for key in whole if isinstance(params[key], float)]
            remedy = (
                f": {', '.join(broken)}, but the system has an integer there; give a whole number" if broken else ""
            )
            error.add_note(f"in a function of '{system.name}'{remedy}")
            raise
        _refuse_other(system.name, what, len(values), count)
        return values.tolist()

    def der(t: float, x: Any, d: Any, u: Any, p: Any, out: Any) -> None:
        for i, rate in enumerate(ask(UPDATE, n, t, x, u, p)):
            out[i] = rate

    def outputs(t: float, x: Any, d: Any, u: Any, p: Any, out: Any) -> None:
        for i, value in enumerate(ask(OUTPUT, q, t, x, [u[j] if yes else 0.0 for j, yes in enumerate(follows)], p)):
            out[i] = value

    def step(t: float, x: Any, d: Any, u: Any, p: Any, out: Any) -> None:
        outputs(t, d, d, u, p, out)
        for i, value in enumerate(ask(UPDATE, n, t, d, u, p) if n else ()):
            d[i] = value

    for kernel in (der, outputs, step):
        kernel.may_run_in_python = reason  # type: ignore[attr-defined]
    return der, outputs, step
