# SPDX-License-Identifier: BSD-3-Clause
"""Numbers that decide what is said of a loop, and where each was measured.

Drawn loops are those of `benchmarks.loop_plant`. `python -m benchmarks.loop_alarms FIRST LAST` measures false
alarms and power again after a change (docs/loops.md). Numerical settings, such as tolerances, grids and
orders of models, stand where they are used.
"""

import numpy as np

# Which recordings are diagnosed. No measurement is recorded of these.
FEWEST_ROWS = 100  # rows with a fresh command and value, in all and in each stretch
COMMAND_RANGE = (-0.1, 1.1)  # of travel: 0 to 100 % with what a signal may be off; beyond, the unit is wrong
MOST_AT_LIMIT = 0.2  # share of rows with the command at 0 or 100 %: no loop controls there
NEAR_ZERO_FLOW = 0.02  # median flow over the greatest: the valve is shut most of the time
HELD_ROWS = 6  # rows in which nothing recorded changes are a historian's hold, not the plant

# Standard errors of either action of the controller, beyond which both tell the sign of the process gain. Of
# drawn closed loops, 1,492 without a set-point and 743 with one (seeds from 120100 on), 1,252 and 705 are
# sure, and none is wrong. The rule before, a share of the command's moves, was sure in 950 and 573, and
# called 135 with a moving set-point sure, of which 11 were wrong.
SURE_ACTION = 3.0

# Bands [share of the command's movement, its span between the 1 % and 99 % quantiles].
# A smaller band is the play that every valve has, and is never called sticking. Where a smaller band may
# explain the value better and the simpler noise takes nothing off, three healthy windows of the refinery are
# called sticking.
RELEVANT_BAND = 0.17
# A band as wide as the movement: nobody has seen its other end, and its size is known from below only.
WHOLE_MOVEMENT = 0.95

# A command that goes one way only tells no band from a supply or a gain that drifts. One turn is enough: it
# was set after the refinery's recordings had been seen.
FEWEST_TURNS = 1
TURN_SIZE = 0.3  # of the command's movement, by which a turn must come back

# Evidence: differences of log likelihood [nats].
# Share of the responses that come late, up to which a value follows the stem as a flow does, and has the tail
# of a flow: three quarters of drawn flows have less, few of drawn levels.
FAST_SHARE = 0.35
# Share of healthy drawn loops (survival function) and the evidence that it exceeds: of a fast value, of any
# other. From 270 and 284 loops (of seeds 61000 to 61576 and 61700 to 62228). Beyond 0.01 so few tell nothing
# but their largest, 34 nats in both; the last line is set, not measured. At alpha = 0.01 four of 591 healthy
# loops are called sticking and 169 of 315 sticking ones found; at 0.05 it is 34 of 591 and 203 of 315.
NULL_EVIDENCE = np.array([
    [1.0, 0.0, 0.0],
    [0.1, 3.7, 6.3],
    [0.05, 4.9, 8.6],
    [0.02, 6.3, 16.0],
    [0.01, 10.2, 21.0],
    [0.0001, 60.0, 60.0],
])  # fmt: skip
# Complexity penalty of a gain that may change: degrees of freedom of its six terms beside the process.
# Without these terms two healthy flows with curved valves have 88 and 84 nats (seeds 91000 to 91699).
VARYING_GAIN_PENALTY = 3

# When sticking is excluded: 2 of 622 drawn loops that stick, and 115 of 1,208 healthy ones (seeds 120100 to
# 122499). With an earlier rule, bands from 30 % on worse by as much, smaller ones no better and 20 rows to a
# swing, it was 7 and 192.
EXCLUDED_BY = 10.0  # nats by which the command must fit better than every relevant band
SMALL_BAND_FITS = 6.0  # nats by which a smaller band fits better; without this 4 and 119
# With fewer rows the command turns unseen between them: without this 9 and 123.
FEWEST_ROWS_PER_SWING = 10
# The command must fit better than no response at all, or the loop tells nothing.
VISIBLE_RESPONSE = 4.0

# Grade, least evidence [nats] and least turns of the command, from the best on; else it is weak. No
# measurement is recorded; the windows of the refinery's 2411FIC20102, with one to three turns, are weak.
GRADES = (("strong", 30.0, 10), ("moderate", 18.0, 5))

# Sizes of the class of sticking. The likelihood's own intervals held the band in half of the drawn loops;
# between these factors of the band found lay 95 % of 90 drawn loops that stick.
BAND_INTERVAL = (0.45, 1.8)
LEAST_JUMP = 0.2  # of the band; a smaller jump is play

# Oscillation of the loop. It is reported and does not decide a verdict.
FEWEST_CYCLES = 4.0  # periods in a record; fewer cannot be told from drift
SHORTEST_PERIOD = 3.0  # rows; below it the samples no longer show the wave
REGULARITY_LIMIT = 1.0  # published (Thornhill, Huang and Zhang 2003)
LEAST_AUTOCORRELATION = 0.25  # mean over one to three periods; that of narrow noise falls below
LEAST_VARIANCE_SHARE = 0.1  # of the signal's variance; a weaker line is left to the noise
LINE_TEST_LEVEL = 1e-3  # of the F test of a line against its flanks

# Published methods. Their limits are those of the papers named in each; they are reported and do not decide,
# since on 525 drawn loops none adds to the evidence.
PEAK_AREA_LIMIT = 1.0  # above it stiction, else an aggressive controller
PEAK_AREA_SURE = 2.0  # standard errors of the mean from the limit; nearer is undecided
CURVE_LIMITS = (0.4, 0.6)  # below no stiction, above stiction
RELAY_LIMITS = (-0.21, 0.21)  # below no stiction, above stiction
LAG_LIMITS = (1.0 / 3.0, 2.0 / 3.0)  # ratio of lags: phase shifts of 30 and 60 degrees off even
HEIGHT_LIMITS = ((2.0 - 3.0**0.5) / (2.0 + 3.0**0.5), 1.0 / 3.0)  # the same shifts, in the ratio of heights
NGI_LIMIT, NLI_LIMIT = 0.001, 0.01  # non-Gaussianity and nonlinearity index of a linear loop
BICOHERENCE_LEVEL = 0.01  # of any squared bicoherence in the plane
ROWS_OF_A_SHAPE = 10.0  # rows in a period: five from zero to zero tell a triangle from a sine
FEWEST_HALF_PERIODS = 4
