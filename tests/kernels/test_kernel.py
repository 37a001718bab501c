"""Kernels: machine code that is kept gives what numba gives, and is never used for another."""

import os
import resource
import subprocess
import sys
import threading

import numpy as np
import pytest
from conftest import PATIENCE

from meshdepict.kernels import notice
from meshdepict.kernels.intrinsics import Intrinsic
from meshdepict.threads import kernel

_STEP = 3.0


@kernel()
def third(a, i):
    return a[i] / _STEP


@kernel("free", inline=True)
def twice(number):
    return 2 * number


def everything(array, plane, column, pair, kind, whole, flag, single, out):
    held = np.zeros(5, np.float64)  # memory of its own
    for i in range(len(array)):
        held[i % 5] += third(array, i) + twice(column[i])
        for j in range(plane.shape[1]):
            held[j % 5] += plane[i, j] * pair[0]
        out[i] = held[i % 5]
    if flag:
        out[0] += kind(whole) + single + pair[1]
    return held.sum(), whole + 1, flag


ARGUMENTS = {
    "array": np.arange(7.0),
    "plane": np.asfortranarray(np.arange(21, dtype=np.float32).reshape(7, 3)),
    "column": np.arange(14, dtype=np.int32)[::2],
    "pair": (0.5, np.int32(4)),
    "kind": np.float32,
    "whole": 3,
    "flag": True,
    "single": np.float32(0.25),
}


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    return tmp_path / "meshdepict" / "kernels"


def test_every_kind_of_argument_and_of_result(folder):
    ours, plain = np.zeros(7), np.zeros(7)
    one = kernel()(everything)
    found = one(*ARGUMENTS.values(), ours)
    (file,) = folder.iterdir()  # one kernel was compiled: those that it calls are in it
    assert f".{everything.__name__}." in file.name
    expected = everything(*ARGUMENTS.values(), plain)
    assert found == expected
    assert [type(part) for part in found] == [float, int, bool]
    np.testing.assert_array_equal(ours, plain)


def test_what_is_kept_is_loaded_and_not_compiled(folder, monkeypatch):
    names = []
    with notice.told(names.append):
        first = kernel()(everything)(*ARGUMENTS.values(), np.zeros(7))
        second = kernel()(everything)(*ARGUMENTS.values(), np.zeros(7))
    assert first == second
    assert names == ["everything"]


def test_names_and_defaults(folder):
    @kernel()
    def difference(a, b):
        return a - b

    assert difference(b=1, a=5) == difference(5, 1) == 4


@pytest.mark.parametrize("value", [-1, 2**31, -(2**62), True, 1.5, np.int8(-3), np.uint16(65535)])
def test_numbers_come_back_as_they_were(folder, value):
    @kernel()
    def same(a, out):
        out[0] = a

    out = np.zeros(1, np.asarray(value).dtype)
    same(value, out)
    assert out[0] == value


def test_what_machine_code_cannot_take_is_left_to_numba(folder):
    @kernel()
    def made(count):
        return np.arange(count)  # an array comes out

    @kernel()
    def real(z):
        return z.real

    np.testing.assert_array_equal(made(4), range(4))
    assert real(2 + 1j) == 2


def test_a_numba_whose_memory_is_laid_out_otherwise_runs_its_own(folder, monkeypatch):
    from meshdepict.kernels import compiling

    @kernel()
    def summed(count):
        return np.ones(count).sum()

    monkeypatch.setattr(compiling, "BLOCK", "{i64, i8*}")
    assert summed(5) == 5
    (kept,) = folder.glob("*summed*")
    assert kept.read_bytes().endswith(b"\n")  # a line that says so, and no machine code


def fingerprints(text):
    """Fingerprint of the function f of some lines."""
    names = {"kernel": kernel, "np": np}
    exec(text, names)
    return names["f"].fingerprint


BEFORE = "K = 2\n@kernel()\ndef g(x):\n    return x + K\n@kernel()\ndef f(x):\n    return g(x)\n"


@pytest.mark.parametrize(
    ("old", "new"),
    [("K = 2", "K = 3"), ("K = 2", "K = 2.0"), ("x + K", "x - K"),
     ("return g(x)", "return g(x) + 1"), ("return g(x)", "return x"),
     ("@kernel()\ndef f", "@kernel('free')\ndef f"),
     ("@kernel()\ndef g", "@kernel(inline=True)\ndef g"),
     ("K = 2", "K = np.array([2, 3])[0]"), ("K = 2", "K = (2,)[0] + np.float32(0)")]
)  # fmt: skip
def test_all_that_a_kernel_refers_to_is_in_its_fingerprint(old, new):
    assert fingerprints(BEFORE) == fingerprints(BEFORE)
    assert old in BEFORE
    assert fingerprints(BEFORE) != fingerprints(BEFORE.replace(old, new))


def test_docstrings_and_comments_change_nothing():
    told = BEFORE.replace("def f(x):\n", 'def f(x):\n    """Say so."""\n    # and why\n')
    other = BEFORE.replace("def f(x):\n", 'def f(x):\n    """Say it otherwise."""\n')
    assert fingerprints(told) == fingerprints(other)


def test_what_cannot_be_told_is_refused():
    @kernel()
    def odd(x):
        return x + THING

    with pytest.raises(TypeError, match="refers to THING, a list"):
        odd.fingerprint  # noqa: B018


THING = [1]


@pytest.mark.parametrize(
    "spoil",
    [lambda b: b[:-9], lambda b: b + b"x", lambda b: b"", lambda b: b"{}\n" + b, lambda b: b[:40]],
)
def test_a_spoiled_file_is_made_anew(folder, spoil):
    array = np.arange(6.0)
    assert kernel()(third.py_func)(array, 3) == 1
    (file,) = folder.iterdir()
    file.write_bytes(spoil(file.read_bytes()))
    assert kernel()(third.py_func)(array, 3) == 1
    names = []
    with notice.told(names.append):  # and is whole again
        assert kernel()(third.py_func)(array, 3) == 1
    assert not names


@pytest.mark.parametrize("place", ["file", "missing", "forbidden"])
def test_a_folder_that_cannot_be_written(tmp_path, monkeypatch, place):
    folder = tmp_path / place
    if place == "file":
        folder.write_text("")
    elif place == "forbidden":
        folder.mkdir(mode=0o500)
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(folder))
    assert kernel()(third.py_func)(np.arange(6.0), 3) == 1


def test_threads_that_come_at_once_compile_once(folder):
    names, found = [], []
    shared = kernel()(third.py_func)

    def call():
        found.append(shared(np.arange(6.0), 3))

    with notice.told(names.append):
        threads = [threading.Thread(target=call) for _ in range(8)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
    assert found == [1.0] * 8
    assert names == ["third"]


def test_loading_takes_neither_numba_nor_scipy(folder):
    code = (
        "import sys, numpy as np\n"
        "from meshdepict.surface.components import connected\n"
        "print(connected(4, np.array([2]), np.array([3])))\n"
        "print(*{'numba', 'scipy'} & {*sys.modules})"
    )
    env = os.environ | {"NUMBA_CACHE_DIR": str(folder)}
    said = [
        subprocess.run(
            [sys.executable, "-c", code], env=env, capture_output=True, text=True,
            timeout=PATIENCE, check=True,
        ).stdout.splitlines()
        for _ in range(2)
    ]  # fmt: skip
    assert said[0][0] == said[1][0] == "[0 1 2 2]"
    assert "numba" in said[0][1]
    assert said[1][1] == ""


def test_two_processes_at_once(folder):
    code = (
        "import numpy as np\n"
        "from meshdepict.surface.components import connected\n"
        "assert list(connected(4, np.array([2]), np.array([3]))) == [0, 1, 2, 2]"
    )
    env = os.environ | {"NUMBA_CACHE_DIR": str(folder)}
    both = [subprocess.Popen([sys.executable, "-c", code], env=env) for _ in range(2)]
    assert [process.wait(PATIENCE) for process in both] == [0, 0]
    assert not list(folder.rglob("*.part"))


def test_numba_switched_off(folder, monkeypatch):
    monkeypatch.setenv("NUMBA_DISABLE_JIT", "1")
    assert kernel()(third.py_func)(np.arange(6.0), 3) == 1
    assert not folder.exists()


EXTENSION = """
from numba.extending import intrinsic

@intrinsic
def seven(_, number):
    def code(context, builder, signature, args):
        return builder.add(args[0], context.get_constant(number, 7))
    return number(number), code
"""


def test_what_extends_numba_is_read_where_something_is_compiled(folder, tmp_path, monkeypatch):
    (tmp_path / "our_extension.py").write_text(EXTENSION)
    monkeypatch.syspath_prepend(tmp_path)
    seven = Intrinsic("our_extension", "seven")

    @kernel()
    def more(number):
        return seven(number)

    with pytest.raises(TypeError, match="seven has a meaning within kernels only"):
        seven(4)
    before = more.fingerprint
    assert "our_extension" not in sys.modules
    assert more(4) == 11
    assert "our_extension" in sys.modules
    (tmp_path / "our_extension.py").write_text(EXTENSION.replace("7)", "8)"))
    assert Intrinsic("our_extension", "seven").fingerprint != seven.fingerprint
    assert before == more.fingerprint
    one, other = (Intrinsic("our_extension", "seven", width).fingerprint for width in (8, 16))
    assert one != other


def test_memory_that_a_kernel_takes_is_given_back(folder):
    @kernel()
    def filled(count):
        held = np.full(count, 2.0)
        return held[0] + held[-1]

    filled(10)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    for _ in range(500):
        assert filled(1 << 20) == 4  # 8 MB each
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 1 << 17  # in KB, on Linux


def test_more_memory_than_there_is(folder):
    @kernel()
    def taken(count):
        held = np.empty(count, np.float64)
        held[0] = count
        return held[0]

    with pytest.raises(MemoryError):
        taken(1 << 58)
