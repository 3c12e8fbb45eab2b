# SPDX-License-Identifier: BSD-3-Clause
"""From fitted hypotheses to a decision: the table that compares them, and the rules that decide.

In the order in which a diagnosis comes by them:

`compare`, `records`
    The table of all hypotheses; their posterior is `mismatch.inference.posterior`.
`detect`, `null_reference`
    The p-value: how strong a mismatch looks, among healthy recordings.
`case`, `weighing`, `standing`
    What a judgement is made on; whether it is enough for a mismatch, at alpha; which findings may be named.
`judging`, `rules`, `reasons`
    The judgement, rule after rule. Limits are in `mismatch.constants`, a rule's sentence is its own, and
    those of a verdict without a name are in `reasons`.
`judgement`
    The frozen result, which the steps below replace by another.
`behind`, `late`, `stretches`
    The same for what lies behind a property, in the last rows, and in long recordings.
`suppression`, `known_before`, `referee`, `dated`
    What the data may have made, what a history may have had already, what a black box predicts better, and
    when something changed.
`rehearsing`
    What a valve does by itself, for its null law: a part of a history held against another.
`assessing`, `probability`, `borne_out`, `grade`, `kinds`, `checked_kind`
    How sure it is: frequencies from sealed records, and a grade.
`decision`
    Where the verdict comes from, first and last: where all is weak no name is left.
"""
