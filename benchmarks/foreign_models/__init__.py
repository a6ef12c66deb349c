"""Models of the foreign plants, wired from their data sheets alone: ``benchmarks/foreign_models/<plant>.py``.

Each file has a function ``model(noise_factor, load_factor)`` that returns a ``benchmarks.foreign.trial.Wired``; the
factors multiply the standard deviations that the data sheet states of sensors and loads, so that what is stated can be
wrong.  Set points are open inputs; signals have the names and units of the log.  Who writes a model reads the
docstrings of ``benchmarks/foreign`` and the pages for users, and no more.

A load is brought to the input of its process where that is the same in law: a delay of a load that nobody measures
changes nothing.  The lag of a sensor is a block of its own: ``SampledSensor`` has one, but its answer to a signal that
moves between scans comes half a scan too early.
"""
