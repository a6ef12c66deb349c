"""Plants of another hand, in plain numpy from their equations, and how well the gap to a model of them is diagnosed.

Each file of a plant begins with its data sheet, from which somebody else wires a model (``benchmarks/foreign_models``).
What holds for all plants, unless a sheet says otherwise:

Blocks     OP of ``controller`` goes to ``valve`` (positioner, stem, body: OP to flow), its flow to ``process``, what
           comes of it to ``sensor``, and that is PV.  ``feed`` is the unmeasured load.  A gap is at one of these
           or at ``historian``, which makes the log.
Controller It scans: at each scan it reads SP and PV, computes and writes OP, which is held until the next scan.
           e = SP - PV;  I = I + K h/T_i e  (h is the scan);  OP = K e + I, kept between its limits.  At a limit
           I = OP - K e, so nothing winds up.  (The incremental form, OP moves by K (de + h/T_i e), gives the same.)
           K is in shares of full OP per unit of PV, also where OP is logged in %.
Valve      Travel and flow are shares of full.  Without a word the stem is where OP wants it and flow is linear in it.
Sensor     Its lag is of first order; white noise is added at each scan, with the standard deviation given.
           Span and bias act before the noise: PV = factor x true + bias.
Load       AR(1) in steps of 1 s: new at each full second, held in between, stationary, mean zero.
Log        A row holds what the control system held after its last scan; one scan falls on the first row, time 0.  Where
           the interval of rows is no multiple of the scan, rows and scans part by up to a scan.  The plant has been
           running for some time before the first row.  MV is not logged.
Set points They move at any time, also between scans and rows; the controller sees a move at its next scan, and the log
           has what the controller saw.
Stated     Half of the records have noise and load of up to half or twice the standard deviations of the sheet.
"""
