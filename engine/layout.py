"""Where everything lives in the two arrays that describe one component: integers ``I`` and floats ``W``.

A component is a set of blocks that influence each other.  Its whole state, its parameters and its wiring are
data in these arrays, so changing a wire or a parameter never recompiles anything, a run can be stopped and
resumed between any two steps, and an ensemble member is one more copy of ``W``.

``I`` = header (``H`` ints) + one row of ``R`` ints per block + the wires (signal index per block input).
``W`` = header (``HF`` floats) + the named stretches whose offsets stand in the integer header.
"""

# --- integer header -------------------------------------------------------------------------------------
N_BLOCKS = 0
N_STATES = 1
N_SIGNALS = 2
N_EVENTS = 3  # event functions of the whole component
O_X = 4  # working state: what kernels read
O_F = 5  # state rates: what der kernels write
O_Y0 = 6  # accepted state at the start of the step
O_Y1 = 7  # proposed state at the end of the step, behind it the rates there (2 x n)
O_K = 8  # stage rates (16 x n); Rosenbrock: rates at the start, then six stages
O_S = 9  # signals: block outputs one after the other
O_S0 = 10  # signals just before a discontinuity
O_G = 11  # event functions now, behind them those at the end and in the middle of the step (3 x n)
O_G0 = 12  # event functions at the left of the scanned interval
O_RATE = 13  # signal rates (only filled for blocks that ask)
O_JAC = 14  # dense Jacobian, row major (n x n)
O_LU = 15
O_DFDT = 16
O_TMP = 17  # n scratch floats
O_D = 18  # modes and memories of all blocks
N_D = 20
ROW = 21  # first log row not yet written
N_LOG = 22  # signals to log
L_WIRES = 23  # where in I the logged signal indices stand
STEPS = 24
REJECTED = 25
RHS = 26
EVENTS = 27
JACOBIANS = 28
METHOD = 29  # 0 explicit 5(4), 1 Rosenbrock, 2 explicit 8(5,3): what the current segment uses
METHOD_WISH = 30  # 0 automatic, 1 explicit only, 2 Rosenbrock only
EV_COUNT = 31  # events written to the buffer and not yet collected
FRESH = 32  # 1: a discontinuity at the present time has not been handled yet; 2: its samples have been taken
STIFF_COUNT = 33
HAS_RATES = 34
HAS_DELAYS = 35
K1_VALID = 36
CHAIN = 37  # transitions since time last moved
MAX_STEPS = 38
O_CONT = 40  # dense output: up to 8 coefficients per state
O_SCRATCH = 44  # memories saved while a sampled block publishes before it reads
PENDING_LEVEL = 41  # smoothness level of the discontinuity being handled (0 = jump)
N_SAMPLED = 42
MAX_CHAIN = 45
O_PIVOT = 46  # row swaps, then the sparse factors: per row (count, columns, values) of L and of U
N_CHECKED = 47  # signals that must stay finite: all but those of hosted blocks, where NaN says "no value"
DENSE_TERMS = 48  # coefficients of the dense output in use
EXPLICIT = 49  # the explicit method of this component: 2 unless it is sampled
O_RESTART = 50  # first steps that worked after earlier events, by mode
LEARN = 51  # 1 + slot of O_RESTART that the next accepted step fills in
EVENTS_SEEN = 54  # events before the present stretch; -1 before the first instant
STOP_LEVEL = 55  # smoothness level of what happens at T_STOP (0 = jump)
O_CX = 52  # states of a chunk of log rows
O_CS = 53  # their signals
HOLD = 43  # 1: return on arrival at t_end before anything happens there (a hosted block is due)
H = 56
CLOSE = 39  # 2: a stiff step is repeated up to just before an event, 1: the next one is short and locates it

CHUNK = 32  # log rows evaluated together
RESTARTS = 16

# --- block row ------------------------------------------------------------------------------------------
KIND = 0
A_OUT = 1
A_DER = 2
A_ZC = 3
A_JUMP = 4
A_STEP = 5
A_NEXT = 6
NU = 7
NY = 8
NX = 9
ND = 10
NG = 11
RATES = 12
U = 13
P = 14
D = 15
X = 16
Y = 17
WIRES = 18
G = 19
PERIOD = 20  # offset of the sampling period [s] in W
NEXT_TIME = 21  # offset of (next time, maximum step) in W
FEEDS = 22  # 1: outputs depend on inputs at the same instant
COUNT = 23  # number of samples already taken
DELAY = 24  # offset of the delay ring in W
GLOBAL = 25  # index of the block in the diagram
OFFSET = 26  # offset of the first sampling instant [s] in W
CAPACITY = 27  # delay ring: records
HEAD = 28  # delay ring: index of the next record to write
TAIL = 29  # delay ring: oldest record kept
BREAK = 30  # delay ring: first record whose start is not yet passed as a breakpoint
LOGGED = 31  # 1: changes of d[0] go to the event log
GATHER = 32  # inputs to copy before a call; 0 where U points at the one signal read
SHARP = 33  # 1: what leaves this dead time reaches one again without passing an integrator
J_OUT = 34  # where in I the blocks stand whose outputs follow this block's states at once, in flow order
N_J_OUT = 35
J_DER = 36  # and the blocks whose rates follow them
N_J_DER = 37
R = 40

CONTINUOUS = 0
SAMPLED = 1
DEAD_TIME = 2
HOSTED = 3  # sampled block whose step runs in Python, between two calls of the engine

# --- float header ---------------------------------------------------------------------------------------
T = 0
STEP = 1  # proposed next step [s]
RTOL = 2
ATOL = 3
T_STOP = 4  # next instant the integrator must not step over
MAX_STEP = 5
T_LEFT = 6  # latest time at which kernels may be evaluated in this step (left limit of T_STOP)
T_OLD = 7
H_OLD = 8  # length of the last accepted step, for dense output
ERR_OLD = 9
SEEN = 10  # samples up to this time were taken before the run began (when it continues another)
HF = 16

# --- delay record ---------------------------------------------------------------------------------------
D_T = 0  # start of the step
D_H = 1  # its length
D_LEVEL = 2  # smoothness at its start: 0 jump, 1 kink, ... 9 smooth
D_V = 3  # equidistant values, the first at the start, the last at the end of the step
D_NODES = 8
D_SIZE = 11
