"""Where everything lives in the two arrays that describe one component: integers ``I`` and floats ``W``.

A component is a set of blocks that influence each other.  Its whole state, its parameters and its wiring are
data in these arrays, so changing a wire or a parameter never recompiles anything, a run can be stopped and
resumed between any two steps, and a variant in an ensemble is one more copy of ``W``.

``I`` = header (``H`` ints) + one row of ``R`` ints per block + wires, programs and plans.
``W`` = header (``HF`` floats) + the named stretches whose offsets stand in the integer header.
"""

# --- integer header: sizes ------------------------------------------------------------------------------
N_BLOCKS = 0
N_STATES = 1
N_SIGNALS = 2
N_EVENTS = 3  # event functions of the whole component
N_LOG = 4  # signals to log
N_SAMPLED = 5
N_CHECKED = 6  # signals that must stay finite: all but those of hosted blocks, where NaN says "no value"
N_JAC = 7  # entries of the Jacobian that can be other than zero
N_FACTORS = 8  # and of its factors
ENGINE = 9  # address of the compiled engine, ``cache.engine``
# --- stretches of W -------------------------------------------------------------------------------------
O_X = 10  # working state: what kernels read
O_F = 11  # state rates: what der kernels write
O_Y0 = 12  # accepted state at the start of the step
O_Y1 = 13  # proposed state at the end of the step, behind it the rates there (2 x n)
O_K = 14  # stage rates (16 x n); Rosenbrock: rates at the start, then its stages
O_S = 15  # signals: block outputs one after the other
O_G = 17  # event functions now, behind them those at the end and in the middle of the step (3 x n)
O_G0 = 18  # event functions at the left of the scanned interval
O_RATE = 19  # signal rates (only filled for blocks that ask)
O_JAC = 20  # Jacobian, entries in the order they are filled
O_LU = 21  # factors of diagonal - J
O_DFDT = 22
O_TMP = 23  # n scratch floats
O_D = 24  # modes and memories of all blocks
O_CONT = 25  # dense output: up to ``SERIES`` coefficients per state
O_SCRATCH = 26  # memories saved while a sampled block publishes before it reads
O_RESTART = 27  # by mode: first steps that worked after earlier events, then 1 where the mode was stiff
O_CX = 28  # states of a chunk of log rows, behind them where in the step they lie, and room for one more series
O_CS = 29  # their signals
# --- stretches of I -------------------------------------------------------------------------------------
L_WIRES = 30  # the logged signals
L_PLACE = 31  # the factor that each entry of the Jacobian goes to
L_DIAGONAL = 32  # the factor on the diagonal of each state
L_FACTOR = 33  # plans of elimination and of both substitutions (``elimination.Elimination``)
L_FORWARD = 34
L_BACKWARD = 35
P_SIGNALS = 36  # programs (see below) and, one place further, how many calls they hold: all signals,
P_MOVING = 38  # those that move between instants and are needed for rates or events,
P_EVENT_SIGNALS = 40  # those needed for events,
P_RATES = 42  # state rates,
P_EVENTS = 44  # event functions,
P_ENTERING = 76  # what enters the dead times
# --- what kind of component it is -----------------------------------------------------------------------
HAS_RATES = 46  # 1: some event functions look at signal rates, in some mode
HAS_DELAYS = 47
TIMED = 48  # 1: the rates depend on time directly
EXPLICIT = 49  # the explicit method of this component: 3 if it is linear in each mode, else ``OTHERWISE``
METHOD_WISH = 50  # 0 automatic, 1 explicit only, 2 Rosenbrock only
MAX_STEPS = 51
MAX_CHAIN = 52
# --- where the run stands -------------------------------------------------------------------------------
ROW = 53  # first log row not yet written
STEPS = 54
REJECTED = 55
RHS = 56
EVENTS = 57
JACOBIANS = 58
METHOD = 59  # 0 explicit 5(4), 1 Rosenbrock, 2 explicit 8(5,3), 3 series: what the current segment uses
EV_COUNT = 60  # events written to the buffer and not yet collected
EVENTS_SEEN = 61  # events before the present stretch; -1 before the first instant
FRESH = 62  # 1: a discontinuity at the present time has not been handled yet; 2: its samples have been taken
HOLD = 63  # 1: return on arrival at t_end before anything happens there (a hosted block is due)
STIFF_COUNT = 64
K1_VALID = 65  # 1: rates and event functions at the start of the step are known
CHAIN = 66  # transitions since time last moved
CLOSER = 67  # how often the present stiff step was shortened to end just behind an event
N_DELAYS = 68
SMOOTH_STOP = 69  # 1: at T_STOP nothing happens but that a dead time lets out what is smooth to the first derivative
DENSE_TERMS = 70  # coefficients of the dense output in use; below zero: of a power series; 0: one not yet made
LEARN = 71  # 1 + slot of O_RESTART that the next accepted step fills in
CROWDED = 72  # 1: a stiff step ended at an event less than ``advance.APART`` after the one before
JAC_VALID = 73  # 1: so is the Jacobian
PAUSE_AT = 74  # return after so many steps, so that the host can look up
L_DELAYS = 75  # where in I the rows stand of what records signals: links out, then dead times
L_REPLAYED = 78  # and of what replays them: dead times, then links in
N_REPLAYED = 79
SAVED = 80  # floats of W that a run can be set back with: all but the rings of the links
N_TIMES = 82  # log times of this call,
EV_ROOM = 83  # and events that its buffer holds
LINKED = 84  # 1: it replays signals of other cells
O_MODEL = 85  # W: by mode: 1 if known, then A and g of ``series``
MODEL = 86  # which of them the present modes use
OTHERWISE = 87  # the explicit method for what ``series`` does not describe: 0 or 2
RATES_NOW = 88  # 1: in the present modes some event functions look at signal rates
CURRENT = 89  # 1: a sweep after the samples of this instant has left the signals of the present
L_INSTANTS = 90  # where in I the rows stand of blocks that take samples, have timetables or announce instants
N_INSTANTS = 91
O_AFFINE = 92  # W: 1 + the modes for which it holds (0: unknown), then how signals follow states and time (``rows``)
AFFINE = 93  # 1: all signals that move between instants are affine in states and time in each mode
O_AGAIN = 94  # W: a step that comes again and again, as ``series`` keeps it
L_STARTING = 95  # where in I the rows stand of the blocks that take ``turns`` as a run starts, in their order,
N_STARTING = 96
L_TURNS = 97  # and while it goes on
N_TURNS = 98
L_WATCHING = 99  # where in I the rows stand of blocks whose event functions may look at rates
N_WATCHING = 100
SWEEP_PLACE = 81  # where in the program of all signals the sweep of an instant goes on,
SWEEP_CALLS = 101  # and how many calls stand before that
H = 102

CHUNK = 32  # log rows evaluated together
RESTARTS = 16
SERIES = 17  # terms of a series at most
MOST_STATES = 12  # of a component whose matrix is worth keeping

# --- block row ------------------------------------------------------------------------------------------
KIND = 0
A_OUT = 1  # addresses of the kernels
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
U = 12  # offsets in W
P = 13
D = 14
X = 15  # offsets in the stretches of states, signals, event functions
Y = 16
G = 17
WIRES = 18  # where in I the signals stand that it reads
GATHER = 19  # inputs to copy before a call; 0 where U points at the one signal read
RATES = 20  # 1: event functions look at the rates of the inputs, which stand behind them
FEEDS = 21  # 1: outputs depend on all inputs at the same instant
STILL = 22  # 1: the outputs change at instants only
LOGGED = 23  # 1: changes of d[0] go to the event log
GLOBAL = 24  # index of the block in the diagram
NEXT_TIME = 25  # offset of (next time, maximum step) in W
PERIOD = 26  # offset of the sampling period [s] in W
OFFSET = 27  # offset of the first sampling instant [s] in W
COUNT = 28  # number of samples already taken, or of rows of the timetable passed
DELAY = 29  # offset of the delay ring in W
CAPACITY = 30  # delay ring: records
HEAD = 31  # delay ring: index of the next record to write
TAIL = 32  # delay ring: oldest record kept
BREAK = 33  # delay ring: first record whose start is not yet passed as a breakpoint
NEEDED = 34  # delay: 1 if rates, event functions or dead times follow what leaves it
J_OUT = 35  # programs with their lengths: the outputs that follow this block's states at once,
J_DER = 37  # and the rates that follow them
J_BACK = 39  # where in I the signals stand that these outputs are, and how many
J_ROWS = 41  # and the states whose rates these are
REACH = 43  # where in I stands which dead times its outputs reach, and through how many integrators; 0: none
ENTERS = 44  # delay: smoothness level of what enters it now
RESTS = 45  # delay: 1 if what enters it stands still between instants
TABLE = 46  # address of the block's timetable, 0 for none (``listed``)
TABLE_ROWS = 47
TABLE_WIDTH = 48  # numbers in a row: the time and the values that are in force from then on
TABLE_VALUES = 49  # where in W the values in force stand: behind the parameters
TAKES = 50  # 1: takes samples, each period or at the times of its timetable
SHOWN = 51  # offset in W of its inputs at the last instant, if its event functions may look at rates
SWEPT = 52  # how far in the program of all signals a sweep has to be for what this block reads; it goes on there
SWEPT_CALLS = 53  # and how many calls stand before it
RATE_MODES = 54  # where in I stand the modes in which event functions look at rates: how many (0: all), which
R = 55

CONTINUOUS = 0
SAMPLED = 1
DEAD_TIME = 2
HOSTED = 3  # sampled block whose step runs in Python, between two calls of the engine
LINK_OUT = 4  # records a signal that another cell reads, see ``stickslip.engine.windows``
LINK_IN = 5  # replays it there
RECORDING = (DEAD_TIME, LINK_OUT)
REPLAYING = (DEAD_TIME, LINK_IN)

# --- programs: one call after the other ------------------------------------------------------------------
# (kernel, x, d, u, p, out, inputs, where each input comes from ...): everything but the kernel and the number of
# inputs is a place in W; what is replayed has no kernel, and in place of x its row; a call with the kernel
# ``SKIPPED`` is left out
SKIPPED = 1

# --- float header ---------------------------------------------------------------------------------------
T = 0
STEP = 1  # proposed next step [s]
RTOL = 2
ATOL = 3
T_STOP = 4  # next instant the integrator must not step over
MAX_STEP = 5
T_LEFT = 6  # latest time at which kernels may be evaluated in this step (left limit of T_STOP)
SEEN = 7  # samples up to this time were taken before the run began (when it continues another)
NEXT_ROW = 8  # time of the first log row not yet written
LONGEST = 9  # largest step of the whole run [s]
HF = 10

# --- delay record ---------------------------------------------------------------------------------------
D_T = 0  # start of the step
D_H = 1  # its length
D_LEVEL = 2  # smoothness of the signal at its start: 0 jump, 1 kink, ... 9 smooth
D_V = 3  # equidistant values, the first at the start, the last at the end of the step
D_NODES = 8
D_SIZE = 11
