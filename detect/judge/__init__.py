"""One answer for a loop or a valve: what is seen, what is probable, how large it is, and what to do next."""
