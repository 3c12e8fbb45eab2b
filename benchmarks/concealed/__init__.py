# SPDX-License-Identifier: BSD-3-Clause
"""Recordings in which something is concealed, what is found in them, and how often that is true."""
