"""Pictures as PNG, JPEG, SVG and PDF: one layout, sharp words, and where they come from inside."""

import base64
import io
import re
import xml.etree.ElementTree as ElementTree
import zlib

import numpy as np
import pypdfium2
import pytest
from PIL import Image

import meshdepict as md
from meshdepict import MeshdepictError, samples
from meshdepict.baking.targets import check_target
from meshdepict.drawing.figure import Figure
from meshdepict.drawing.framing import caption_lines
from meshdepict.drawing.page import Block, Page, Words, paint
from meshdepict.drawing.picture import caption_words
from meshdepict.drawing.picture_files import check_picture, read_picture_provenance, write_page

SUFFIXES = (".png", ".jpg", ".jpeg", ".svg", ".pdf")
SVG = "{http://www.w3.org/2000/svg}"
CAPTION = "Flake – ø 4 µm, “old” & <new>, $x$ (a) \\ b"


@pytest.fixture(scope="module")
def ball():
    return md.bake(samples.golf_ball(400, dimples=12), "half_lambert")


# --- reading them back, without this program ------------------------------------------------------


def streams(raw):
    """The contents of a PDF's compressed streams."""
    for part in re.findall(rb"stream\r?\n(.*?)\r?\nendstream", raw, re.DOTALL):
        try:
            yield zlib.decompress(part)
        except zlib.error:
            continue


def pdf(path):
    """The one page of a PDF, as pdfium, which browsers have, reads it."""
    (page,) = pypdfium2.PdfDocument(path)
    return page


def pdf_text(path):
    """What a search finds in a PDF."""
    return pdf(path).get_textpage().get_text_range()


def rectangles(root):
    return [dict(each.attrib) for each in root.iter(f"{SVG}rect")]


# --- the formats ----------------------------------------------------------------------------------


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_a_format_follows_from_the_suffix_and_says_where_it_comes_from(ball, tmp_path, suffix):
    path = ball.picture(
        tmp_path / f"ball{suffix}", size=(400, 300), caption=CAPTION, scale_bar=True
    )
    raw = path.read_bytes()
    magic = {".png": b"\x89PNG", ".svg": b"<?xml", ".pdf": b"%PDF"}.get(suffix, b"\xff\xd8\xff")
    assert raw.startswith(magic)
    assert read_picture_provenance(path) == ball.comments
    check_target(path, force=False)  # ours: it may be replaced
    ball.picture(path, size=(400, 300), caption=CAPTION, scale_bar=True)
    assert path.read_bytes() == raw


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_facts_are_read_back_whatever_they_say(tmp_path, suffix):
    facts = {"light": 'ø (a) \\n \\ ) <b> & "µ" 的', "method": "lambert"}
    page = Page((30, 20), (255, 255, 255), ())
    path = write_page(page, tmp_path / f"page{suffix}", facts)
    assert read_picture_provenance(path) == [f"meshdepict {k}: {v}" for k, v in facts.items()]


@pytest.mark.parametrize(
    ("name", "contents"),
    [
        ("a.svg", b'<svg xmlns="http://www.w3.org/2000/svg"/>'),
        ("b.svg", b'<metadata id="meshdepict">\nsomething else\n</metadata>'),
        ("c.pdf", b"%PDF-1.4\n/Keywords (gold, silver)\n%%EOF"),
        ("d.pdf", b""),
        ("e.jpg", b"no picture"),
    ],
)
def test_those_of_others_are_not_replaced(tmp_path, name, contents):
    (tmp_path / name).write_bytes(contents)
    assert read_picture_provenance(tmp_path / name) is None
    with pytest.raises(MeshdepictError, match="was not written by meshdepict"):
        check_target(tmp_path / name, force=False)
    assert (tmp_path / name).read_bytes() == contents


def test_a_jpeg_of_others_is_not_replaced(tmp_path):
    Image.new("RGB", (4, 4)).save(tmp_path / "other.jpg", comment=b"taken by a camera")
    with pytest.raises(MeshdepictError, match="was not written by meshdepict"):
        check_target(tmp_path / "other.jpg", force=False)


def test_a_jpeg_has_no_transparency(ball, tmp_path):
    with pytest.raises(MeshdepictError, match="a JPEG has no transparency"):
        ball.picture(tmp_path / "ball.jpeg", background="transparent")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("name", ["ball.tif", "ball", "ball.svgz"])
def test_other_formats_are_refused_before_any_work(name):
    with pytest.raises(MeshdepictError, match=r"end the name with \.png, \.jpg, \.svg or \.pdf"):
        check_picture(name)


def test_a_jpeg_is_the_png_but_for_what_its_compression_takes(ball, tmp_path):
    pictures = [
        np.asarray(Image.open(ball.picture(tmp_path / name, size=(90, 60))).convert("RGB")).astype(
            int
        )
        for name in ("ball.png", "ball.jpg")
    ]
    assert np.abs(pictures[0] - pictures[1]).mean() < 1.5


def test_sizes_on_paper_are_those_of_every_format(ball, tmp_path):
    said = {"size": "40x30mm", "dpi": 254}
    for name in ("ball.png", "ball.jpg"):
        with Image.open(ball.picture(tmp_path / name, **said)) as image:
            assert image.size == (400, 300)
            assert image.info["dpi"] == pytest.approx((254, 254), abs=0.02)
    root = ElementTree.parse(ball.picture(tmp_path / "ball.svg", **said)).getroot()
    assert (root.get("width"), root.get("height")) == ("40.0000mm", "30.0000mm")
    raw = ball.picture(tmp_path / "ball.pdf", **said).read_bytes()
    box = re.search(rb"/MediaBox \[ 0 0 ([\d.]+) ([\d.]+) \]", raw)
    assert [float(x) * 25.4 / 72 for x in box.groups()] == pytest.approx([40, 30], abs=1e-3)


def test_pixels_without_paper_are_those_of_screens(ball, tmp_path):
    root = ElementTree.parse(ball.picture(tmp_path / "ball.svg", size=(96, 48))).getroot()
    assert (root.get("width"), root.get("height")) == ("25.4000mm", "12.7000mm")


@pytest.mark.parametrize("background", ["white", "#204060", "transparent"])
def test_the_picture_inside_a_vector_file_is_that_of_the_png(ball, tmp_path, background):
    with Image.open(
        ball.picture(tmp_path / "ball.png", size=(60, 40), background=background)
    ) as png:
        expected = np.asarray(png)
    root = ElementTree.parse(
        ball.picture(tmp_path / "ball.svg", size=(60, 40), background=background)
    ).getroot()
    (image,) = root.iter(f"{SVG}image")
    code = image.get("href").partition("base64,")[2]
    inside = np.asarray(Image.open(io.BytesIO(base64.b64decode(code))))
    np.testing.assert_array_equal(inside, expected)
    page = pdf(ball.picture(tmp_path / "ball.pdf", size=(60, 40), background=background))
    ground = (0, 0, 0, 0) if background == "transparent" else (255, 255, 255, 255)
    drawn = page.render(scale=96 / 72, fill_color=ground, maybe_alpha=True).to_pil()
    drawn, expected = (
        np.asarray(image.convert("RGBA")) for image in (drawn, Image.fromarray(expected))
    )
    seen = expected[..., 3] > 0
    assert np.abs(drawn[seen].astype(int) - expected[seen]).max() <= 1
    assert (drawn[~seen][:, 3] == 0).all()


# --- bar and caption ------------------------------------------------------------------------------


@pytest.mark.parametrize("background", ["white", "black", "transparent"])
def test_words_can_be_searched_and_copied(ball, tmp_path, background):
    said = {"size": "9x7cm", "dpi": 100, "scale_bar": True, "unit": "µm", "caption": CAPTION,
            "background": background}  # fmt: skip
    root = ElementTree.parse(ball.picture(tmp_path / "ball.svg", **said)).getroot()
    assert [each.text for each in root.iter(f"{SVG}text")] == ["1 µm", CAPTION]
    text = pdf_text(ball.picture(tmp_path / "ball.pdf", **said))
    assert text.splitlines() == ["1 µm", CAPTION]


@pytest.mark.parametrize("suffix", [".svg", ".pdf"])
def test_the_bar_is_as_long_as_it_says(ball, tmp_path, suffix):
    """A bar of 0.5 units at 123.4 pixels each is 61.7 pixels long, to a hundredth."""
    path = ball.picture(
        tmp_path / f"ball{suffix}", pixels_per_unit=123.4, scale_bar=True, size=(400, 400),
        background="#ffffff",
    )  # fmt: skip
    if suffix == ".svg":
        blocks = rectangles(ElementTree.parse(path).getroot())
        widths = [float(each["width"]) for each in blocks if each["fill"] == "#000000"]
    else:
        (drawn,) = [s for s in streams(path.read_bytes()) if b" Do" in s]
        lines = re.findall(rb"([\d.]+) [\d.]+ m\n([\d.]+) [\d.]+ l", drawn)
        widths = [(float(b) - float(a)) * 96 / 72 for a, b in lines]
        widths = [width for width in widths if width < 399][:1]
    assert max(widths) == pytest.approx(61.7, abs=0.01)


def test_blocks_and_words_are_where_they_are_painted():
    page = Page((40, 30), (255, 255, 255), (Block(3, 4, 13, 9, (9, 8, 7)),))
    pixels = np.asarray(paint(page))
    there = (pixels == (9, 8, 7)).all(axis=2)
    assert there[4:9, 3:13].all()
    assert there.sum() == 50
    words = Page((200, 60), (255, 255, 255), (Words("HHH", 100, 30, 30, (0, 0, 0), anchor="m"),))
    rows, columns = np.nonzero(np.asarray(paint(words)).max(axis=2) < 128)
    assert columns.mean() == pytest.approx(100, abs=1.5)
    assert rows.mean() == pytest.approx(30, abs=4)


def test_a_caption_takes_room_of_its_own_and_wraps(ball, tmp_path):
    plain = np.asarray(Image.open(ball.picture(tmp_path / "a.png", size=(300, 300))))
    longer = "so many words " * 6
    root = ElementTree.parse(
        ball.picture(tmp_path / "b.svg", size=(300, 300), caption=longer)
    ).getroot()
    lines = [each.text for each in root.iter(f"{SVG}text")]
    assert len(lines) > 1
    assert " ".join(lines) == longer.strip()
    with_caption = np.asarray(
        Image.open(ball.picture(tmp_path / "b.png", size=(300, 300), caption=longer))
    )
    assert with_caption.shape == plain.shape
    (image,) = root.iter(f"{SVG}image")
    free = int(image.get("height"))
    assert all(float(each.get("y")) > free for each in root.iter(f"{SVG}text"))
    assert (with_caption[free:] < 128).any()
    clear = ball.picture(
        tmp_path / "c.png", size=(300, 300), caption=longer, background="transparent"
    )
    assert (np.asarray(Image.open(clear))[:free, :, 3] > 0).any()


def test_a_view_of_one_s_own_shows_as_much_above_a_caption(tmp_path):
    view = md.View((0, 0, 9), (0, 0, 0), (0, 1, 0), parallel_scale=1.0)
    baked = md.bake(samples.sphere(400), "lambert", light="front", view=view)
    path = baked.picture(tmp_path / "ball.png", size=(300, 300), caption="A ball")
    dark = np.asarray(Image.open(path)).min(axis=2) < 250
    rows = np.flatnonzero(dark.any(axis=1))
    root = ElementTree.parse(
        baked.picture(tmp_path / "ball.svg", size=(300, 300), caption="A ball")
    ).getroot()
    free = int(next(root.iter(f"{SVG}image")).get("height"))
    assert rows[0] <= 2
    assert np.ptp(rows[rows < free]) == pytest.approx(free, abs=4)


def test_a_caption_says_method_light_and_widths_when_asked(ball, tmp_path):
    baked = md.bake(ball.shape, "exaggerated", light="east", scales=3)
    root = ElementTree.parse(
        baked.picture(tmp_path / "b.svg", size=(900, 300), caption="auto")
    ).getroot()
    (text,) = [each.text for each in root.iter(f"{SVG}text")]
    found = re.fullmatch(r"exaggerated, light east, 3 widths ([\d.]+) to ([\d.]+)", text)
    widths = [float(number) for number in found.groups()]
    assert widths == pytest.approx(baked.space.widths[[1, -1]], rel=5e-3)
    root = ElementTree.parse(
        baked.picture(tmp_path / "b.svg", size=(900, 300), caption="auto", unit="cm")
    ).getroot()
    assert [each.text for each in root.iter(f"{SVG}text")] == [f"{text} cm"]


@pytest.mark.parametrize(("size", "words"), [((60, 60), 50), (None, 2_000)])
def test_a_caption_that_leaves_no_room_is_refused(ball, tmp_path, size, words):
    with pytest.raises(MeshdepictError, match="the caption takes more than half of a picture"):
        ball.picture(tmp_path / "b.png", size=size, caption="word " * words)
    assert not list(tmp_path.iterdir())


def test_a_picture_at_a_scale_grows_for_its_caption(ball, tmp_path):
    heights = []
    for caption in ("", "one line", "very many words " * 20):
        path = ball.picture(tmp_path / "b.png", pixels_per_unit=50, caption=caption)
        with Image.open(path) as image:
            heights.append(image.size[1])
    assert heights[0] < heights[1] < heights[2]


def test_a_word_longer_than_a_line_is_cut(ball, tmp_path):
    word = "W" * 60
    root = ElementTree.parse(
        ball.picture(tmp_path / "b.svg", size=(300, 300), caption=word)
    ).getroot()
    lines = [each.text for each in root.iter(f"{SVG}text")]
    assert len(lines) > 1
    assert "".join(lines) == word


ODD = (
    "a \udcff b", "a\x00b\x1b[31m", "find \U0001f600 的", "\u202eabc שלום", "one\n\n two\r\nthree",
    "x" * 900, "   ", "100 % {x} %s $ ^_ \\alpha &amp; ]]>", "e\u0301 ﬁ", "\ue000 \ufffe \uffff",
)  # fmt: skip


@pytest.mark.parametrize("suffix", SUFFIXES)
@pytest.mark.parametrize("text", ODD)
def test_any_text_can_be_a_caption_and_a_fact(tmp_path, suffix, text):
    """Names of files are somebody else's words, and need not even be text."""
    figure = Figure(size=(400, 300), caption=text)
    words = caption_words(caption_lines(figure, 400, 12), 9, 9, 12, figure)
    page = Page((400, 300), (255, 255, 255), tuple(words))
    path = write_page(page, tmp_path / f"page{suffix}", {"light": text})
    assert read_picture_provenance(path)[0].startswith("meshdepict light: ")
    if suffix == ".svg":
        texts = [each.text for each in ElementTree.parse(path).getroot().iter(f"{SVG}text")]
        assert "".join(texts).isprintable() or "\ue000" in text or "\U0001f600" in text
        assert len(texts) == len(words)
    elif suffix == ".pdf":
        pdf(path)


def test_volumes_are_written_in_every_format(tmp_path):
    baked = md.bake_volume(samples.ct_phantom((24, 24, 24)), "lambert")
    for suffix in SUFFIXES:
        path = baked.picture(
            tmp_path / f"ct{suffix}", size=(60, 60), scale_bar=True, caption="a head"
        )
        assert read_picture_provenance(path) == baked.comments
    root = ElementTree.parse(tmp_path / "ct.svg").getroot()
    assert [each.text for each in root.iter(f"{SVG}text")][1:] == ["a head"]


def test_the_command_line_writes_what_the_suffix_says(run, ball_ply, folder):
    for suffix in SUFFIXES:
        words = ["bake", "ball.ply", "-m", "lambert", "--size", "200x100", "--caption", "auto",
                 "--scale-bar", "--background", "ivory", "--picture", f"a{suffix}"]  # fmt: skip
        assert run(*words)[0] == 0
        assert run(*words)[0] == 0  # ours: replaced
        assert read_picture_provenance(folder / f"a{suffix}")
    assert run("bake", "ball.ply", "--picture", "b.jpg", "--background", "transparent")[0] == 2
    assert not (folder / "b.jpg").exists()
    (folder / "c.pdf").write_bytes(b"%PDF-1.4 of somebody else")
    status, _, (line,) = run("bake", "ball.ply", "-m", "lambert", "--picture", "c.pdf")
    assert status == 2
    assert "c.pdf exists and was not written by meshdepict" in line
