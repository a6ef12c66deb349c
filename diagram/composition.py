"""Compose: join blocks, diagrams and python-control systems by signal name."""

from collections.abc import Iterable, Sequence

import control as ct
from stickslip.blocks.block import Block
from stickslip.blocks.control_system import as_block
from stickslip.diagram.changes import listed
from stickslip.diagram.diagram import Diagram
from stickslip.diagram.past import Past, together
from stickslip.diagram.wired import UNNAMED
from stickslip.diagram.wiring import check_sources


def wire(
    items: Iterable[Block | Diagram | ct.InputOutputSystem],
    inputs: Sequence[str] = (),
    outputs: Sequence[str] | None = None,
    name: str = UNNAMED,
) -> Diagram:
    """Join blocks, diagrams and python-control systems by signal name into one diagram.

    A signal is driven by exactly one output label and read by every input with the same label.  A nested diagram
    ``loop`` shows its signals as ``loop/PV`` and reads its open inputs by name.

    Parameters: ``items`` blocks, diagrams and systems of python-control (``ct.tf``, ``ct.zpk``, ``ct.ss``,
    ``ct.nlsys``, continuous or sampled, see ``stickslip.blocks.control_system``), whose ports are called by their
    labels; ``inputs`` signals left open on purpose; ``outputs`` the outputs of the python-control system (default:
    all).

    Raises ``WiringError`` for unknown, dangling, doubly driven or unit-mismatched signals and algebraic loops,
    ``BlockError`` for what is no such item, or a system that cannot be simulated (improper, dt = True).

    >>> from stickslip.blocks import PI, FirstOrder, Step
    >>> loop = wire([Step("SP", 0.5), PI(K_p=0.4, T_i=10.0, outputs="MV"), FirstOrder(K=3.0, tau=10.0)])
    >>> loop.signals
    ('SP', 'MV', 'PV')
    """
    leaves: list[Block] = []
    named: list[Block] = []  # by the caller, one by one: here a signal that nobody reads is a slip of the pen
    pasts: list[Past] = []
    for item in listed(items):
        if isinstance(item, Diagram):
            leaves += item.leaves()
            pasts += [item.past.inside(item.name)] if item.past is not None else []
        else:
            named.append(as_block(item))
            leaves.append(named[-1])
    diagram = Diagram(leaves, inputs, outputs, name)
    check_sources(named, diagram.blocks, diagram.declared_outputs or ())
    return diagram.with_past(together(pasts))
