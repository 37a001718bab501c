"""Comparing methods: scores as the score function gives them, one scale space, sheet and page."""

import csv
import html.parser
from pathlib import Path

import numpy as np
import pytest
from chromium import tab  # noqa: F401
from PIL import Image

import meshdepict as md
from meshdepict import congruence
from meshdepict.congruence import comparison
from meshdepict.congruence import report as comparison_report
from meshdepict.congruence.comparison import compare
from meshdepict.errors import MeshdepictError
from meshdepict.io import write_mesh
from meshdepict.scales.making import scale_space
from meshdepict.shapes.gbuffer import GBuffer

SIZE = (120, 90)


@pytest.fixture(scope="module")
def found(ball):
    return compare(ball, ("lambert", "exaggerated"), lights=["front", "east"], size=SIZE, scales=2)


@pytest.fixture
def small(folder):
    write_mesh("ball.ply", md.samples.golf_ball(400, dimples=12))
    return ["compare", "ball.ply", "-m", "lambert", "--light", "north", "--size", "80x80"]


def test_scores_are_those_of_the_score_function(ball, found):
    buffer = GBuffer.of(ball, "front", size=SIZE)
    space = scale_space(ball, scales=2, ratio=1.7)
    frontal = buffer.image(buffer.sample(md.shading.lambert(space, "front")))
    for row, name in enumerate(found.methods):
        for column, light in enumerate(("front", "east")):
            given = {"exaggeration": 40} if name == "exaggerated" else {}
            values = buffer.image(buffer.sample(md.shading.METHODS[name](space, light, **given)))
            expected = congruence.score(values, buffer.depth, buffer.mask, reference=frontal)
            assert found.scores[row, column] == pytest.approx(expected, abs=1e-6)
    assert found.pictures.shape == (2, 2, 90, 120, 3)
    assert found.worst == int(np.argmin(found.scores[0]))


def test_pictures_are_the_bake_seen(ball, found):
    buffer = GBuffer.of(ball, "front", size=SIZE)
    baked = md.bake(ball, "lambert", light="east")
    seen = buffer.image(buffer.sample(baked.intensity))
    levels = np.rint(255 * md.color.linear_to_srgb(seen[buffer.mask]))
    shown = found.pictures[0, 1][buffer.mask][:, 0]
    assert np.abs(shown.astype(int) - levels).max() <= 1
    assert (found.pictures[0, 1][~buffer.mask] == (198, 205, 214)).all()


def test_all_methods_share_one_scale_space(ball, monkeypatch):
    made = []

    def counted(*given, **more):
        made.append(more)
        return scale_space(*given, **more)

    monkeypatch.setattr(comparison, "scale_space", counted)
    calls = []
    compare(
        ball, lights=["north"], size=(60, 60), scales=2,
        progress=lambda done, total: calls.append(done / total),
    )  # fmt: skip
    assert len(made) == 1
    assert calls == sorted(calls)
    assert calls[-1] == 1


@pytest.mark.parametrize("per_pixel", [False, True])
def test_only_those_widths_are_smoothed_that_one_of_the_methods_reads(ball, monkeypatch, per_pixel):
    spaces = []

    def kept(*given, **more):
        spaces.append(scale_space(*given, **more))
        return spaces[-1]

    monkeypatch.setattr(comparison, "scale_space", kept)
    for methods, options, widths in (
        (["lambert", "unsharp_masking"], {}, 0),
        (["lambert", "light_warping", "radiance_scaling"], {}, 1),
        (["light_warping"], {"light_warping": {"scale": 2}}, 2),
        (["light_alignment", "lambert"], {"light_alignment": {"strength": 0}}, 0),
        (["light_alignment"], {"light_alignment": {"strength": (0.4, 0.4, 0, 0, 0, 0)}}, 2),
        (["normal_enhancement", "light_warping"], {}, 6),
    ):
        compare(
            ball, methods, options=options, lights=["north"], size=(40, 40), per_pixel=per_pixel
        )
        assert spaces.pop().smoothed == set(range(widths + 1))


def test_without_lights_the_papers_21_are_used(ball):
    found = compare(ball, ["lambert"], size=(60, 60), scales=0)
    assert [light.name for light in found.lights] == [f"#{i}" for i in range(1, 22)]


def test_pixels_are_shaded_when_asked_for(ball, found):
    exact = compare(
        ball, ("lambert", "exaggerated"), lights=["front", "east"], size=SIZE, scales=2,
        per_pixel=True,
    )  # fmt: skip
    assert exact.scores.shape == found.scores.shape
    # Lambert has no scales: at pixels and at vertices nearly the same picture.
    difference = np.abs(exact.pictures[0].astype(int) - found.pictures[0])
    assert np.quantile(difference, 0.9) <= 2
    assert (exact.pictures[1] != found.pictures[1]).any()


def test_values_of_all_methods_can_be_scored_alike(ball, found):
    def scores(scored):
        again = compare(
            ball, ("lambert", "exaggerated"), lights=["front", "east"], size=SIZE, scales=2,
            scored=scored,
        )  # fmt: skip
        np.testing.assert_array_equal(again.pictures, found.pictures)
        assert again.settings["scored"] == scored
        return again.scores

    np.testing.assert_array_equal(scores("declared"), found.scores)
    linear, display = scores("linear"), scores("display")
    np.testing.assert_array_equal(linear[0], found.scores[0])  # Lambert's values are linear
    assert (linear[1] != found.scores[1]).all()
    assert (display[0] != found.scores[0]).all()


@pytest.mark.parametrize("per_pixel", [False, True])
def test_the_flow_of_the_slope_is_that_of_the_original_normals(ball, per_pixel):
    found = compare(
        ball, ["lambert"], lights=["east"], size=SIZE, scales=0, flow="slope", per_pixel=per_pixel
    )
    assert found.settings["flow"] == "slope"
    buffer = GBuffer.of(ball, "front", size=SIZE)
    space = scale_space(buffer if per_pixel else ball, scales=0)

    def shaded(light):
        values = md.shading.lambert(space, light)
        return buffer.image(values if per_pixel else buffer.sample(values))

    expected = congruence.score(
        shaded("east"), buffer.depth, buffer.mask, reference=shaded("front"), flow="slope",
        normals=buffer.image(buffer.normals),
    )  # fmt: skip
    assert found.scores[0, 0] == pytest.approx(expected, abs=1e-5)


def test_options_reach_their_methods(ball, found):
    more = compare(
        ball, ("lambert", "exaggerated"), lights=["front", "east"], size=SIZE, scales=2,
        options={"exaggerated": {"exaggeration": 60}},
    )  # fmt: skip
    np.testing.assert_array_equal(more.pictures[0], found.pictures[0])
    assert (more.pictures[1] != found.pictures[1]).any()
    assert more.options[1] == {"exaggeration": 60}


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        ({"methods": ()}, "at least one method"),
        ({"lights": ()}, "at least one light"),
        ({"scored": "seen"}, "scored='seen' is none of declared, linear, display"),
        ({"flow": "tilt"}, "flow='tilt' is none of depth, slope"),
        ({"methods": ("lamber",)}, "did you mean 'lambert'"),
        ({"options": {"toon": {}}}, "options for 'toon', which isn't compared"),
        ({"options": {"lambert": {"wrong": 1}}}, "lambert has no option 'wrong'"),
        ({"view": md.View((9, 9, 9), (9, 9, 0), (0, 1, 0), parallel_scale=1)}, "shows nothing"),
    ],
)
def test_what_cannot_be_compared_gets_a_sentence(ball, options, sentence):
    with pytest.raises(MeshdepictError, match=sentence):
        compare(ball, **{"methods": ("lambert",), **options})


def test_lambert_drops_where_the_light_grazes_and_exaggerated_does_not(bunny):
    found = compare(bunny, ("lambert", "exaggerated", "light_alignment"), size=(300, 300))
    dark, sides = [5, 6, 7, 8, 19, 20], [0, 1, 13, 14]
    drop = found.scores[:, sides].mean(axis=1) - found.scores[:, dark].mean(axis=1)
    assert drop[0] > 1.5 * max(drop[1:])
    assert min(found.means[1:]) > found.means[0] + 0.1


# --- on paper -------------------------------------------------------------------------------------


def test_the_table_has_every_score(found, tmp_path):
    path = comparison_report.save_table(found, tmp_path / "scores.csv")
    heading, *rows = csv.reader(path.read_text().splitlines())
    assert heading[:2] == ["method", "mean"]
    assert heading[2:] == ["front (azimuth 0 elevation 90)", "east (azimuth 90 elevation 35)"]
    for row, name, scores in zip(rows, found.methods, found.scores, strict=True):
        assert row[0] == name
        np.testing.assert_allclose([float(x) for x in row[2:]], scores, atol=5e-4)


def test_the_sheet_has_a_cell_for_every_picture(found, tmp_path):
    page = comparison_report.contact_sheet(found, cell=60)
    colors = np.asarray(page)
    assert (colors != 255).any(axis=(1, 2)).sum() >= 2 * 45  # two rows of 60 × 45
    assert (colors != 255).any(axis=(0, 2)).sum() >= 2 * 60
    path = comparison_report.save_sheet(found, tmp_path / "sheet.png")
    with Image.open(path) as image:
        assert "exaggerated" in image.text["meshdepict comparison"]
        assert image.text["meshdepict scores"] == "scored=declared flow=depth"


def test_many_lights_wrap_to_a_readable_width(found):
    from dataclasses import replace

    often = replace(
        found, lights=found.lights * 15, scores=np.tile(found.scores, 15),
        pictures=np.tile(found.pictures, (1, 15, 1, 1, 1)),
    )  # fmt: skip
    once, sheet = (comparison_report.contact_sheet(each, cell=100) for each in (found, often))
    assert once.width < sheet.width <= 1600
    assert sheet.height >= 2 * once.height
    narrow = comparison_report.contact_sheet(often, cell=20)
    assert narrow.height == comparison_report.contact_sheet(found, cell=20).height


@pytest.mark.browser
@pytest.mark.parametrize("width", [400, 1200])
def test_the_page_fits_telephones_and_screens(found, tmp_path, tab, width):  # noqa: F811
    path = comparison_report.save_page(found, tmp_path / "page.html", title="a" * 80)
    tab.resize(width, 800, mobile=width == 400)
    tab.open(path.as_uri())
    assert tab.js("document.documentElement.scrollWidth") <= width
    text = tab.js("document.querySelector('table').innerText")
    assert "90°" in text
    assert "35°" in text


def test_the_page_needs_nothing_from_elsewhere(found, tmp_path):
    path = comparison_report.save_page(found, tmp_path / "page.html", title="<script>alert(1)")
    text = path.read_text()
    assert "<script" not in text

    class Links(html.parser.HTMLParser):
        found: list[str] = []  # noqa: RUF012

        def handle_starttag(self, tag, attributes):
            self.found += [value for name, value in attributes if name in ("src", "href")]

    Links().feed(text)
    assert len(Links.found) == 4  # plot, sheet, two maps
    assert all(link.startswith("data:image/") for link in Links.found)


@pytest.mark.parametrize(
    "save",
    [comparison_report.save_sheet, comparison_report.save_table, comparison_report.save_page],
)
def test_other_suffixes_are_refused(found, tmp_path, save):
    with pytest.raises(MeshdepictError, match="end the name with"):
        save(found, tmp_path / "file.txt")
    assert list(tmp_path.iterdir()) == []


# --- the command ----------------------------------------------------------------------------------


def test_the_command_writes_what_it_is_asked_for(run, small):
    status, out, err = run(*small, "--csv", "s.csv", "--html", "s.html")
    assert (status, err) == (0, [])
    assert out[0].startswith("lambert")
    assert "ball-compare.png, s.csv, s.html: mean congruence, 1 light" in out[1]
    assert all(Path(name).exists() for name in ("ball-compare.png", "s.csv", "s.html"))
    assert run(*small, "--csv", "s.csv", "--html", "s.html")[0] == 0  # its own files again


def test_the_command_scores_what_it_is_told_to(run, small):
    means = {}
    for flow in ("depth", "slope"):
        status, out, _ = run(*small, "--flow", flow, "--scored", "display", "--html", "s.html")
        assert status == 0
        means[flow] = out[0]
        assert f"<dt>scores</dt><dd>scored=display flow={flow}</dd>" in Path("s.html").read_text()
    assert means["depth"] != means["slope"]
    status, _, err = run(*small, "--flow", "tilt")
    assert status == 2
    assert "tilt" in err[-1]


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["-o", "x.jpg"], "-o x.jpg: end the name with .png"),
        (["--csv", "mine.csv"], "mine.csv exists and was not written by meshdepict"),
        (["-o", "nowhere/x.png"], "there is no folder nowhere"),
        (["--set", "exaggeration=3"], "wants METHOD.name=value"),
        (["--set", "lambert.x=3"], "lambert has no option 'x'"),
        (["--set", "toon.bins=3"], "options for 'toon', which isn't compared"),
    ],
)
def test_wrong_words_get_one_line_and_write_nothing(run, small, words, sentence):
    Path("mine.csv").write_text("a,b\n")
    status, out, err = run(*small, *words)
    assert (status, out, len(err)) == (2, [], 1)
    assert sentence in err[0]
    assert not list(Path().glob("*.png"))
    assert Path("mine.csv").read_text() == "a,b\n"


def test_a_folder_takes_the_sheet(run, small):
    Path("sheets").mkdir()
    assert run(*small, "-o", "sheets")[0] == 0
    assert Path("sheets/ball-compare.png").exists()


# --- terrain --------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def hill():
    y, x = np.mgrid[:60, :60] + 0.0
    return md.HeightField(8 * np.exp(-((x - 30) ** 2 + (y - 30) ** 2) / 200))


def test_terrain_is_compared_on_its_map(hill):
    found = md.compare(
        hill, ["lambert", "exaggerated"], lights=["northwest"], size=(120, 120), z_factor=2
    )
    assert found.view.name == "top"
    assert found.shape.z_factor == 2
    assert found.settings["z_factor"] == 2
    assert found.options[1]["one_light"] is True
    mesh = md.compare(
        hill.raised(2).mesh, ["lambert"], lights=["northwest"], size=(120, 120), view="top", up="z"
    )
    assert np.abs(found.pictures[0].astype(int) - mesh.pictures[0]).mean() < 1
    for row, method in enumerate(found.methods):
        baked = md.bake(hill, method, z_factor=2, scales=6, ratio=1.7)
        middle = baked.shape.image(baked.colors)[25:35, 25:35].astype(int)
        shown = found.pictures[row, 0][51:69, 51:69].astype(int)  # 120 pixels show 61.95 m
        assert np.abs(shown.mean(axis=(0, 1)) - middle.mean(axis=(0, 1))).max() < 3


def test_terrain_is_compared_pixel_by_pixel_as_any_picture(hill):
    found = md.compare(hill, ["exaggerated"], lights=["northwest"], size=(120, 120), per_pixel=True)
    assert "one_light" not in found.options[0]
    assert 0 < found.scores[0, 0] <= 1


def test_a_mesh_has_no_factor_of_heights(ball):
    with pytest.raises(MeshdepictError, match="z_factor is about a height field"):
        md.compare(ball, ["lambert"], z_factor=2)


def test_a_comparison_is_a_line_at_the_prompt(found):
    text = repr(found)
    assert len(text) < 400
    best = max(zip(found.means, found.methods, strict=True))
    assert f"lights: {best[1]} {best[0]:.3f}" in text
