"""A stem that sticks and the process behind it: the law of stick, the answers of PV, and fits of both to a record."""
