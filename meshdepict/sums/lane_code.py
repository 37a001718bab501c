"""What numba makes of vectors of sixteen numbers; `lanes` says what they are for.

This file is read where a kernel is to be compiled, and nowhere else: it loads numba.
"""

from __future__ import annotations

import math
from typing import Any

from llvmlite import ir
from numba.core import cgutils, types
from numba.core.datamodel import models
from numba.extending import intrinsic, register_model

from meshdepict.sums.lanes import WIDE

__all__ = [
    "add", "add_each", "add_scaled", "add_to", "fill", "larger", "load", "lowest", "minus",
    "nothing", "plus", "power_of_two", "rounded", "store", "store_each", "times", "within",
]  # fmt: skip


class Lanes(types.Type):
    """So many vectors of a kind of number."""

    def __init__(self, dtype: Any, count: int) -> None:
        self.dtype, self.count = dtype, count
        super().__init__(name=f"Lanes({dtype}, {count})")


@register_model(Lanes)
class _Model(models.PrimitiveModel):
    def __init__(self, manager: Any, kind: Lanes) -> None:
        number = manager.lookup(kind.dtype).get_value_type()
        vector = ir.VectorType(number, WIDE)
        super().__init__(manager, kind, ir.ArrayType(vector, kind.count))


def _places(context: Any, builder: Any, kind: Any, array: Any, at: Any, whole: Any) -> list[Any]:
    """Return pointers to the vectors that begin at a place of a one-dimensional array."""
    data = context.make_array(kind)(context, builder, array).data
    first = builder.bitcast(builder.gep(data, [at]), whole.element.as_pointer())
    return [builder.gep(first, [ir.Constant(ir.IntType(64), k)]) for k in range(whole.count)]


def _aligned(kind: Any) -> int:
    return int(kind.dtype.bitwidth) // 8


def _filled(builder: Any, number: Any, vector: Any) -> Any:
    undefined = ir.Constant(vector, ir.Undefined)
    one = builder.insert_element(undefined, number, ir.Constant(ir.IntType(32), 0))
    everywhere = ir.Constant(ir.VectorType(ir.IntType(32), WIDE), [0] * WIDE)
    return builder.shuffle_vector(one, undefined, everywhere)


def _added(builder: Any, a: Any, b: Any, c: Any) -> Any:
    return builder.fadd(builder.fmul(a, b, flags=("contract",)), c, flags=("contract",))


def _together(builder: Any, whole: Any, vectors: list[Any]) -> Any:
    result = ir.Constant(whole, ir.Undefined)
    for k, vector in enumerate(vectors):
        result = builder.insert_value(result, vector, k)
    return result


def _apart(builder: Any, lanes: Any) -> list[Any]:
    return [builder.extract_value(lanes, k) for k in range(lanes.type.count)]


@intrinsic
def nothing(_: Any, array: Any, like: Any) -> Any:
    """Return zeros of the kind that an array has."""
    kind = Lanes(array.dtype, len(like))

    def code(context: Any, _builder: Any, _signature: Any, _args: Any) -> Any:
        return ir.Constant(context.get_value_type(kind), None)

    return kind(array, like), code


@intrinsic
def fill(_: Any, number: Any) -> Any:
    """Return one vector of the same number."""
    kind = Lanes(number, 1)

    def code(context: Any, builder: Any, _: Any, args: Any) -> Any:
        whole = context.get_value_type(kind)
        return _together(builder, whole, [_filled(builder, args[0], whole.element)])

    return kind(number), code


@intrinsic
def load(_: Any, array: Any, at: Any, like: Any) -> Any:
    """Return ``array[at:]``."""
    kind = Lanes(array.dtype, len(like))

    def code(context: Any, builder: Any, _: Any, args: Any) -> Any:
        whole = context.get_value_type(kind)
        places = _places(context, builder, array, args[0], args[1], whole)
        found = [builder.load(place, align=_aligned(array)) for place in places]
        return _together(builder, whole, found)

    return kind(array, types.int64, like), code


@intrinsic
def store(_: Any, lanes: Any, array: Any, at: Any) -> Any:
    """``array[at:] = lanes``."""

    def code(context: Any, builder: Any, _: Any, args: Any) -> Any:
        places = _places(context, builder, array, args[1], args[2], context.get_value_type(lanes))
        for place, vector in zip(places, _apart(builder, args[0]), strict=True):
            builder.store(vector, place, align=_aligned(array))
        return context.get_dummy_value()

    return types.none(lanes, array, types.int64), code


@intrinsic
def add(_: Any, lanes: Any, factor: Any, array: Any, at: Any) -> Any:
    """Return ``lanes + factor · array[at:]``, factor a number."""

    def code(context: Any, builder: Any, _: Any, args: Any) -> Any:
        whole = context.get_value_type(lanes)
        factor = _filled(builder, args[1], whole.element)
        places = _places(context, builder, array, args[2], args[3], whole)
        found = [
            _added(builder, factor, builder.load(place, align=_aligned(array)), vector)
            for place, vector in zip(places, _apart(builder, args[0]), strict=True)
        ]
        return _together(builder, whole, found)

    return lanes(lanes, lanes.dtype, array, types.int64), code


@intrinsic
def add_to(_: Any, lanes: Any, factor: Any, array: Any, at: Any) -> Any:
    """``array[at:] += factor · lanes``, factor a number."""

    def code(context: Any, builder: Any, _: Any, args: Any) -> Any:
        whole = context.get_value_type(lanes)
        factor = _filled(builder, args[1], whole.element)
        places = _places(context, builder, array, args[2], args[3], whole)
        for place, vector in zip(places, _apart(builder, args[0]), strict=True):
            before = builder.load(place, align=_aligned(array))
            builder.store(_added(builder, factor, vector, before), place, align=_aligned(array))
        return context.get_dummy_value()

    return types.none(lanes, lanes.dtype, array, types.int64), code


@intrinsic
def add_each(_: Any, lanes: Any, factors: Any, first: Any, array: Any, at: Any) -> Any:
    """Return lanes, of which the k-th vector has ``factors[first + k] · array[at:]`` more."""

    def code(context: Any, builder: Any, _: Any, args: Any) -> Any:
        whole = context.get_value_type(lanes)
        given = builder.load(
            _places(context, builder, array, args[3], args[4], ir.ArrayType(whole.element, 1))[0],
            align=_aligned(array),
        )
        data = context.make_array(factors)(context, builder, args[1]).data
        found = []
        for k, vector in enumerate(_apart(builder, args[0])):
            place = builder.gep(data, [builder.add(args[2], ir.Constant(ir.IntType(64), k))])
            factor = _filled(builder, builder.load(place), whole.element)
            found.append(_added(builder, factor, given, vector))
        return _together(builder, whole, found)

    return lanes(lanes, factors, types.int64, array, types.int64), code


@intrinsic
def store_each(_: Any, lanes: Any, array: Any, at: Any, apart: Any) -> Any:
    """``array[at + k · apart:] =`` the k-th vector of lanes, one after the other."""

    def code(context: Any, builder: Any, _: Any, args: Any) -> Any:
        one = ir.ArrayType(context.get_value_type(lanes).element, 1)
        at = args[2]
        for vector in _apart(builder, args[0]):
            place = _places(context, builder, array, args[1], at, one)[0]
            builder.store(vector, place, align=_aligned(array))
            at = builder.add(at, args[3])
        return context.get_dummy_value()

    return types.none(lanes, array, types.int64, types.int64), code


@intrinsic
def add_scaled(_: Any, lanes: Any, scale: Any, factors: Any, first: Any) -> Any:
    """Return lanes, of which the k-th vector has ``factors[first + k] · scale`` more.

    ``scale`` is one vector.
    """

    def code(context: Any, builder: Any, _: Any, args: Any) -> Any:
        whole = context.get_value_type(lanes)
        given = builder.extract_value(args[1], 0)
        data = context.make_array(factors)(context, builder, args[2]).data
        found = []
        for k, vector in enumerate(_apart(builder, args[0])):
            place = builder.gep(data, [builder.add(args[3], ir.Constant(ir.IntType(64), k))])
            factor = _filled(builder, builder.load(place), whole.element)
            found.append(_added(builder, factor, given, vector))
        return _together(builder, whole, found)

    return lanes(lanes, scale, factors, types.int64), code


def _of_two(operation: Any) -> Any:
    """Return what does something with the vectors of two."""

    def of_two(_: Any, a: Any, b: Any) -> Any:
        def code(context: Any, builder: Any, _: Any, args: Any) -> Any:
            pairs = zip(_apart(builder, args[0]), _apart(builder, args[1]), strict=True)
            found = [operation(builder, one, other) for one, other in pairs]
            return _together(builder, context.get_value_type(a), found)

        return a(a, a), code

    return intrinsic(of_two)


def _larger(builder: Any, a: Any, b: Any) -> Any:
    return builder.select(builder.fcmp_ordered(">", a, b), a, b)


plus = _of_two(lambda builder, a, b: builder.fadd(a, b, flags=("contract",)))
minus = _of_two(lambda builder, a, b: builder.fsub(a, b, flags=("contract",)))
times = _of_two(lambda builder, a, b: builder.fmul(a, b, flags=("contract",)))
larger = _of_two(_larger)


@intrinsic
def within(_: Any, a: Any, b: Any) -> Any:
    """Return in which places of one vector a ≤ b: as bits, the lowest one for the first."""

    def code(_context: Any, builder: Any, _: Any, args: Any) -> Any:
        one, other = (builder.extract_value(lanes, 0) for lanes in args)
        bits = builder.bitcast(builder.fcmp_ordered("<=", one, other), ir.IntType(WIDE))
        return builder.zext(bits, ir.IntType(64))

    return types.int64(a, b), code


@intrinsic
def rounded(_: Any, lanes: Any, array: Any) -> Any:
    """Return vectors of double precision in that of an array."""
    kind = Lanes(array.dtype, lanes.count)

    def code(context: Any, builder: Any, _: Any, args: Any) -> Any:
        if kind == lanes:
            return args[0]
        whole = context.get_value_type(kind)
        found = [builder.fptrunc(vector, whole.element) for vector in _apart(builder, args[0])]
        return _together(builder, whole, found)

    return kind(lanes, array), code


@intrinsic
def lowest(_: Any, bits: Any) -> Any:
    """Return the place of the lowest bit that is set; one is."""

    def code(_context: Any, builder: Any, _: Any, args: Any) -> Any:
        return builder.cttz(args[0], ir.Constant(ir.IntType(1), 1))

    return types.int64(types.int64), code


# 2^f of |f| ≤ ½ by its series about 0, relative errors 1e-7 and 4e-18.
_TERMS = {32: 7, 64: 14}


@intrinsic
def power_of_two(_: Any, t: Any) -> Any:
    """Return 2^t of one vector, t ≤ 0, to its precision; of what is too small a tiny number.

    2^t = 2^k 2^f with k = round(t): k goes straight into the exponent's bits.
    """
    size = t.dtype.bitwidth
    shift, least, whole_kind = (23, -120.0, 32) if size == 32 else (52, -1000.0, 64)

    def code(context: Any, builder: Any, _: Any, args: Any) -> Any:
        whole = context.get_value_type(t)
        kind = whole.element
        integers = ir.VectorType(ir.IntType(whole_kind), WIDE)

        def number(value: float) -> Any:
            return ir.Constant(kind, [value] * WIDE)

        given = _larger(builder, builder.extract_value(args[0], 0), number(least))
        function = ir.FunctionType(kind, [kind])
        rint = cgutils.get_or_insert_function(builder.module, function, f"llvm.rint.v{WIDE}f{size}")
        rounded = builder.call(rint, [given])
        f = builder.fsub(given, rounded)
        terms = [math.log(2) ** k / math.factorial(k) for k in range(_TERMS[size])]
        power = number(terms[-1])
        for term in reversed(terms[:-1]):
            power = _added(builder, power, f, number(term))
        places = ir.Constant(integers, [shift] * WIDE)
        exponent = builder.shl(builder.fptosi(rounded, integers), places)
        bits = builder.add(builder.bitcast(power, integers), exponent)
        return _together(builder, whole, [builder.bitcast(bits, kind)])

    return t(t), code
