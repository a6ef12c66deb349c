"""One likelihood of a log given a diagram: the diagram's own run is the filter's prediction.

prepared     a model made ready: noise as inputs that are held, dead times as scan values (``late``)
frame        what all hypotheses of a record share            hypothesis   an effect at a place, and what it leaves
fit          sizes by Fisher's scoring                        switches     when an input switched between two rows
settling     fit and switches, in turn                        known_stem   a valve whose stem's path is known
bank         what a bank of stems leaves                      few_stems    what it loses because they are few
stems        sizes of a stem, by a bank                       stem_trials  trials of these, and noise that suits them
sampled_stems  sizes of a stem that takes OP at rows only
search       every effect by its score, the likeliest fitted  judge        whether what is left is usual
relevance    whether an effect moves anything                 held_out     how far a gap shrinks on unseen rows
diagnosing   the question as a whole, for ``stickslip.gap.diagnose``    telling      its words
"""
