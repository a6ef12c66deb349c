"""Models of the foreign plants, wired from their data sheets alone: ``benchmarks/foreign_models/<plant>.py``.

Each file has a function ``model()`` that returns a ``benchmarks.foreign.trial.Wired``: the diagram as the data sheet
has it, with the stated noise and load; which tag each of its signals is; and which block of the sheet each of its
blocks is, where their names differ.  Who writes a model reads the docstrings of ``benchmarks/foreign``, and no more.
"""
