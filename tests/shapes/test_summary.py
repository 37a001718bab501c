"""Tables of shapes: what `info` says, in a notebook; texts of files stay texts."""

import re

import numpy as np

import meshdepict as md
from meshdepict import samples
from meshdepict.io import write_mesh
from meshdepict.shapes import defects


def rows(table):
    """The rows of an HTML table."""
    return dict(re.findall(r"<tr><th[^>]*>(.*?)</th><td[^>]*>(.*?)</td></tr>", table))


def printed(lines):
    """The rows that `info` prints."""
    return dict(re.split(r"  +", line.strip(), maxsplit=1) for line in lines[1:])


def test_a_mesh_s_table_has_the_rows_of_info_but_for_what_costs(run, ball_ply, monkeypatch):
    _, out, _ = run("info", "ball.ply")
    said = printed(out)
    monkeypatch.setattr(defects, "find_defects", None)  # nobody calls it
    found = rows(md.read_mesh("ball.ply")._repr_html_())
    assert found
    for label, text in found.items():
        assert said[label] == text
    assert said.keys() - found.keys() == {"parts", "defects", "default bake"}


def test_a_volume_s_table_has_the_rows_of_info(run, folder):
    volume = samples.ct_phantom((12, 12, 12))
    volume.to_pyvista().save("ct.vti")
    _, out, _ = run("info", "ct.vti")
    assert rows(md.read_volume("ct.vti")._repr_html_()) == printed(out)


def test_data_units_and_polygons_are_rows(folder):
    quad = md.Mesh(
        [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], [[0, 1, 2, 3]], length_unit="mm",
        attributes={"face": {"<b>part</b>": np.zeros(1)}},
    )  # fmt: skip
    found = rows(quad._repr_html_())
    assert found["faces"] == "1 polygons (2 triangles)"
    assert found["length unit"] == "mm"
    assert found["face data"] == "&lt;b&gt;part&lt;/b&gt;"
    write_mesh("quad.ply", quad)


def test_scale_spaces_and_images_have_tables():
    ball = samples.sphere(100)
    space = md.scale_space(ball, scales=3)
    found = rows(space._repr_html_())
    assert found["samples"] == f"{len(ball.vertices):,}"
    assert found["scales"] == "3"
    widths = [float(text) for text in found["widths"].split()]
    np.testing.assert_allclose(widths, space.widths[1:], rtol=1e-3)
    assert "widths" not in rows(md.scale_space(ball, scales=0)._repr_html_())
    image = md.GBuffer.of(ball, "front", size=(40, 30))
    found = rows(image._repr_html_())
    assert found["pixels"] == "40 x 30"
    assert found["samples"] == f"{len(image.normals):,}"
    assert found["with"] == "mesh"
