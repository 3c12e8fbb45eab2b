# SPDX-License-Identifier: BSD-3-Clause
"""The prediction of an LS-SVM as an ONNX graph, for programs without Python."""

import json
from pathlib import Path

import numpy as np
from sklearn.utils.validation import check_is_fitted

from sklvalve import __version__
from sklvalve._replacing import replacing
from sklvalve.lssvm.cross_validated import LSSVMRegressorCV
from sklvalve.lssvm.kernels import SHIFT_INVARIANT
from sklvalve.lssvm.regressor import LSSVMRegressor

# the oldest that have all operators of the graph in double
_OPSET, _IR = 15, 8
# a protocol buffer holds 2 GiB; the rest is for the graph itself
_LARGEST = 2**31 - 2**24
# rows on which the error of a float graph is measured, and kernel values of them at a time
_MEASURED, _AT_A_TIME = 1000, 2**22


def to_onnx(model, *, path=None, dtype="double"):
    r"""Prediction of a fitted LS-SVM as an ONNX model.

    Parameters
    ----------
    model : LSSVMRegressor or LSSVMRegressorCV
        Fitted to rows in numpy arrays, whichever way; the kernel is one that has a name.
    path : str or path-like, default=None
        File to write as well, replaced as a whole once it is complete.
    dtype : {"double", "float"}, default="double"
        What the graph takes, computes in and gives. "double" equals `predict` but for rounding; "float", for
        devices without double, does not: see the notes.

    Returns
    -------
    onnx_model : onnx.ModelProto
        With the input ``X`` of shape [N, n_features] and the output ``y`` of shape [N] or [N, n_targets],
        both of `dtype`, N being any number. ``metadata_props`` holds ``sklvalve_version``, ``feature_names``
        where they are known, a JSON list, and of a float graph ``max_error``.

    Raises
    ------
    ImportError
        If onnx is not installed.
    ValueError
        If the kernel is a callable or precomputed, the model lies on a device, is too large for one file, or
        overflows in float.
    TypeError
        If it is no LS-SVM.
    sklearn.exceptions.NotFittedError
        If it is not fitted.
    OSError
        If the file cannot be written; an older one stays then.

    Notes
    -----
    The graph holds N x n_fit kernel values at a time: give many rows in parts, of some hundred. It checks
    nothing: columns are taken in the order of the fit, and what is not finite comes out as such.

    In double it is `predict` to 1e-9 of the largest target, save where `predict` itself loses more: far from
    zero with kernels that see no differences only, "polynomial" and without a free bias "linear", and with
    these and C = 1e4 or more.

    In float the dual weights keep seven digits, and they cancel the more the larger C and the number of rows
    are. With the kernel rbf and 10 % noise, C = 1e4 costs some 4e-3 of a standard deviation of the target
    where 300 rows or landmarks span the function, and 3e-2 where 3,000 rows do, each a hundred times less at
    C = 100; "laplacian" loses less than 1e-3, a polynomial of many rows everything. Fewer rows lose less:
    `model.pruned`, or solver="nystrom". An offset of X or y costs its share of the seven digits too; take it
    off before the fit. ``max_error`` is the largest difference to `predict` on `X_fit_`, on at most 1,000 of
    its rows, in the unit of the target: a number, or a JSON list of one for each target. A runtime that sums
    in another order may be off by a few times that.

    Examples
    --------
    >>> import numpy as np
    >>> from sklvalve.lssvm import LSSVMRegressor, to_onnx
    >>> opening = np.linspace(0, 1, 21)[:, None]
    >>> model = LSSVMRegressor(gamma=2.0).fit(opening, 50.0 ** (opening[:, 0] - 1))
    >>> saved = to_onnx(model, path="kv.onnx")  # doctest: +SKIP
    """
    onnx = _onnx()
    if dtype not in ("double", "float"):
        raise ValueError(f"dtype must be 'double' or 'float', got {dtype!r}.")
    estimator = _fitted(model)
    if estimator.X_fit_.nbytes + estimator.dual_coef_.nbytes > _LARGEST * (2 if dtype == "float" else 1):
        raise ValueError(
            f"{len(estimator.X_fit_)} rows span the function, more than the 2 GiB of an ONNX file hold; give "
            "model.pruned(n_landmarks), or fit with solver='nystrom'."
        )
    saved = _model(onnx, estimator, dtype)
    told = {"sklvalve_version": __version__}
    if hasattr(model, "feature_names_in_"):
        told["feature_names"] = json.dumps(
            [str(name) for name in model.feature_names_in_], ensure_ascii=False
        )
    if dtype == "float":
        told["max_error"] = json.dumps(_largest_error(saved, estimator))
    onnx.helper.set_model_props(saved, told)
    if path is not None:
        _write(Path(path), saved.SerializeToString())
    return saved


class _Graph:
    """Nodes and constants in the order of their making, each called by the name of its result."""

    def __init__(self, onnx, dtype):
        self._onnx, self._number = onnx, {"double": np.float64, "float": np.float32}[dtype]
        self.nodes, self.constants = [], []

    def constant(self, name, values):
        with np.errstate(over="ignore"):
            values = np.asarray(values, dtype=np.float64).astype(self._number)
        self.constants.append(self._onnx.numpy_helper.from_array(values, name))
        return name

    def axes(self, name, *axes):
        self.constants.append(self._onnx.numpy_helper.from_array(np.array(axes, dtype=np.int64), name))
        return name

    def node(self, operator, inputs, *names, **attributes):
        self.nodes.append(self._onnx.helper.make_node(operator, inputs, names, **attributes))
        return names[0]


def _onnx():
    try:
        import onnx
    except ImportError:
        raise ImportError('an ONNX model needs onnx: pip install "sklvalve[onnx]"') from None
    return onnx


def _fitted(model):
    """The fitted LS-SVM itself."""
    if not isinstance(model, LSSVMRegressor | LSSVMRegressorCV):
        raise TypeError(
            f"model must be a LSSVMRegressor or LSSVMRegressorCV, got {type(model).__name__}; of a pipeline "
            "give the last step, and do the others before the graph."
        )
    check_is_fitted(model)
    estimator = model.estimator_ if isinstance(model, LSSVMRegressorCV) else model
    kernel = estimator._kernel_["kernel"]
    if callable(kernel) or kernel == "precomputed":
        what = "a callable" if callable(kernel) else "'precomputed'"
        raise ValueError(
            "kernel must be rbf, laplacian, linear, polynomial or poly to be written as a graph, got "
            f"{what}; fit with one of these."
        )
    if not isinstance(estimator.dual_coef_, np.ndarray):
        raise ValueError(
            f"The model lies in arrays of {type(estimator.dual_coef_).__module__}; fit it to numpy arrays."
        )
    return estimator


def _model(onnx, estimator, dtype):
    graph, alpha = _Graph(onnx, dtype), estimator.dual_coef_
    left, right = _function(graph, estimator)
    found = graph.node("MatMul", [left, right], "spanned")
    constant = graph.constant("intercept", estimator.intercept_ + estimator._of_offset(alpha))
    # with a vector on the right a MatMul of no rows would fail
    found = graph.node("Add", [found, constant], "y" if alpha.ndim == 2 else "targets")
    if alpha.ndim == 1:
        graph.node("Squeeze", [found, graph.axes("target_axis", 1)], "y")
    kind = {"double": onnx.TensorProto.DOUBLE, "float": onnx.TensorProto.FLOAT}[dtype]
    value = onnx.helper.make_tensor_value_info
    made = onnx.helper.make_graph(
        graph.nodes,
        "LSSVMRegressor",
        [value("X", kind, ["N", estimator.n_features_in_])],
        [value("y", kind, ["N", *alpha.shape[1:]])],
        graph.constants,
    )
    return onnx.helper.make_model(
        made,
        producer_name="sklvalve",
        producer_version=__version__,
        opset_imports=[onnx.helper.make_opsetid("", _OPSET)],
        ir_version=_IR,
    )


def _function(graph, estimator):
    """Names of two factors whose product is the function without its bias."""
    d, alpha, fitted = estimator.n_features_in_, estimator._alpha(), estimator._kernel_
    kernel = fitted["kernel"]
    coordinates = estimator._coordinates()
    Z = graph.node("Sub", ["X", graph.constant("offset", coordinates.offset)], "from_offset")
    gamma, _ = estimator._gamma_and_scale()
    gamma = 1.0 / d if gamma is None else float(gamma)
    # the very numbers of `predict`: X_fit_ less the offset is these but for rounding
    rows = estimator._right_[:, :d]
    if kernel in SHIFT_INVARIANT:
        if coordinates.scale is not None:
            Z = graph.node("Mul", [Z, graph.constant("scale", coordinates.scale)], "scaled")
        squares = {"squares": estimator._right_[:, d + 1]} if kernel == "rbf" else {}
        values = (_rbf if squares else _laplacian)(graph, Z, rows, gamma, **squares)
        return values, graph.constant("dual_coef", alpha)
    # Scales go into the constants: onnxruntime rounds a factor beside a MatMul to float, of doubles too.
    right = rows.T if coordinates.scale is None else coordinates.scale[:, None] * rows.T
    if kernel == "linear":
        return Z, graph.constant("coef", right @ alpha)
    values = _polynomial(graph, Z, gamma * right, fitted["degree"], fitted["coef0"])
    return values, graph.constant("dual_coef", alpha)


def _rbf(graph, Z, rows, gamma, squares):
    """Kernel values with their exponent as one product, the squares of Z being one more column of it."""
    own = graph.node("ReduceSumSquare", [Z], "own_squares", axes=[1], keepdims=1)
    own = graph.node("Mul", [own, graph.constant("minus_gamma", -gamma)], "own_exponent")
    doubled = graph.node("Mul", [Z, graph.constant("two_gamma", 2.0 * gamma)], "doubled")
    left = graph.node("Concat", [doubled, own], "left", axis=1)
    right = graph.constant("right", np.vstack([rows.T, np.ones(len(rows))]))
    exponent = graph.node("Gemm", [left, right, graph.constant("squares", squares)], "exponent")
    # rounding leaves squared distances of equal rows a little below zero
    exponent = graph.node("Min", [exponent, graph.constant("zero", 0.0)], "not_positive")
    return graph.node("Exp", [exponent], "kernel")


def _laplacian(graph, Z, rows, gamma):
    """Kernel values with the distance summed column by column, so that no more than their number is held."""
    d = rows.shape[1]
    columns, distance = [Z], None
    if d > 1:
        columns = [f"column_{k}" for k in range(d)]
        graph.node("Split", [Z], *columns, axis=1)
    for k in range(d):
        fit = graph.constant(f"fit_{k}", rows[:, k])
        apart = graph.node("Sub", [columns[k], fit], f"apart_{k}")
        apart = graph.node("Abs", [apart], f"size_{k}")
        distance = apart if k == 0 else graph.node("Add", [distance, apart], f"distance_{k}")
    exponent = graph.node("Mul", [distance, graph.constant("minus_gamma", -gamma)], "exponent")
    return graph.node("Exp", [exponent], "kernel")


def _polynomial(graph, Z, right, degree, coef0):
    inner = graph.node("MatMul", [Z, graph.constant("right", right)], "inner")
    base = graph.node("Add", [inner, graph.constant("coef0", coef0)], "base")
    return graph.node("Pow", [base, graph.constant("degree", degree)], "kernel")


def _largest_error(saved, estimator):
    """Largest difference of a float graph to `predict` on rows of the fit, of several targets for each."""
    from onnx.reference import ReferenceEvaluator

    rows = estimator.X_fit_[:: -(-len(estimator.X_fit_) // _MEASURED)]
    known = estimator._as_targets(estimator._function(estimator._coordinates()(rows)))
    evaluator, step = ReferenceEvaluator(saved), max(1, _AT_A_TIME // len(estimator.X_fit_))
    parts = [rows[start : start + step].astype(np.float32) for start in range(0, len(rows), step)]
    with np.errstate(all="ignore"):
        found = np.concatenate([evaluator.run(None, {"X": part})[0] for part in parts])
    errors = np.abs(found.astype(np.float64) - known).max(axis=0)
    if not np.isfinite(errors).all():
        raise ValueError(
            "The prediction overflows in float: take dtype='double', or scale X and y before the fit."
        )
    return errors.tolist()


def _write(file, content):
    with replacing(file) as draft:
        draft.write_bytes(content)
