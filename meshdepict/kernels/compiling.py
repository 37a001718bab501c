"""What numba makes of a kernel: the one place that compiles."""

from __future__ import annotations

from typing import Any

from meshdepict.kernels.arguments import NUMBA, Key, Unsupported
from meshdepict.kernels.machine_code import BLOCK, RETURNED, object_of

__all__ = ["compiled"]


def compiled(dispatcher: Any, values: tuple[Any, ...], keys: Key, symbol: str) -> tuple[str, bytes]:
    """Compile a function for arguments of these types.

    Parameters
    ----------
    dispatcher : numba's
    symbol : str
        What its machine code is to be called.

    Returns
    -------
    (str, bytes)
        What it returns, as `callable_of` wants it, and the object; `NUMBA` and nothing where it
        asks numba's runtime for more than memory.
    """
    import numba

    types = tuple(numba.typeof(value) for value in values)
    dispatcher.compile(types)
    made = dispatcher.overloads[types]
    try:
        _check_layout()
        returns = _returned(made.signature.return_type)
        text = dispatcher.inspect_llvm(types)
        return returns, object_of(text, made.fndesc.llvm_func_name, symbol, keys)
    except (Unsupported, RuntimeError, AttributeError):  # or numba is built otherwise by now
        return NUMBA, b""


def _check_layout() -> None:
    """Refuse a numba whose blocks of memory begin otherwise than ours do."""
    from numba.core.runtime import nrtdynmod

    if str(nrtdynmod._meminfo_struct_type) != BLOCK:
        raise Unsupported


def _returned(kind: Any) -> str:
    from numba import types

    if kind == types.none:
        return "none"
    parts = kind.types if isinstance(kind, types.BaseTuple) else [kind]
    names = [str(getattr(part, "literal_type", part)) for part in parts]
    if any(name not in RETURNED for name in names):
        raise Unsupported
    return " ".join(("tuple" if isinstance(kind, types.BaseTuple) else "one", *names))
