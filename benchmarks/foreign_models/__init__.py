"""Models of the foreign plants, wired from their data sheets by another hand than wrote the plants.

One file a plant, each with ``model(noise_factor, load_factor)``: the factors multiply the standard deviations that the
data sheet states of sensors and loads, so that what is stated can be wrong.  Set points are open inputs; signals have
the names of the log.  Who wired them had read the sheets in ``benchmarks/foreign`` and the pages for the house's
users, not the code of the plants.

A load is brought to the input of its process where that is the same in law: a delay of a load that nobody measures
changes nothing.  The lag of a sensor is a block of its own: ``SampledSensor`` has one, but takes it for a signal that
was held since the sample before, which is half a scan too early.
"""
