"""The same loops and the same plant solved by other software: hand-written C, python-control, PathSim, LSODA, CVODE."""
