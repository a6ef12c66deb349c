"""When a controller scans between rows that are no multiple of its scans, in a loop whose set point switches."""

from stickslip.gap import diagnose
from stickslip.gap.effects import effect
from stickslip.logs import Log

from benchmarks.foreign.record import record
from benchmarks.foreign_models.cone import model


def test_a_phase_is_found_though_switches_suit_another_at_first():
    # rows of 37 s, scans of 2 s: switches were placed for a phase that is 104 nats less likely, and stayed there
    made, wired = record("cone", seed=1708864186), model()
    log = Log(made.signals["time"], {s: by * made.signals[tag] for s, (by, tag) in wired.signals.items()})
    report = diagnose(wired.diagram, log, catalogue=[effect("controller_integral_time")], limits=False, progress=False)
    assert not report.gap
