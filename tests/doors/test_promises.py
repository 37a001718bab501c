"""The watch over all tests sees what it is there for: changed inputs, and NaN."""

import numpy as np
import pytest
from conftest import tetrahedron
from promises import makers, watched

import meshdepict as md


class Doubled:
    """Spoils its input in three ways, each when asked for."""

    def __init__(self, values, *, spoil=""):
        if spoil == "values":
            values[0] = 2
        if spoil == "flags":
            values.setflags(write=False)
        self.values = 2 * values
        if spoil == "nan":
            self.values[0] = np.nan

    @classmethod
    def of(cls, values, **given):
        return cls(values, **given)


@pytest.fixture
def doubled(monkeypatch):
    monkeypatch.setattr(Doubled, "__module__", "meshdepict.toy")
    for name, maker in [*makers(Doubled)]:
        monkeypatch.setattr(Doubled, name, maker)
    return Doubled


@pytest.mark.parametrize("spoil", ["values", "flags"])
def test_a_constructor_that_spoils_its_input_is_caught(doubled, spoil):
    for make in (doubled, doubled.of):
        with pytest.raises(AssertionError, match="changed 1 arrays that it was given"):
            make(np.ones(3), spoil=spoil)


def test_an_object_with_nan_is_caught(doubled):
    for make in (doubled, doubled.of):
        with pytest.raises(AssertionError, match="returned NaN"):
            make(np.ones(3), spoil="nan")


def test_one_that_keeps_its_promises_is_as_it_was(doubled):
    values = np.ones(3)
    assert isinstance(doubled(values), Doubled)
    assert (doubled.of(values).values == 2).all()


def test_a_function_that_freezes_its_input_is_caught():
    def freeze(values):
        values.setflags(write=False)

    with pytest.raises(AssertionError, match="changed 1 arrays"):
        watched(freeze)(np.ones(3))


@pytest.mark.parametrize(
    "kind", [md.Mesh, md.Volume, md.GBuffer, md.View, md.Light, md.Environment, md.TransferFunction]
)
def test_what_people_make_is_watched(kind):
    assert hasattr(kind.__init__, "__wrapped__")


def test_an_array_that_became_a_mesh_stays_its_owners():
    vertices, faces = tetrahedron()
    mesh = md.Mesh(vertices, faces)
    vertices[0], faces[0] = 7, 0  # which a frozen array would refuse
    assert mesh.vertices.max() == 1
    assert len(set(mesh.faces[0])) == 3
