# SPDX-License-Identifier: BSD-3-Clause
"""When a diagnosis may say that there is no sign of a fault; for the layers that put it into words."""

# a difference that comes by chance in as many recordings of a healthy valve is no sign of a fault
_COMMON = 0.05


def no_sign(content: dict) -> bool:
    """Whether nothing is missing, and a difference as large is common by chance.

    A diagnosis that leaves the matter open reassures nobody.

    Parameters
    ----------
    content : dict
        A diagnosis as diagnosis.json has it.

    Examples
    --------
    >>> no_sign({"verdict": "no_mismatch", "mismatch": {"p_value": 0.43, "alpha": 0.01}})
    True
    """
    p_value, level = content["mismatch"].get("p_value"), content["mismatch"].get("alpha") or 0.0
    return (
        content["verdict"] == "no_mismatch" and p_value is not None and p_value >= _COMMON and p_value > level
    )
