"""Machine code: objects made of LLVM's text, linked into the process, and called.

numba's functions take arrays apart and return a status; see `meshdepict.kernels.arguments`. What
they ask of numba's runtime, memory for arrays of their own, is answered by a few lines of LLVM.
"""

from __future__ import annotations

import ctypes
import functools
import threading
from contextlib import suppress
from typing import TYPE_CHECKING, Any

from meshdepict.kernels.arguments import Key, Unsupported, flattened, types_of

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = ["BLOCK", "RETURNED", "callable_of", "machine", "object_of"]

_WORDS = {
    ctypes.c_void_p: "ptr", ctypes.c_float: "float", ctypes.c_double: "double",
    ctypes.c_int8: "i8", ctypes.c_uint8: "i8", ctypes.c_int16: "i16", ctypes.c_uint16: "i16",
    ctypes.c_int32: "i32", ctypes.c_uint32: "i32", ctypes.c_int64: "i64", ctypes.c_uint64: "i64",
}  # fmt: skip
_DONE = (0, -2)  # status of numba's functions: a value is returned, None is returned
RETURNED = {
    "bool": ctypes.c_bool, "int32": ctypes.c_int32, "int64": ctypes.c_int64,
    "uint64": ctypes.c_uint64, "float32": ctypes.c_float, "float64": ctypes.c_double,
}  # fmt: skip

# Of numba's runtime: a block begins with its count of references, two fields for a destructor,
# where the data begin, and their size. Counting is numba's own; only the last owner comes here.
_RUNTIME = """
declare ptr @malloc(i64)
declare void @free(ptr)

define ptr @NRT_MemInfo_alloc_aligned(i64 %size, i32 %align) {
    %wide = zext i32 %align to i64
    %more = add i64 %wide, 64
    %whole = add i64 %size, %more
    %block = call ptr @malloc(i64 %whole)
    %none = icmp eq ptr %block, null
    br i1 %none, label %failed, label %filled
filled:
    %begin = ptrtoint ptr %block to i64
    %beyond = add i64 %begin, %more
    %over = urem i64 %beyond, %wide
    %at = sub i64 %beyond, %over
    %data = inttoptr i64 %at to ptr
    store i64 1, ptr %block
    %dtor = getelementptr i8, ptr %block, i64 8
    store ptr null, ptr %dtor
    %info = getelementptr i8, ptr %block, i64 16
    store ptr null, ptr %info
    %where = getelementptr i8, ptr %block, i64 24
    store ptr %data, ptr %where
    %length = getelementptr i8, ptr %block, i64 32
    store i64 %size, ptr %length
    ret ptr %block
failed:
    ret ptr null
}

define void @NRT_MemInfo_call_dtor(ptr %block) {
    call void @free(ptr %block)
    ret void
}
"""
BLOCK = "{i64, i8*, i8*, i8*, i64}"
"""A block's beginning, as numba writes it."""

_OURS = {"NRT_MemInfo_alloc_aligned", "NRT_MemInfo_call_dtor"}
_FOREIGN = ("NRT_", "numba_", "Py", "_Py", "__svml")  # what only numba's own process offers

_linking = threading.Lock()


@functools.cache
def machine() -> str:
    """Say for which compiler and processor objects are made: others can't use them."""
    import llvmlite
    import llvmlite.binding as llvm

    return " ".join(
        (llvmlite.__version__, llvm.get_process_triple(), llvm.get_host_cpu_name(),
         llvm.get_host_cpu_features().flatten())
    )  # fmt: skip


def object_of(text: str, name: str, renamed: str, keys: Key) -> bytes:
    """Make an object of a module in LLVM's text, which stands alone and offers one function.

    Raises
    ------
    Unsupported
        It calls what only numba has, or takes other arguments than those of these keys.
    """
    import llvmlite.binding as llvm

    target = _target()
    module = llvm.parse_assembly(text)
    asked = {f.name for f in module.functions if f.is_declaration}
    if any(one.startswith(_FOREIGN) for one in asked - _OURS):
        raise Unsupported
    taken = [str(part.type) for part in module.get_function(name).arguments]
    if taken != ["ptr", "ptr", *(_WORDS[part] for key in keys for part in types_of(key))]:
        raise Unsupported
    if asked & _OURS:
        module.link_in(llvm.parse_assembly(_RUNTIME))
    for function in module.functions:
        if function.name == name:
            function.name = renamed
            function.linkage = "external"
        elif not function.is_declaration:
            function.linkage = "internal"
    module.verify()
    made: bytes = target.emit_object(module)
    return made


def callable_of(data: bytes, name: str, keys: Key, returns: str) -> Callable[..., Any]:
    """Link an object and return its function, which takes arguments with these keys.

    Parameters
    ----------
    returns : str
        "none", "one" and a type, or "tuple" and a type for each part: words with blanks between.
    """
    import llvmlite.binding as llvm

    with _linking:
        engine = _engine()
        engine.add_object_file(llvm.ObjectFileRef.from_data(data))
        engine.finalize_object()
        address = engine.get_function_address(name)
    taken = [part for key in keys for part in types_of(key)]
    call = ctypes.CFUNCTYPE(ctypes.c_int32, ctypes.c_void_p, ctypes.c_void_p, *taken)(address)
    shape, *words = returns.split()
    names = [f"part{i}" for i in range(len(words))]
    fields = [(part, RETURNED[word]) for part, word in zip(names, words, strict=True)]
    room = type("Room", (ctypes.Structure,), {"_fields_": fields or [("none", ctypes.c_void_p)]})

    def run(*values: Any) -> Any:
        answer, raised = room(), ctypes.c_void_p()
        status = call(ctypes.addressof(answer), ctypes.addressof(raised), *flattened(values))
        if status not in _DONE:  # kernels raise nothing: memory for their own arrays is out
            raise MemoryError
        if shape == "none":
            return None
        parts = tuple(getattr(answer, part) for part in names)
        return parts if shape == "tuple" else parts[0]

    return run


def _target() -> Any:
    import llvmlite.binding as llvm

    for begin in ("initialize", "initialize_native_target", "initialize_native_asmprinter"):
        with suppress(RuntimeError, AttributeError):  # newer ones begin by themselves
            getattr(llvm, begin)()
    triple = llvm.get_process_triple()
    near = triple.startswith(("x86", "i686"))  # where a JIT needs it
    return llvm.Target.from_triple(triple).create_target_machine(
        cpu=llvm.get_host_cpu_name(), features=llvm.get_host_cpu_features().flatten(), opt=3,
        reloc="static" if near else "default", codemodel="jitdefault", jit=True,
    )  # fmt: skip


@functools.cache
def _engine() -> Any:
    import llvmlite.binding as llvm

    target = _target()  # the first: it sets LLVM up
    return llvm.create_mcjit_compiler(llvm.parse_assembly(""), target)
