"""The manual: its Python runs, its commands run, its method pages cover what there is."""

from __future__ import annotations

import re
import shlex
import tomllib

import numpy as np
import pytest
from house import ROOT
from textured_shapes import globe, picture

from meshdepict import samples
from meshdepict.baking.textures import bake_texture
from meshdepict.cli import main
from meshdepict.io import write_mesh
from meshdepict.options import options_of
from meshdepict.shading import METHODS, declaration

DOCS = ROOT / "docs"
PAGES = [DOCS / "index.md", DOCS / "start.md", *sorted((DOCS / "howto").glob("*.md"))]
ELSEWHERE = ("--help", "--install-completion")
SAID = tomllib.loads((DOCS / "methods" / "pages.toml").read_text(encoding="utf-8"))
NRRD = (
    "NRRD0004\ntype: short\ndimension: 3\nsizes: {0} {0} {0}\nencoding: raw\nendian: little\n"
    "spacings: 10 10 10\n\n"
)


def blocks(page, language):
    return re.findall(rf"^```{language}\n(.*?)^```", page.read_text("utf-8"), flags=re.S | re.M)


def commands():
    """Every line of the program, but those that change the user's shell or open windows."""
    for page in PAGES:
        for block in blocks(page, "sh"):
            for line in block.splitlines():
                words = shlex.split(line, comments=True)
                opens = words[1:2] == ["view"] or words[-1:] in ([word] for word in ELSEWHERE)
                if words[:1] == ["meshdepict"] and not opens:
                    yield pytest.param(words[1:], id=f"{page.stem}: {line[:60]}")


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """The files that the pages speak of."""
    folder = tmp_path_factory.mktemp("manual")
    for name in ("scan.ply", "stone.ply", "reduced.ply", "bone.ply"):
        write_mesh(folder / name, samples.inscription(600, text="M"))
    (folder / "finds").mkdir()
    for name, make in (("coin", samples.coin), ("core", samples.knapped_core)):
        write_mesh(folder / "finds" / f"{name}.ply", make(400))
    find = bake_texture(globe(6, base=picture([[[200, 100, 50]]])), "lambert", size=64)
    find.save(folder / "find.obj")
    head = samples.ct_phantom((24, 24, 24)).values.astype("<i2")
    (folder / "head.nrrd").write_bytes(NRRD.format(24).encode() + head.tobytes(order="F"))
    (folder / "look.toml").write_text('method = "lambert"\n', "utf-8")
    rasterio = pytest.importorskip("rasterio")
    z = samples.terrain((48, 48)).z
    with rasterio.open(
        folder / "dem.tif", "w", driver="GTiff", height=48, width=48, count=1, dtype="float32",
        crs="EPSG:3794", transform=rasterio.Affine(8, 0, 0, 0, -8, 400),
    ) as file:  # fmt: skip
        file.write(z, 1)
    return folder


@pytest.mark.parametrize("words", [*commands()])
def test_a_command_of_the_manual_runs(words, files, monkeypatch, capsys):
    monkeypatch.chdir(files)
    words = [
        part
        for word in words
        for part in (sorted(map(str, files.glob(word))) if "*" in word else [word])
    ]
    if words[0] == "texture":
        words = [word if word != "2048" else "256" for word in words]
    quick = ["--force", "--quiet"] if words[0] not in ("info", "methods") else []
    assert main([*words, *quick]) == 0, capsys.readouterr().err
    if "-o" in words:
        assert (files / words[words.index("-o") + 1]).exists()


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_the_python_of_a_page_runs(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for block in blocks(page, "python"):
        exec(compile(block, page.name, "exec"), {})


def test_every_method_has_a_page_of_what_there_is():
    assert set(SAID) == set(METHODS)
    for name, said in SAID.items():
        assert said["equation"], name
        assert said["limits"].endswith("."), name
        options = options_of(METHODS[name])
        for option, values in said.get("strips", {}).items():
            assert len(values) > 1, (name, option)
            assert option in options, (name, option)


def test_equations_can_be_drawn():
    converter = pytest.importorskip("latex2mathml.converter")
    for name, said in SAID.items():
        for line in said["equation"]:
            assert "<math" in converter.convert(line), name


def test_the_samples_of_pages_are_there():
    known = {said["sample"] for said in SAID.values()}
    assert known <= set(samples.__all__)
    assert all(
        np.isfinite(getattr(samples, name)(100).vertices).all() for name in known - {"terrain"}
    )


def test_the_citation_is_of_this_version_and_names_the_four_papers():
    text = (ROOT / "CITATION.cff").read_text("utf-8")
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    assert re.search(r"^version: (.+)$", text, flags=re.M)[1] == project["version"]
    assert re.search(r"^license: (.+)$", text, flags=re.M)[1] == project["license"]
    titles = re.findall(r'^    title: "?([^"\n]+)', text, flags=re.M)
    assert len(titles) == 4
    for method in ("exaggerated", "light_warping", "radiance_scaling", "light_alignment"):
        year = re.search(r"\d{4}", declaration(METHODS[method]).source)[0]
        assert f"    year: {year}\n" in text, method


def test_every_picture_of_the_manual_has_words():
    for page in DOCS.rglob("*.md"):
        if "_build" not in page.parts:
            assert not re.findall(r"!\[\s*\]\(", page.read_text("utf-8")), page
