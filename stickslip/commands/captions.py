"""The words of ``stickslip reproduce``: what is on its page, and how each picture compares with the thesis's own."""

TITLES = {
    "5.4": "Table 5.4: periods and amplitudes, constant feed",
    "6.1": "Table 6.1: index R, constant feed",
    "6.2": "Table 6.2: index R, sinusoidal methane fraction",
    "case 2": "What VPCS1 does under the sine (figures 5.4 and B.2)",
    "ideal": "The valve and ideal loops (figures 4.1, 4.2, 6.1, B.3 and chapter 7)",
    "choice": "How the drop over VPCS1 was chosen",
}
FIGURES = {
    "5.4": ("5.1", "5.2", "5.3", "B.1"), "6.2": ("5.4",), "case 2": ("5.5", "5.6", "B.2"),
    "ideal": ("4.1", "4.2", "6.1", "B.3", "7.1", "7.2", "7.3", "B.4"), "choice": ("choice",),
}  # fmt: skip
# What the band of a table is: of the values of R within one run, or over the starts.
BANDS = {"ideal": "± 1 s.d.", "": "5 to 95 %", "all": "5 to 95 % (ideal loops: ± 1 s.d.)"}
LEAD = (
    "The plant of the thesis, rebuilt from its equations with set E of parameters, and the ideal loops: published "
    "beside reproduced. Plant numbers are medians over many starts, separator 1's contents moved by up to 3 %, with "
    "the 5 to 95 % band: this plant has several limit cycles, and the start decides which one it finds. None of these "
    "starts was used to find the parameters."
)
GUIDE = (
    "Met: the median lies inside the stated tolerance of the published value; sets: share of the sets of "
    "starts whose own median does. Rows without tolerance are shown for "
    "comparison, and say why. The plant's unknowns were fitted to these tables in part (set E: five numbers; set C: "
    "one, the drop over VPCS1), so agreement there is a fit and no prediction, and many rows are met by any plant of "
    "this kind. Here are tables 5.4, 6.1 and 6.2 and figures 4.1 to 5.6, 6.1, 7.1 to 7.3 and B.1 to B.4. Table 6.3 and "
    "figure 6.2 are of real data that were never published. Figures 1.1 to 3.3 draw no results: structures, and "
    "pictures from other papers; they are not drawn again."
)

CAPTIONS = {
    "4.1": (
        "A run, not a sketch: OP rises and falls slowly, the stem with high stiction follows. From A it waits until OP "
        "has travelled S, slips by J (C to D), follows (to E), and waits again on the way back."
    ),
    "4.2": (
        "Eq. 4.5 with table A.1: at rest friction balances the force up to F_s, in motion it is Coulomb and viscous "
        "friction."
    ),
    "5.1": (
        "With sticky valves everything from separator to shaft oscillates; at rest without stiction nothing moves. "
        "Bars at the right edge: the printed amplitudes, peak to peak. Speed drifts with the level besides; the bars "
        "count its ripple alone."
    ),
    "5.2": (
        "Flat: the stem sticks while OP travels the stickband. Steep: it jumps. As in the thesis, both valves draw the "
        "same rectangle; from other starts VPCS1 jumps twice each way (the case plant_1_high_two_jumps)."
    ),
    "5.3": "The pressure draws an ellipse, the level a narrow loop: it integrates, which turns the phase by 90°.",
    "B.1": "Between two jumps of the stem OP has to travel the stickband.",
    "5.4": (
        "The sine moves everything. With high stiction ripples ride on it while VPCS1 is in charge (pressure error "
        "near zero); with normal stiction the stem takes a few steps as OP falls. Compressor 2 comes near surge when "
        "VPCS1 jumps shut, but its flow never turns back."
    ),
    "5.5": "Rising OP carries the stem along, falling OP moves it in steps (a), as in the thesis.",
    "5.6": "OP waits at zero while the pressure is low; the loops right of it are the ripples.",
    "B.2": "OP of the pressure valve rests at zero for about a third of the time: printed are some 40 %.",
    "6.1": (
        "R is the dark area over the light one. A sine has R = 1; the printed model with high stiction gives 13.9, not "
        "3.71, and with 2.75 times its loop gain 3.77."
    ),
    "B.3": "The same factor on the loop gain brings the other printed values near, 18.40 if its caption means normal.",
    "7.1": "Shifting PV opens the loop of an integrating process, but makes it a rectangle, as in the thesis.",
    "7.2": "A high-pass filter opens it to an ellipse; too short a time constant distorts it (d), as in the thesis.",
    "7.3": (
        "The same on the plant's level: short time constants amplify every break in it; here the pressure makes two a "
        "period, in the thesis one."
    ),
    "B.4": "OP travels the stickband to and fro, and the stem jumps at each end.",
    "choice": "Each dot is a start. Where dots form two groups, the median depends on which is the larger.",
}
