"""Arrays of any type, from .npy files and from a person's hands, are taken or refused in words."""

import numpy as np
import pytest
from marked_volumes import marked

from meshdepict.errors import MeshdepictError
from meshdepict.io.volumes import read_volume
from meshdepict.shapes.volume import Volume


@pytest.mark.parametrize(
    ("values", "sentence"),
    [
        (np.zeros((3, 3, 3), object), "holds Python objects, not numbers"),
        (np.zeros((3, 3, 3), np.longdouble), "64 bits or fewer, not (float128|longdouble)"),
        (np.zeros((3, 3, 3), complex), "must be real numbers, not complex128"),
        (np.zeros((3, 3, 3), "M8[s]"), "must be real numbers, not datetime64"),
        (np.zeros((3, 3, 3), [("a", int)]), "must be real numbers"),
        (np.zeros((3, 3, 3), "S3"), "must be real numbers"),
        (np.zeros((3, 0, 3)), "the volume is empty"),
        (np.zeros(()), "a grid of three axes"),
    ],
)
def test_arrays_of_any_type_are_refused_in_a_sentence(tmp_path, values, sentence):
    np.save(tmp_path / "a.npy", values)
    with pytest.raises(MeshdepictError, match=sentence):
        read_volume(tmp_path / "a.npy", spacing=(1, 1, 1))
    if values.dtype != object:
        with pytest.raises(MeshdepictError, match=sentence):
            Volume(values)


def test_archives_and_headers_that_lie_are_refused(tmp_path):
    np.savez(tmp_path / "a.npz", a=marked())
    (tmp_path / "a.npz").rename(tmp_path / "a.npy")
    with pytest.raises(MeshdepictError, match=r"is an archive of arrays \(\.npz\)"):
        read_volume(tmp_path / "a.npy")
    np.save(tmp_path / "b.npy", marked())
    good = (tmp_path / "b.npy").read_bytes()
    for shape in (b"(-7, 6, 5)", b"(7, 6, '5)", b"((7,) ,)  ", b"(9**9,6,5)"):
        (tmp_path / "b.npy").write_bytes(good.replace(b"(7, 6, 5)", shape))
        with pytest.raises(MeshdepictError, match=r"b\.npy is (cut off|damaged)"):
            read_volume(tmp_path / "b.npy", spacing=(1, 1, 1))


def test_values_that_make_no_array_are_refused():
    with pytest.raises(MeshdepictError, match="a list like this makes none"):
        Volume([[[1, 2], [3]]])
    masked = np.ma.masked_less(marked(), 5)
    with pytest.raises(MeshdepictError, match=r"masked values: fill them .*filled\(-1000\)"):
        Volume(masked)
    for place in (
        {"spacing": (1j, 1, 1)}, {"spacing": (10**400, 1, 1)}, {"spacing": "abc"},
        {"spacing": (np.inf, 1, 1)}, {"origin": np.zeros((50, 50))}, {"direction": "x"},
        {"direction": np.full((3, 3), np.nan)}, {"direction": [[1, 0], [0]]},
        {"direction": np.full((3, 3), 1e300)}, {"spacing": (1e300, 1e300, 1e300)},
    ):  # fmt: skip
        with pytest.raises(MeshdepictError) as told:
            Volume(marked(), **place)
        assert len(str(told.value)) < 500
