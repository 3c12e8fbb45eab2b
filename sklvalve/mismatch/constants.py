# SPDX-License-Identifier: BSD-3-Clause
"""Numbers that decide a diagnosis: what each is, where it was measured, and what moving it costs."""

#: No p-value is told below this: no model of noise and no reference is that good.
LEAST_P_VALUE = 1e-12
#: Share of an effect that its simulation gets wrong [1]: along the difference to another effect, where each
#: is judged by the noise that it leaves, and of the size of most effects. With 0.10, 6 of 100 records of a
#: sealed draw lost the truth (benchmarks/NOTES_OF_TRIALS.md). Larger: classes hold more names, and what is
#: found must be larger. Smaller: classes leave out true names.
SHARE_WRONG = 0.15
#: The same by a noise that is common to what is compared, as with times at which one effect may begin, or
#: with tests that are planned [1]. Intervals of onsets hold 95 % with it. Larger: wider intervals, fewer
#: tests that are promised to separate.
SHARE_WRONG_BY_ONE_NOISE = 0.10
#: A class of explanations holds so much of the probability. Larger: classes hold more names.
IN_CLASS = 0.95
#: Two explanations are told apart from this distance on: a chance of 3 % of taking one for the other.
DISTINGUISHABLE = 14.0
#: A difference is noticed from this distance on: five standard deviations.
DETECTABLE = 25.0
#: On rows left out of the fit a name gains at least this many standard errors of its gain by blocks. Of 48
#: right names of simulated records the least gained 1.03. Larger: right names are lost whose effect acts
#: seldom. Smaller: what happened once, and predicts nothing, is named.
HELD_OUT_ERRORS = 1.0
#: A name needs that more than this share of healthy recordings leave as much over, beyond the noise of their
#: history, as is left beside it. Of 411 named records of eight draws with a history, judged at 0.01, eight
#: wrong and five right names lie between 0.01 and 0.05, one and seven between 0.05 and 0.1. Larger: right
#: names are lost. Smaller: imitations are named.
NO_IMITATION = 0.05
#: A correction adds at most this many standard errors to the squared error of forecast rows: the same measure
#: as of rows left out. Beside a history five right names of simulated records had -6.0 to -0.4 and a wrong
#: one -1.0. Larger: names stand that predict nothing. Smaller: what long errors do to a few stretches takes
#: right names away.
FORECAST_ERRORS = 1.0
#: An unexplained residual of this share of what the effects explain makes their names doubtful.
RESIDUAL_SHARE = 0.5
#: Posterior of a smooth pattern beside a name, since a history, above which there is no name. It is that by
#: which the search takes up a further effect. Of ten names of what is outside the catalogue three lie above
#: it, of 39 right names none, and four between 0.5 and it. Larger: imitations are named. Smaller: right names
#: are lost.
PATTERN_POSTERIOR = 0.95
#: A slow residual of the flow may be so many times what noise and tolerances allow.
TIMES_ALLOWED = 1.3
#: A black box is clearly better where its error is smaller by this factor. Of 30 healthy recordings of the
#: concealed plant with every signal the largest ratio was 1.08 (docs/method.md).
MARGIN = 1.25
#: Where the pressure drop is unknown, a black box that learns how the drop follows the flow is better by as
#: much in three of seven healthy recordings: there it must halve the error, in every stretch.
MARGIN_OF_A_DROP = 2.0
#: A class is named from this probability on; benchmarks/concealed/results/README.md
#: has the effect of other values.
NAMED_FROM = 0.6
