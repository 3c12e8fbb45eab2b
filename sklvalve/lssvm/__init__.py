# SPDX-License-Identifier: BSD-3-Clause
"""What data say: the least-squares support vector machine."""

from sklvalve.lssvm.cross_validated import LSSVMRegressorCV
from sklvalve.lssvm.onnx_export import to_onnx
from sklvalve.lssvm.regressor import LSSVMRegressor

__all__ = ["LSSVMRegressor", "LSSVMRegressorCV", "to_onnx"]
