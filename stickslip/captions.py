"""What each picture of ``stickslip reproduce`` shows, and where it differs from the thesis's own."""

CAPTIONS = {
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
