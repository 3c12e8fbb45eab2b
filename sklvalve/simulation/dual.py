# SPDX-License-Identifier: BSD-3-Clause
r"""Numbers that carry their derivatives along, for compiled code.

A dual number is a value and its slopes, one for each of eight or sixteen parameters. What is written for
plain numbers compiles for dual ones as it stands, and then gives the derivatives of its result beside the
result itself (forward mode):

.. math:: (a, a') (b, b') = (a b,\; a' b + a b'), \qquad f(a, a') = (f(a),\; f'(a)\, a')

Slopes of one number lie in one vector of the processor, so that all of them take hardly longer than one.
Where two numbers are compared only their values count: at a corner the slopes are those of the side that was
taken.

Known are ``+ - * /``, comparisons, ``abs``, ``min``, ``max``, ``exp`` and ``sqrt`` of `math`. A plain number
beside a dual one counts as one without slopes.

References
----------
A. Griewank, A. Walther (2008). Evaluating Derivatives, 2nd ed., chapter 3. SIAM.
"""

import math
import operator
from functools import lru_cache

from llvmlite import ir
from numba.core import cgutils, types
from numba.core.imputils import lower_builtin, lower_cast
from numba.core.typeconv import Conversion
from numba.core.typing.templates import AbstractTemplate, infer_global, signature
from numba.extending import intrinsic, make_attribute_wrapper, models, register_model

_NUMBER = ir.DoubleType()
# of values as in the scans that use them; slopes may be summed in any order too
_VALUE, _FLAGS = ("contract", "arcp", "nsz"), ("reassoc", "contract", "arcp", "nsz")


class SlopesType(types.Type):
    """Derivatives of one number, by the compiler's rules a vector of this width."""

    def __init__(self, width):
        self.width = width
        super().__init__(name=f"Slopes({width})")


class DualType(types.Type):
    """A number and its slopes."""

    def __init__(self, width):
        self.width = width
        super().__init__(name=f"Dual({width})")

    def can_convert_from(self, typingctx, other):
        """A plain number may stand where a dual one is asked for."""
        return Conversion.safe if isinstance(other, types.Number) else None

    def unify(self, typingctx, other):
        """What is plain on one way through the code, and dual on another, is dual."""
        return self if isinstance(other, types.Number) else None


@lru_cache
def _vector(width):
    return ir.VectorType(_NUMBER, width)


@register_model(SlopesType)
class _SlopesModel(models.PrimitiveModel):
    def __init__(self, manager, own):
        super().__init__(manager, own, _vector(own.width))


@register_model(DualType)
class _DualModel(models.StructModel):
    def __init__(self, manager, own):
        super().__init__(manager, own, [("value", types.float64), ("slopes", SlopesType(own.width))])


make_attribute_wrapper(DualType, "value", "value")
make_attribute_wrapper(DualType, "slopes", "slopes")


class _Parts:
    """A dual number taken apart while code is made."""

    def __init__(self, context, builder, kind, packed):
        got = cgutils.create_struct_proxy(kind)(context, builder, value=packed)
        self.value, self.slopes = got.value, got.slopes


def _packed(context, builder, kind, value, slopes):
    made = cgutils.create_struct_proxy(kind)(context, builder)
    made.value, made.slopes = value, slopes
    return made._getvalue()


def _zeros(width):
    return ir.Constant(_vector(width), [0.0] * width)


def _times(builder, slopes, factor):
    """Slopes times a plain number."""
    width = slopes.type.count
    nothing, places = ir.Constant(slopes.type, ir.Undefined), ir.VectorType(ir.IntType(32), width)
    one = builder.insert_element(nothing, factor, ir.Constant(ir.IntType(32), 0))
    spread = builder.shuffle_vector(one, nothing, ir.Constant(places, [0] * width))
    return builder.fmul(slopes, spread, flags=_FLAGS)


@lower_cast(types.Number, DualType)
def _from_plain(context, builder, plain, kind, number):
    value = context.cast(builder, number, plain, types.float64)
    return _packed(context, builder, kind, value, _zeros(kind.width))


def _typed(function, result=None):
    """Let the compiler know a function of dual numbers; `result` is a dual number unless given."""

    @infer_global(function)
    class _Typing(AbstractTemplate):
        def generic(self, args, kws):
            dual = next((a for a in args if isinstance(a, DualType)), None)
            if dual is None or not all(isinstance(a, DualType | types.Number) for a in args):
                return None
            return signature(result or dual, *[dual] * len(args))


def _binary(*functions):
    """Register how code for a function of two dual numbers is made: value and slopes from both."""

    def register(make):
        def lowered(context, builder, sig, args):
            a, b = (_Parts(context, builder, sig.return_type, packed) for packed in args)
            return _packed(context, builder, sig.return_type, *make(builder, a, b))

        for function in functions:
            _typed(function)
            lower_builtin(function, DualType, DualType)(lowered)
        return make

    return register


@_binary(operator.add, operator.iadd)
def _sum(builder, a, b):
    return builder.fadd(a.value, b.value, flags=_VALUE), builder.fadd(a.slopes, b.slopes, flags=_FLAGS)


@_binary(operator.sub, operator.isub)
def _difference(builder, a, b):
    return builder.fsub(a.value, b.value, flags=_VALUE), builder.fsub(a.slopes, b.slopes, flags=_FLAGS)


@_binary(operator.mul, operator.imul)
def _product(builder, a, b):
    slopes = builder.fadd(
        _times(builder, a.slopes, b.value), _times(builder, b.slopes, a.value), flags=_FLAGS
    )
    return builder.fmul(a.value, b.value, flags=_VALUE), slopes


@_binary(operator.truediv, operator.itruediv)
def _quotient(builder, a, b):
    value = builder.fdiv(a.value, b.value, flags=_VALUE)
    left = builder.fsub(a.slopes, _times(builder, b.slopes, value), flags=_FLAGS)
    return value, _times(builder, left, builder.fdiv(ir.Constant(_NUMBER, 1.0), b.value))


def _taken(builder, first, a, b):
    return builder.select(first, a.value, b.value), builder.select(first, a.slopes, b.slopes)


@_binary(max)
def _larger(builder, a, b):
    return _taken(builder, builder.fcmp_ordered(">=", a.value, b.value), a, b)


@_binary(min)
def _smaller(builder, a, b):
    return _taken(builder, builder.fcmp_ordered("<=", a.value, b.value), a, b)


def _unary(function):
    """Register how code for a function of one dual number is made: value and derivative."""

    def register(make):
        def lowered(context, builder, sig, args):
            a = _Parts(context, builder, sig.return_type, args[0])
            value, slope = make(context, builder, a.value)
            return _packed(context, builder, sig.return_type, value, _times(builder, a.slopes, slope))

        _typed(function)
        lower_builtin(function, DualType)(lowered)
        return make

    return register


def _plain(function, context, builder, value):
    sig = signature(types.float64, types.float64)
    return context.get_function(function, sig)(builder, [value])


@_unary(math.exp)
def _exponential(context, builder, value):
    power = _plain(math.exp, context, builder, value)
    return power, power


@_unary(math.sqrt)
def _root(context, builder, value):
    root = _plain(math.sqrt, context, builder, value)
    # upright at zero: no slope is better there than an infinite one
    slope = builder.fdiv(ir.Constant(_NUMBER, 0.5), root)
    nothing = ir.Constant(_NUMBER, 0.0)
    return root, builder.select(builder.fcmp_ordered(">", root, nothing), slope, nothing)


@_unary(operator.neg)
def _negative(context, builder, value):
    return builder.fneg(value), ir.Constant(_NUMBER, -1.0)


@_unary(abs)
def _size(context, builder, value):
    below = builder.fcmp_ordered("<", value, ir.Constant(_NUMBER, 0.0))
    slope = builder.select(below, ir.Constant(_NUMBER, -1.0), ir.Constant(_NUMBER, 1.0))
    return builder.select(below, builder.fneg(value), value), slope


def _comparison(function, sign):
    def lowered(context, builder, sig, args):
        a, b = (_Parts(context, builder, sig.args[0], packed).value for packed in args)
        compare = builder.fcmp_unordered if sign == "!=" else builder.fcmp_ordered
        return compare(sign, a, b)

    _typed(function, types.boolean)
    lower_builtin(function, DualType, DualType)(lowered)


for _function, _sign in (
    (operator.lt, "<"),
    (operator.le, "<="),
    (operator.gt, ">"),
    (operator.ge, ">="),
    (operator.eq, "=="),
    (operator.ne, "!="),
):
    _comparison(_function, _sign)


def _place(context, builder, array, row, width):
    """Where a row of an array of slopes (its type and itself) lies."""
    data = context.make_array(array[0])(context, builder, array[1]).data
    first = builder.gep(data, [builder.mul(row, ir.Constant(ir.IntType(64), width))])
    return builder.bitcast(first, _vector(width).as_pointer())


@intrinsic
def dual(typingctx, value, slopes, row, like):
    """Dual number of a value and the slopes in a row of an array of shape (n, width), in C order.

    `like` is a tuple of as many numbers as there are slopes: compiled code knows its length.
    """
    kind = DualType(like.count)

    def made(context, builder, sig, args):
        place = _place(context, builder, (sig.args[1], args[1]), args[2], kind.width)
        read = builder.load(place)
        read.align = 8
        return _packed(context, builder, kind, args[0], read)

    return kind(types.float64, slopes, types.int64, like), made


@intrinsic
def kept(typingctx, number, slopes, row):
    """Value of a dual number, its slopes written into a row of an array of shape (n, width)."""

    def made(context, builder, sig, args):
        own = _Parts(context, builder, number, args[0])
        place = _place(context, builder, (sig.args[1], args[1]), args[2], number.width)
        builder.store(own.slopes, place).align = 8
        return own.value

    return types.float64(number, slopes, types.int64), made
