# SPDX-License-Identifier: BSD-3-Clause
"""BLAS and LAPACK on tiles, from several threads at once.

scipy's Python wrappers hold the interpreter's lock while they compute. The same routines through the pointers
that scipy exports for Cython let go of it, and need no compiler.
"""

import ctypes
from functools import cache

from scipy.linalg import cython_blas, cython_lapack

_INT, _DOUBLE, _CHAR = ctypes.POINTER(ctypes.c_int), ctypes.POINTER(ctypes.c_double), ctypes.c_char_p
_KINDS = {"i": _INT, "d": _DOUBLE, "c": _CHAR, "a": ctypes.c_void_p}
_SIGNATURES = {
    "dpotrf": (cython_lapack, "ciaii"),
    "dtrsm": (cython_blas, "cccciidaiai"),
    "dsyrk": (cython_blas, "cciidaidai"),
    "dgemm": (cython_blas, "cciiidaiaidai"),
}


@cache
def _routine(name):
    module, kinds = _SIGNATURES[name]
    capsule = module.__pyx_capi__[name]
    api = ctypes.pythonapi
    api.PyCapsule_GetName.restype, api.PyCapsule_GetName.argtypes = ctypes.c_char_p, [ctypes.py_object]
    api.PyCapsule_GetPointer.restype = ctypes.c_void_p
    api.PyCapsule_GetPointer.argtypes = [ctypes.py_object, ctypes.c_char_p]
    pointer = api.PyCapsule_GetPointer(capsule, api.PyCapsule_GetName(capsule))
    return ctypes.CFUNCTYPE(None, *(_KINDS[kind] for kind in kinds))(pointer), kinds


def _call(name, *arguments):
    routine, kinds = _routine(name)
    made = []
    for kind, value in zip(kinds, arguments, strict=True):
        if kind == "a":
            made.append(value.ctypes.data)
        elif kind == "c":
            made.append(value)
        else:
            made.append(ctypes.byref((ctypes.c_int if kind == "i" else ctypes.c_double)(value)))
    routine(*made)


def factor(tile):
    """Lower Cholesky factor of a tile in place.

    Parameters
    ----------
    tile : ndarray of shape (n, n), Fortran order
        Its lower triangle is read and replaced.

    Returns
    -------
    positive_definite : bool
    """
    info = ctypes.c_int(0)
    routine, _ = _routine("dpotrf")
    n = ctypes.byref(ctypes.c_int(len(tile)))
    routine(b"L", n, tile.ctypes.data, n, ctypes.byref(info))
    return info.value == 0


def divide_by(tile, diagonal):
    """Replace a tile by tile @ inv(diagonal).T, with the lower triangle of `diagonal`; Fortran order."""
    m, n = tile.shape
    _call("dtrsm", b"R", b"L", b"T", b"N", m, n, 1.0, diagonal, n, tile, m)


def take_off(tile, left, right):
    """Subtract left @ right.T from a tile in place; all in Fortran order."""
    m, n = tile.shape
    _call("dgemm", b"N", b"T", m, n, left.shape[1], -1.0, left, m, right, n, 1.0, tile, m)


def take_off_square(tile, left):
    """Subtract left @ left.T from the lower triangle of a tile in place; both in Fortran order."""
    n, k = left.shape
    _call("dsyrk", b"L", b"N", n, k, -1.0, left, n, 1.0, tile, n)
