# SPDX-License-Identifier: BSD-3-Clause
"""How the transformer finds its columns, and one value for each row."""

import numpy as np


def column_of(role, where, names, n_columns):
    """Position of a role's column, given by name or position."""
    if not isinstance(where, str):
        if where >= n_columns:
            raise ValueError(
                f"{role}={where} is no column of the data, which have {n_columns}: set {role}=..."
            )
        return int(where)
    if names is None:
        raise ValueError(f"{role}={where!r} is a name, but the columns have no names: give its position.")
    found = np.flatnonzero(names == where)
    if not found.size:
        raise ValueError(
            f"{role}={where!r} is not a column of the data. Columns: {', '.join(names)}; set {role}=..."
        )
    return int(found[0])


def per_row(values, X, name):
    """`values` as floats, one for each row of X; one number stands for all rows."""
    values = np.asarray(values, dtype=float)
    if values.ndim == 2 and values.shape[1] == 1:
        values = values[:, 0]
    if values.ndim > 1 or (values.ndim == 1 and values.shape[0] != X.shape[0]):
        raise ValueError(
            f"{name} must have one value for each of the {X.shape[0]} rows; got shape {values.shape}."
        )
    return np.broadcast_to(values, X.shape[:1])
