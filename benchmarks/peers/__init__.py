"""The same ideal loop by other means: hand-written C, python-control, PathSim."""
