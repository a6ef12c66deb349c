"""The functions of a python-control system with their parameters by number, so that they can be compiled.

    params["m"], params.get("m", 1600.0)     becomes     params[3]

The source of the functions is read and changed; what cannot be put so says why (``NotReadable``).
"""

import ast
import dis
import inspect
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import CodeType, FunctionType

import control as ct
import numpy as np
from stickslip.blocks.kernels import Function


class NotReadable(Exception):
    """The functions of a system cannot be put into a form that can be compiled; the text says why."""


@dataclass(frozen=True)
class Compilable:
    """A system's functions with ``params`` as a tuple, and the parameters in its order."""

    update: Function | None
    output: Function | None
    params: dict[str, float]


def is_number(value: object) -> bool:
    """Return whether a value is a finite number, as parameters of blocks are."""
    return isinstance(value, int | float | np.integer | np.floating) and math.isfinite(value)


def mentions(function: FunctionType, position: int) -> bool:
    """Return whether a function looks at its argument at ``position``; one it cannot be asked about counts as yes."""
    if function.__code__.co_argcount <= position:
        return True
    name = function.__code__.co_varnames[position]
    for step in dis.get_instructions(function):
        names = step.argval if isinstance(step.argval, tuple) else (step.argval,)
        if step.opname.startswith(("LOAD", "MAKE_CELL")) and name in names:
            return True
    return False


def compilable(system: ct.NonlinearIOSystem, params: Mapping[str, float]) -> Compilable:
    """Return a system's functions with ``params``, and what they have defaults for, by number.

    Raises ``NotReadable`` where that cannot be.
    """
    if isinstance(system, ct.InterconnectedSystem):
        raise NotReadable("an interconnected system is evaluated by python-control; wire its parts instead")
    if type(system) is not ct.NonlinearIOSystem:
        raise NotReadable(f"a {type(system).__name__} is evaluated by its own class")
    found = dict(params)
    n = system.nstates or 0
    update = _with_tuple(system.updfcn, found) if n else None
    output = None if system.outfcn is None else _with_tuple(system.outfcn, found)
    return Compilable(update, output, found)


def _with_tuple(function: Function, params: dict[str, float]) -> Function:
    """Return the function with ``params["m"]`` read from a tuple by number; add what it has defaults for."""
    if not isinstance(function, FunctionType) or function.__code__.co_argcount != 4:
        raise NotReadable("its functions are not plain functions of (t, x, u, params)")
    if not mentions(function, 3):
        return function
    made = _source(function)
    _Params(function.__code__.co_varnames[3], params).visit(made)
    code = _compiled_code(made, function.__code__.co_freevars)
    cells = dict(zip(function.__code__.co_freevars, function.__closure__ or (), strict=True))
    around = tuple(cells[name] for name in code.co_freevars)  # what it reaches is looked up where the function does
    return FunctionType(code, function.__globals__, function.__name__, function.__defaults__, around)


def _compiled_code(made: ast.FunctionDef | ast.Lambda, around: Sequence[str]) -> CodeType:
    """Return the code of a function that stands inside another, with the variables of that one around it."""
    body: list[ast.stmt] = [made] if isinstance(made, ast.FunctionDef) else [ast.Expr(made)]
    shell = ast.parse(f"def around({', '.join(around)}): pass")
    shell.body[0].body = body  # type: ignore[attr-defined]
    code = compile(ast.fix_missing_locations(shell), "<parameters by number>", "exec")
    for _ in range(2):
        code = next(const for const in code.co_consts if isinstance(const, CodeType))
    return code


def _source(function: FunctionType) -> ast.FunctionDef | ast.Lambda:
    """Return the source of a plain function or of a lambda."""
    code = function.__code__
    try:
        tree = ast.parse("".join(inspect.findsource(function)[0]))
    except (OSError, SyntaxError):
        raise NotReadable("the source of its functions cannot be read") from None
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef | ast.Lambda) and node.lineno == code.co_firstlineno:
            if isinstance(node, ast.FunctionDef):
                if node.name == function.__name__ and not node.decorator_list:
                    return node
            elif _code(node) == (code.co_code, code.co_names, code.co_freevars):
                return node
    raise NotReadable("the source of its functions cannot be found, or has decorators")


def _code(node: ast.Lambda) -> tuple[object, ...]:
    """Return what tells one lambda of a line from another."""
    module = compile(ast.Expression(node), "<lambda>", "eval")
    code = next(constant for constant in module.co_consts if isinstance(constant, CodeType))
    return code.co_code, code.co_names, code.co_freevars


class _Params(ast.NodeTransformer):
    """Puts ``params[3]`` for ``params["m"]`` and for ``params.get("m", default)``."""

    def __init__(self, name: str, params: dict[str, float]) -> None:
        self.name, self.params = name, params

    def _numbered(self, key: object) -> ast.AST:
        if key not in self.params:
            raise NotReadable(f"its functions read params[{key!r}], which is not a number")
        index = ast.Constant(list(self.params).index(str(key)))
        return ast.Subscript(ast.Name(self.name, ast.Load()), index, ast.Load())

    def visit_Subscript(self, node: ast.Subscript) -> ast.AST:
        if isinstance(node.value, ast.Name) and node.value.id == self.name and isinstance(node.slice, ast.Constant):
            return self._numbered(node.slice.value)
        return self.generic_visit(node)

    def visit_Call(self, node: ast.Call) -> ast.AST:
        called, first = node.func, node.args[0] if node.args else None
        get = isinstance(called, ast.Attribute) and called.attr == "get"
        if not (get and ast.unparse(called) == f"{self.name}.get" and isinstance(first, ast.Constant)):
            return self.generic_visit(node)
        key = first.value
        if key not in self.params:
            try:
                default = ast.literal_eval(node.args[1])
            except (ValueError, IndexError):
                raise NotReadable(f"params.get({key!r}) has no constant default") from None
            if not is_number(default):
                raise NotReadable(f"the default of params.get({key!r}) is not a number")
            self.params[str(key)] = float(default)
        return self._numbered(key)

    def visit_Name(self, node: ast.Name) -> ast.AST:
        if node.id == self.name:
            raise NotReadable("its functions hand params on as a whole")
        return node
