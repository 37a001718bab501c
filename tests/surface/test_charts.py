"""Charts by xatlas, where it is installed."""

import sys

import numpy as np
import pytest

from meshdepict import samples
from meshdepict.errors import MeshdepictError
from meshdepict.surface.charts import charted
from meshdepict.surface.texels import TexelGrid


def test_charts_lie_apart_within_the_square_and_every_triangle_has_its_corners():
    pytest.importorskip("xatlas")
    ball = samples.golf_ball(600)
    texcoords = charted(ball.unit_points, ball.faces, 512, gutter=8)
    assert texcoords.shape == (len(ball.faces), 3, 2)
    assert texcoords.min() >= 0
    assert texcoords.max() <= 1
    claims = TexelGrid(texcoords, 512).claims(0, 512)
    assert claims.shared == 0
    assert (claims.counts > 0).mean() > 0.99


def test_without_xatlas_a_sentence_says_what_to_do(monkeypatch):
    monkeypatch.setitem(sys.modules, "xatlas", None)
    with pytest.raises(MeshdepictError, match=r"pip install 'meshdepict\[atlas\]', or take"):
        charted(np.eye(3), np.array([[0, 1, 2]]), 64, gutter=2)


def test_charts_on_several_squares_are_refused(monkeypatch):
    class Atlas:
        atlas_count, width, height = 2, 64, 64

        def add_mesh(self, *_):
            pass

        def generate(self, **_):
            pass

    class Package:
        pass

    package = Package()
    package.Atlas, package.PackOptions = Atlas, Package
    monkeypatch.setitem(sys.modules, "xatlas", package)
    with pytest.raises(MeshdepictError, match="on 2 squares of 64 texels"):
        charted(np.eye(3), np.array([[0, 1, 2]]), 64, gutter=2)
