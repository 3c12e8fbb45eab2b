# SPDX-License-Identifier: BSD-3-Clause
"""The paper's experiment on the DAMADICS actuator: physics, data, and both, by rows and inside or outside."""
