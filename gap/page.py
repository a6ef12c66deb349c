"""The page of all effects, for the site: ``python -m stickslip.gap.page`` prints it."""

import inspect
import math
import sys

from stickslip.gap.effects import CATALOGUE
from stickslip.gap.insertion.effect import Effect, Parameter

HEAD = """# The effects

These are the effects that a model of a plant may lack.  Each effect is one file in ``gap/effects``.  One call inserts
it into any diagram, at a block of its role.  At its neutral values it changes nothing.
``python -m stickslip.gap.page`` prints this page.

```python
import numpy as np

from stickslip.cases.models import ideal_flow
from stickslip.gap.effects import effect

stiction = effect("stiction")
print(stiction.places(ideal_flow()))
sticky = stiction.insert(ideal_flow(), "valve", S=5.0, J=2.0)
print(repr(sticky["valve:stiction"]))
print(stiction.settings(ideal_flow(), "valve", S=np.array([4.0, 5.0]), J=np.array([1.0, 2.0])))
```

prints

```
('valve',)
<QuasiStaticStem 'valve:stiction': MV:valve -> MV; S = 0.05, J = 0.02, low = -inf, high = inf>
{'valve:stiction.S': array([0.04, 0.05]), 'valve:stiction.J': array([0.01, 0.02])}
```

The brackets give the unit of each parameter and its neutral value.  ``% OP`` and ``% travel`` are percent of the full
span.  A factor multiplies the value of the model.  ``PV`` and ``process input`` are the units of these signals.  A
parameter in brackets has to be fitted for a replay but is no part of the effect's size.  How to add one is in
[CONTRIBUTING.md](../CONTRIBUTING.md).

Where an effect can be follows from the role, the parameters and the inputs of a block.  ``process_gain`` changes a
parameter called ``K``, and stands as a gain before a process of one input that has none.  ``process_time_constant``
wants a parameter called ``tau``, ``T`` or ``omega``.  ``dead_time`` delays the one signal that enters a process from no
source, and else what the process gives.  A process of your own (``Equations``) is a place for all three if its
parameters have these names.  ``effect("dead_time").places(model)`` lists the places.

With linear blocks and only OP, PV and SP logged, the effects of one line give the same log:

- ``valve_gain``, ``process_gain``, ``sensor_span``
- ``positioner_lag``, ``second_lag``, ``sensor_lag``
- ``valve_leak``, ``sensor_bias``, a ``step_disturbance`` from the start
- in a separator: ``real_gas``, ``gas_temperature``

| effect | at | parameters (unit; neutral) | what |
|---|---|---|---|
"""


def page() -> str:
    """Return the page of all effects of the catalogue, in Markdown."""
    return HEAD + "".join(f"{row(one)}\n" for one in CATALOGUE)


def row(effect: Effect) -> str:
    """Return the row of one effect.

    >>> from stickslip.gap.effects import effect
    >>> row(effect("positioner_lag"))[:74]
    '| [positioner_lag](../gap/effects/positioner_lag.py) | valve | tau (s; 0) '
    """
    module = type(effect).__module__
    said = " ".join((inspect.getdoc(sys.modules[module]) or "").split("\n\n")[0].split())
    numbers = ", ".join(map(_in_words, effect.parameters))
    file = f"../{module.removeprefix('stickslip.').replace('.', '/')}.py"
    return f"| [{effect.name}]({file}) | {effect.role} | {numbers} | {said.rstrip('.').replace('``', '')} |"


def _in_words(parameter: Parameter) -> str:
    neutral = "the model's" if math.isnan(parameter.neutral) else f"{parameter.neutral:g}"
    words = f"{parameter.name} ({parameter.unit}; {neutral})"
    return f"[{words}]" if parameter.nuisance else words


if __name__ == "__main__":
    print(page(), end="")
