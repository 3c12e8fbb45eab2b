# SPDX-License-Identifier: BSD-3-Clause
"""One healthy valve, recorded twice, and what is learnt of it."""

import pytest

from tests.history.plant import made


@pytest.fixture(scope="session")
def before():
    """The first 1,200 rows."""
    return made()[0]


@pytest.fixture(scope="session")
def after():
    """The 1,200 rows behind them."""
    return made()[1]


@pytest.fixture(scope="session")
def learnt(before):
    """A history of `before`; not to be changed."""
    from sklvalve.history import ValveHistory

    return ValveHistory().fit(before)


@pytest.fixture(scope="session")
def learnt_after(after):
    """A history of `after`, with a calibration of its own; not to be changed."""
    from sklvalve.history import ValveHistory

    return ValveHistory().fit(after)
