"""`md.methods()` is what the command prints, a table, and a sequence of names."""

import re
from collections.abc import Sequence

import pytest

import meshdepict as md
from meshdepict import MeshdepictError
from meshdepict.options import options_of
from meshdepict.shading import METHODS, declaration


def cells(table):
    return re.findall(r"<t[hd][^>]*>(.*?)</t[hd]>", table)


def test_it_is_a_sequence_of_names():
    found = md.methods()
    assert isinstance(found, Sequence)
    assert list(found) == list(METHODS)
    assert found[0] in found
    assert found[:2] == tuple(METHODS)[:2]
    assert len(found) == len(METHODS)
    assert "nonsense" not in found


def test_it_is_printed_as_by_the_command(run):
    assert run("methods") == (0, repr(md.methods()).splitlines(), [])
    for name in ("exaggerated", "lambert"):
        assert run("methods", name) == (0, repr(md.methods(name)).splitlines(), [])


def test_the_table_has_a_line_of_each():
    found = cells(md.methods()._repr_html_())
    assert len(found) == 3 + 3 * len(METHODS)
    for i, (name, function) in enumerate(METHODS.items()):
        assert found[3 + 3 * i] == name
        assert len(found[4 + 3 * i]) > 10
        source = declaration(function).source
        assert found[5 + 3 * i].replace("&#x27;", "'").replace("&amp;", "&") == source


@pytest.mark.parametrize("name", METHODS)
def test_a_method_is_described_with_its_options(name):
    found = md.methods(name)
    assert found.name == name
    assert [option[0] for option in found.options] == list(options_of(METHODS[name]))
    table = found._repr_html_()
    assert {option[0] for option in found.options} <= set(cells(table))
    assert md.methods(METHODS[name]).facts == found.facts


def test_an_unknown_one_is_refused_naming_the_nearest():
    with pytest.raises(MeshdepictError, match="did you mean 'exaggerated'"):
        md.methods("exagerated")
