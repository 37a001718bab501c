"""Plates: one scale, views in line, each baked once from shared scale spaces, words as text."""

import re
import xml.etree.ElementTree as ElementTree

import numpy as np
import pypdfium2
import pytest
from PIL import Image

import meshdepict as md
from meshdepict import MeshdepictError, samples
from meshdepict.baking import plate_groups
from meshdepict.drawing.page import Block, Picture, Words
from meshdepict.drawing.picture_files import read_picture_provenance
from meshdepict.errors import MeshdepictWarning

SVG = "{http://www.w3.org/2000/svg}"
SMALL = {"size": (400, 500)}


@pytest.fixture(scope="module")
def egg():
    """An ellipsoid with axes 3, 2 and 1, in a dark shade; no unit."""
    ball = samples.sphere(600)
    return md.Mesh(ball.vertices * (3, 2, 1) + (70, 0, 0), ball.faces)


def dark(image, below=250):
    """(left, top, right, bottom) of what isn't white."""
    there = np.asarray(image.convert("L")) < below
    rows, columns = np.flatnonzero(there.any(axis=1)), np.flatnonzero(there.any(axis=0))
    return columns[0], rows[0], columns[-1] + 1, rows[-1] + 1


def pictures(plate):
    return [part for part in plate.page.parts if isinstance(part, Picture)]


def words(plate):
    return [part.text for part in plate.page.parts if isinstance(part, Words)]


def boxes(plate):
    """Of each picture where in the page its object is."""
    found = []
    for part in pictures(plate):
        left, top, right, bottom = dark(part.image)
        found.append((part.left + left, part.top + top, part.left + right, part.top + bottom))
    return found


# --- arrangement ----------------------------------------------------------------------------------


def test_all_views_have_one_scale_and_are_in_line(egg):
    plate = md.plate(
        egg, "half_lambert", views="front,left,right,back,above,below", pixels_per_unit=30,
        options={"half_lambert": {"exposure": 0.6}}, **SMALL | {"size": (900, 500)},
    )  # fmt: skip
    main, left, right, back, above, below = boxes(plate)

    def size(box):
        return box[2] - box[0], box[3] - box[1]

    deep, wide, high = 60, 180, 120
    for box, expected in (
        (main, (wide, high)), (left, (deep, high)), (right, (deep, high)), (back, (wide, high)),
        (above, (wide, deep)), (below, (wide, deep)),
    ):  # fmt: skip
        assert size(box) == pytest.approx(expected, abs=2)
    for box in (left, right, back):
        assert (box[1], box[3]) == pytest.approx((main[1], main[3]), abs=1)
    for box in (above, below):
        assert (box[0], box[2]) == pytest.approx((main[0], main[2]), abs=1)
    assert left[2] < main[0] < main[2] < right[0] < right[2] < back[0]
    assert above[3] < main[1] < main[3] < below[1]


def test_a_mark_on_the_object_is_at_one_height_in_all_views_of_a_row():
    """A small ball beside a large one, seen from three sides."""
    ball = samples.sphere(400)
    vertices = np.concatenate((ball.vertices, ball.vertices * 0.1 + (0.5, 0.3, 1.4)))
    mesh = md.Mesh(vertices, np.concatenate((ball.faces, ball.faces + len(ball.vertices))))
    plate = md.plate(
        mesh, "half_lambert", views="front,left,right", pixels_per_unit=60, size=(700, 300),
        options={"half_lambert": {"exposure": 0.6}},
    )  # fmt: skip
    _, left, right = pictures(plate)
    beside = []
    for part, columns in ((left, slice(-20, None)), (right, slice(0, 20))):  # nearest the main view
        rows = np.flatnonzero((np.asarray(part.image)[:, columns, 0] < 250).any(axis=1))
        beside.append(part.top + (rows[0] + rows[-1]) / 2)
    assert beside[0] == pytest.approx(beside[1], abs=0.6)
    main = pictures(plate)[0]
    assert beside[0] == pytest.approx(main.top + main.image.size[1] / 2 - 0.3 * 60, abs=1)


def test_the_bar_is_as_long_as_it_says(egg, tmp_path):
    plate = md.plate(egg, "lambert", unit="cm", scale="1:1", size="30x30cm", dpi=100)
    assert plate.pixels_per_unit == pytest.approx(100 / 2.54)
    assert plate.scale == "1:1"
    (label,) = [text for text in words(plate) if text.endswith(" cm")]
    longest = max(b.right - b.left for b in plate.page.parts if isinstance(b, Block))
    assert longest / plate.pixels_per_unit == pytest.approx(float(label.split()[0]))


def test_as_large_as_the_page_has_room_for_and_not_larger(egg):
    plate = md.plate(egg, "lambert", **SMALL)
    with pytest.raises(MeshdepictError, match=r"at .* pixels per unit the page has no room .* fit"):
        md.plate(egg, "lambert", pixels_per_unit=plate.pixels_per_unit * 1.01, **SMALL)
    for left, top, right, bottom in boxes(plate):
        assert 0 < left < right < 400
        assert 0 < top < bottom < 500
    widest = max(box[2] for box in boxes(plate)) - min(box[0] for box in boxes(plate))
    assert widest > 300


def test_a_scale_of_two_digits_where_the_unit_is_known(egg):
    plate = md.plate(egg, "lambert", unit="mm", size="A6", dpi=100)
    assert re.fullmatch(r"\d\d?(\.\d)?:1", plate.scale)
    assert plate.provenance["plate"].endswith(plate.scale)
    assert md.plate(egg, "lambert", **SMALL).scale == ""


# --- views × lights × methods ---------------------------------------------------------------------


def test_one_bake_for_each_and_scale_spaces_are_shared(egg, monkeypatch):
    baked, made = [], []
    bake, space = plate_groups.bake_surface, plate_groups.scale_space
    monkeypatch.setattr(
        plate_groups, "bake_surface", lambda *a, **k: baked.append(a) or bake(*a, **k)
    )
    monkeypatch.setattr(
        plate_groups, "scale_space", lambda *a, **k: made.append(k["scales"]) or space(*a, **k)
    )
    done = []
    plate = md.plate(
        egg, ["exaggerated", "lambert", "half_lambert"], lights=["northwest", "east"],
        views=["front", "right"], progress=lambda *counts: done.append(counts), size=(500, 500),
    )  # fmt: skip
    assert len(baked) == len(pictures(plate)) == 12
    assert sorted(made) == [0, 9]  # two ladders
    assert done == [(i + 1, 12) for i in range(12)]
    captions = [text for text in words(plate) if "light" in text]
    assert captions == [
        f"{method}, light {light}"
        for method in ("exaggerated", "lambert", "half_lambert")
        for light in ("northwest", "east")
    ]


def test_lights_are_those_of_each_view(egg):
    """Every picture of a plate is that of a bake in its view."""
    plate = md.plate(egg, "lambert", views="front,right", pixels_per_unit=30, **SMALL)
    right = pictures(plate)[1]
    baked = md.bake(egg, "lambert", view="right", light="northwest")
    brightest = egg.vertices[baked.intensity.argmax()]
    seen = np.array((-(brightest[2]), brightest[1])) * 30
    column, row = right.image.size[0] / 2 + seen[0], right.image.size[1] / 2 - seen[1]
    assert np.asarray(right.image.convert("L"))[int(row), int(column)] > 240


def test_several_shapes_have_names_and_one_scale(egg, tmp_path):
    half = md.Mesh(egg.vertices / 2, egg.faces)
    plate = md.plate([egg, half], "lambert", views="front", names=["whole", "half"], **SMALL)
    wide, narrow = (box[2] - box[0] for box in boxes(plate))
    assert wide == pytest.approx(2 * narrow, abs=2)
    assert [text.split(":")[0] for text in words(plate) if "light" in text] == ["whole", "half"]
    md.io.write_mesh(tmp_path / "find.ply", egg)
    again = md.plate([tmp_path / "find.ply", half], "lambert", views="front", **SMALL)
    assert words(again)[0].startswith("find: ")


def test_notes_say_which_of_several_shapes_they_are_about(egg):
    tall = md.Mesh(egg.vertices[:, [2, 1, 0]], egg.faces[:, ::-1])
    bright = {"methods": "phong", "lights": [md.Environment(np.full((8, 16, 3), 9.0))], **SMALL}
    with pytest.warns(MeshdepictWarning, match="too bright") as heard:
        md.plate([egg, tall], names=["flat", "tall"], **bright)
    assert {str(note.message).partition(":")[0] for note in heard} == {"flat", "tall"}
    with pytest.warns(MeshdepictWarning, match="^[0-9]+% of the samples are too bright"):
        md.plate(egg, **bright)


def test_volumes_and_meshes_stand_beside_each_other(egg):
    phantom = samples.ct_phantom((24, 24, 24))
    plate = md.plate([phantom, phantom], ["lambert", "half_lambert"], views="front,right", **SMALL)
    assert len(pictures(plate)) == 8
    assert all((np.asarray(p.image) < 250).any() for p in pictures(plate))
    assert any(text.endswith(" mm") for text in words(plate))  # as the CT says


def test_columns_are_lights_where_both_are_several(egg):
    plate = md.plate(
        egg, ["lambert", "half_lambert"], lights=["north", "east", "west"], views="front", **SMALL
    )
    places = [(part.left, part.top) for part in pictures(plate)]
    assert len({left for left, _ in places}) == 3
    assert len({top for _, top in places}) == 2


def test_a_method_without_a_light_is_drawn_once(egg):
    plate = md.plate(
        egg, ["mean_curvature", "lambert"], lights=["north", "east"], views="front", **SMALL
    )
    captions = [text for text in words(plate) if "unit" not in text]
    assert captions == ["mean_curvature", "lambert, light north", "lambert, light east"]


def test_what_would_be_a_speck_at_the_one_scale_is_refused(egg):
    speck = md.Mesh(egg.vertices / 1000, egg.faces)
    with pytest.raises(
        MeshdepictError, match=r"speck: lambert, light northwest would be .* pixels"
    ):
        md.plate([egg, speck], "lambert", names=["egg", "speck"], **SMALL)


# --- files ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("suffix", [".png", ".jpg", ".svg", ".pdf"])
def test_the_same_plate_is_the_same_bytes_and_says_where_it_comes_from(egg, tmp_path, suffix):
    path = tmp_path / f"plate{suffix}"
    raws = []
    for _ in range(2):
        plate = md.plate(egg, "lambert", views="front,below", caption="Two <views> – µ", **SMALL)
        plate.save(path)
        raws.append(path.read_bytes())
    assert raws[0] == raws[1]
    said = read_picture_provenance(path)
    assert said == [f"meshdepict {key}: {text}" for key, text in plate.provenance.items()]
    text = "\n".join(said)
    assert "meshdepict method: lambert" in text
    assert "; below" in text
    assert egg.identity.split()[-1] in text


def test_words_of_a_plate_are_text(egg, tmp_path):
    plate = md.plate(egg, "lambert", unit="mm", size="A6", caption="Eggs – ø")
    root = ElementTree.parse(plate.save(tmp_path / "plate.svg")).getroot()
    texts = [each.text for each in root.iter(f"{SVG}text")]
    assert texts == words(plate)
    assert {"lambert, light northwest", "Eggs – ø"} < set(texts)
    assert (root.get("width"), root.get("height")) == ("104.9867mm", "147.9973mm")
    (page,) = pypdfium2.PdfDocument(plate.save(tmp_path / "plate.pdf"))
    found = page.get_textpage().get_text_range().splitlines()
    assert sorted(found) == sorted(texts)
    assert [side * 25.4 / 72 for side in page.get_size()] == pytest.approx([105, 148], abs=0.1)


def test_vectors_are_where_pixels_are(egg, tmp_path):
    """The PDF, drawn by another program, is the PNG but for its letters."""
    plate = md.plate(egg, "lambert", **SMALL)
    with Image.open(plate.save(tmp_path / "plate.png")) as image:
        expected = np.asarray(image.convert("L")).astype(int)
    (page,) = pypdfium2.PdfDocument(plate.save(tmp_path / "plate.pdf"))
    drawn = np.asarray(page.render(scale=96 / 72).to_pil().convert("L")).astype(int)
    assert drawn.shape == expected.shape
    for part in pictures(plate):
        box = (
            slice(part.top, part.top + part.image.size[1]),
            slice(part.left, part.left + part.image.size[0]),
        )
        assert np.abs(drawn[box] - expected[box]).max() <= 1


def test_the_plate_is_an_image_too(egg):
    plate = md.plate(egg, "lambert", background="transparent", **SMALL)
    assert (plate.image.size, plate.image.mode) == ((400, 500), "RGBA")


def test_auto_says_which_views_and_shapes(egg):
    plate = md.plate(egg, "lambert", views="top,right", caption="auto", names=["egg"], **SMALL)
    assert words(plate)[-1] == "egg: top, right"


# --- refusals -------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("chosen", "sentence"),
    [
        ({"views": "front,upside"}, "'upside' is no turn of the main view"),
        ({"views": "fron"}, "no view is called 'fron'"),
        ({"views": ""}, "a plate needs a view"),
        ({"views": [md.View((0, 0, 99), (70, 0, 0), (0, 1, 0), field_of_view=9)]}, "parallel view"),
        ({"methods": []}, "a plate needs a method"),
        ({"methods": "lambertt"}, "lambertt"),
        ({"lights": ["west", "studio"]}, r"not several \(studio.*lambert takes one.* for .*phong"),
        ({"light": "west"}, "a plate has lights, one or more: say lights= and not light="),
        ({"view": "top"}, "a plate has views, one or more"),
        ({"method": "toon"}, "a plate has methods, one or more"),
        ({"lights": ["northwest", "wst"]}, "no light is called 'wst'"),
        ({"size": None}, "a plate's page needs a size"),
        ({"size": (20, 20)}, "a page of 20x20 pixels has no room for 1 group of views"),
        ({"scale": "1:2"}, "a scale of 1:2 needs a size on paper"),
        ({"scale": "1:2", "size": "A4"}, "needs the unit of the coordinates"),
        ({"scale": "100:1", "size": "A4", "unit": "mm"}, "at 100:1 .* no room .*: 2[0-9]:1 fits"),
        ({"scale": "1:2", "pixels_per_unit": 3, "size": "A4", "unit": "mm"}, "give one of them"),
        ({"scale": "half", "size": "A4", "unit": "mm"}, "is not a scale on paper"),
        ({"refine": 2}, "refine makes other meshes"),
        ({"names": ["a", "b"]}, "there are 1 shapes and 2 names"),
        ({"options": {"lambert": {}, "toon": {"steps": 3}}}, "options are given for toon"),
        ({"colormap": "nonsense"}, "nonsense"),
        ({"caption": 3}, "caption=3 is no text"),
    ],
)  # fmt: skip
def test_what_can_t_be_a_plate_is_refused(egg, chosen, sentence):
    with pytest.raises(MeshdepictError, match=sentence):
        md.plate(egg, **{"methods": "lambert", **SMALL, **chosen})


def test_other_shapes_are_refused(egg):
    with pytest.raises(MeshdepictError, match="a plate needs a shape"):
        md.plate([])
    with pytest.raises(MeshdepictError, match="a MeshSpace can't be turned"):
        md.plate(md.scale_space(egg, scales=0))
    metres = md.Mesh(egg.vertices, egg.faces, length_unit="m")
    feet = md.Mesh(egg.vertices, egg.faces, length_unit="ft")
    with pytest.raises(MeshdepictError, match="measured in m and ft, and a plate has one scale"):
        md.plate([metres, feet], "lambert", **SMALL)


def test_a_real_flake_at_a_scale(data, tmp_path):
    """Its own extents, in millimetres, are those on paper at 1:2."""
    mesh = md.read_mesh(data / "mesh" / "flake1_152k.ply")
    plate = md.plate(
        mesh, "lambert", views="front,left,right,below", unit="mm", scale="1:2", size="A4", dpi=127,
        options={"lambert": {"exposure": 0.5}},
    )  # fmt: skip
    assert plate.pixels_per_unit == pytest.approx(2.5)
    wide, high, deep = np.ptp(mesh.vertices, axis=0) * 2.5
    for box, (across, down) in zip(
        boxes(plate), ((wide, high), (deep, high), (deep, high), (wide, deep)), strict=True
    ):
        assert (box[2] - box[0], box[3] - box[1]) == pytest.approx((across, down), abs=2)
