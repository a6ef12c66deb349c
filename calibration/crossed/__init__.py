"""Loops from their equations in which sticking is crossed with every driver, defect and kind of loop.

stems     what moves a stem: positioner, air, eight laws of friction     drawing   what is drawn, and what is held back
loops     one loop, compiled                                              tuning    from what is drawn to numbers
history   what a historian keeps of it, and what is true                  settings  the same as a law to learn from
"""
