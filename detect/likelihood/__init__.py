"""How likely a record is with a stem that has dead travel and with any rival: physics alone, nothing is learnt.

regression    lines with Student-t errors, many at once        rows    a record as rows of an autoregression
stems         one record: the gain of every size of stick      pooled  many records of one valve: one evidence
words         that evidence in words
"""
