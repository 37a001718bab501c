"""Textures and coordinates that are no use: one sentence each, and nothing half-written."""

from __future__ import annotations

import numpy as np
import pytest
from textured_shapes import globe

from meshdepict.images.encoded import encode

BALL = globe(4)
WHOLE = encode(np.full((4, 4, 3), 99, np.uint8))


def write(folder, *, picture="p.png", content=WHOLE, texcoords=BALL.texcoords, named=True):
    """A ball as OBJ with a material library and its picture, one of them wrong."""
    corners = texcoords.reshape(-1, 2)
    lines = ["mtllib find.mtl", "usemtl clay"]
    lines += [f"v {x} {y} {z}" for x, y, z in BALL.vertices.tolist()]
    lines += [f"vt {u} {v}" for u, v in corners.tolist()]
    for number, face in enumerate((BALL.faces + 1).tolist()):
        words = [f"{v}/{3 * number + k + 1}" if named else str(v) for k, v in enumerate(face)]
        lines.append("f " + " ".join(words))
    (folder / "find.obj").write_text("\n".join(lines) + "\n")
    (folder / "find.mtl").write_text(f"newmtl clay\nmap_Kd {picture}\n")
    if content is not None:
        (folder / "p.png").write_bytes(content)


WORDS = ("texture", "find.obj", "-m", "lambert", "--size", "128", "-o", "out.obj")
PICTURES = {
    "missing": ({"picture": "gone.png"}, "names the texture 'gone.png', which is not there"),
    "outside": ({"picture": "../p.png"}, "names the texture '../p.png', which leads out of"),
    "empty": ({"content": b""}, "names the texture 'p.png', which is empty"),
    "unreadable": ({"content": WHOLE[:40]}, "the texture 'p.png' can't be read as a picture"),
    "no picture": ({"content": b"hello"}, "the texture 'p.png' can't be read as a picture"),
}


@pytest.mark.parametrize(("wrong", "said"), PICTURES.values(), ids=PICTURES)
def test_a_picture_that_cant_be_had_ends_what_needs_it_alone(run, folder, wrong, said):
    write(folder, **wrong)
    before = sorted(path.name for path in folder.iterdir())
    status, _, lines = run(*WORDS, "--albedo", "keep")
    assert status == 2
    assert said in lines[-1]
    assert "albedo='keep' needs what can't be had" in lines[-1]
    assert sorted(path.name for path in folder.iterdir()) == before
    status, _, lines = run(*WORDS)
    assert status == 0
    assert len(lines) <= 1
    if lines:
        assert lines[0].endswith(": left out")
    assert (folder / "out.png").exists()


def spoiled(place):
    found = BALL.texcoords.copy()
    found[3, 1] = place
    return found


COORDINATES = {
    "no number in one": ({"texcoords": spoiled(np.nan)}, 2, "1 of 192 triangles have no"),
    "no numbers": ({"texcoords": np.full_like(BALL.texcoords, np.nan)}, 0, "all triangles with a"),
    "none": ({"named": False}, 0, "all triangles with a texture have no coordinates"),
    "a point": ({"texcoords": np.full_like(BALL.texcoords, 0.3)}, 0, "a new atlas is made"),
    "a line": ({"texcoords": BALL.texcoords * (1, 0)}, 0, "a new atlas is made"),
    "repeated": ({"texcoords": BALL.texcoords * 2.5}, 2, "overlap in texture coordinates"),
    "far away": ({"texcoords": BALL.texcoords * 1e12}, 2, "reach as far as"),
    "beyond the square": ({"texcoords": BALL.texcoords + 3}, 0, ""),
}


@pytest.mark.parametrize(("wrong", "expected", "said"), COORDINATES.values(), ids=COORDINATES)
def test_coordinates_that_are_no_use_are_replaced_or_refused(run, folder, wrong, expected, said):
    write(folder, **wrong)
    status, _, lines = run(*WORDS)
    assert status == expected
    assert (folder / "out.obj").exists() == (folder / "out.png").exists() == (status == 0)
    if not said:
        assert lines == []
    else:
        assert said in lines[-1]
    if status == 2:
        assert lines[-1].endswith("(--atlas new)")
        status, *_ = run(*WORDS, "--atlas", "new")
        assert status == 0
