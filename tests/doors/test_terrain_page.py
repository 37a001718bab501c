"""docs/terrain.md: every command of it is run, and so is its Python."""

from __future__ import annotations

import re
import shlex

import numpy as np
import pytest
from house import ROOT

from meshdepict.cli import main
from meshdepict.samples import terrain
from meshdepict.shading import METHODS

PAGE = (ROOT / "docs" / "terrain.md").read_text(encoding="utf-8")
SIDE = 64  # cells, of six metres

VRT = """<VRTDataset rasterXSize="{0}" rasterYSize="{0}">
  <SRS>EPSG:3794</SRS>
  <GeoTransform>0, {1}, 0, 400, 0, -{1}</GeoTransform>
  <VRTRasterBand dataType="Float32" band="1">
    <SimpleSource>
      <SourceFilename relativeToVRT="1">dem.tif</SourceFilename>
      <SourceBand>1</SourceBand>
      <SrcRect xOff="0" yOff="0" xSize="{0}" ySize="{0}"/>
      <DstRect xOff="0" yOff="0" xSize="{0}" ySize="{0}"/>
    </SimpleSource>
  </VRTRasterBand>
</VRTDataset>"""


def commands() -> list[str]:
    """The page's commands, in order."""
    blocks = re.findall(r"^```sh\n(.*?)^```", PAGE, flags=re.S | re.M)
    return [line for block in blocks for line in block.splitlines()]


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """A folder with the files that the page names: a model, tiles of it, a virtual raster."""
    rasterio = pytest.importorskip("rasterio")
    folder = tmp_path_factory.mktemp("page")
    z, cell = terrain((SIDE, SIDE)).z, 400 / SIDE
    halves = {"dem": slice(None), "west": slice(0, SIDE // 2), "east": slice(SIDE // 2, SIDE)}
    for name, columns in halves.items():
        part = z[:, columns]
        with rasterio.open(
            folder / f"{name}.tif", "w", driver="GTiff", height=SIDE, width=part.shape[1], count=1,
            dtype="float32", crs="EPSG:3794",
            transform=rasterio.Affine(cell, 0, cell * (columns.start or 0), 0, -cell, 400),
        ) as file:  # fmt: skip
            file.write(part, 1)
    (folder / "mosaic.vrt").write_text(VRT.format(SIDE, cell))
    return folder


def test_every_command_runs(files, monkeypatch, capsys):
    """One after the other in one folder, as somebody who follows the page types them."""
    monkeypatch.chdir(files)
    assert len(commands()) > 20
    for command in commands():
        program, *words = shlex.split(command, comments=True)
        assert program == "meshdepict"
        assert main(words) == 0, (command, capsys.readouterr().err)
        target = words[words.index("-o") + 1] if "-o" in words else None
        assert target is None or (files / target).is_file(), command
    for name in ("dem-exaggerated.tif", "dem-hillshade.tif", "relief.pgw", "relief.prj"):
        assert (files / name).is_file()


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ("both.tif", "mosaic-relief.tif"),
        ("bounded.tif", "mosaic-relief.tif"),
        ("a.tif", "b.tif"),
    ],
)
def test_what_the_page_calls_the_same_is_the_same(files, monkeypatch, one, other):
    """Tiles and their mosaic; windows and the whole; one azimuth, whose elevation has no effect."""
    import rasterio

    monkeypatch.chdir(files)
    words = {
        "both.tif": ["west.tif", "east.tif"],
        "bounded.tif": ["dem.tif", "--max-memory", "2GB"],
        "mosaic-relief.tif": ["mosaic.vrt"],
        "a.tif": ["dem.tif", "--light", "315/45"],
        "b.tif": ["dem.tif", "--light", "northwest"],
    }
    pictures = []
    for name in (one, other):
        assert main(["relief", *words[name], "-o", name, "--force", "--quiet"]) == 0
        with rasterio.open(name) as file:
            pictures.append(file.read(1))
    np.testing.assert_array_equal(*pictures)


def test_its_python_runs(folder):
    (block,) = re.findall(r"^```python\n(.*?)^```", PAGE, flags=re.S | re.M)
    exec(compile(block, "terrain.md", "exec"), {})


def test_its_table_names_methods_and_options_that_are_there():
    from meshdepict.options import options_of

    rows = re.findall(r"^\| [^|]+ \| (`[^|]+`) \| ([^|]+) \|$", PAGE, flags=re.M)
    methods = [(re.findall(r"`(\w+)`", names), knobs) for names, knobs in rows]
    assert len(methods) > 8
    for names, knobs in methods:
        for name in names:
            options = set(options_of(METHODS[name]))
            named = set(re.findall(r"`(?:--set )?(\w+)`", knobs))
            assert named <= options, (name, named - options)


def test_its_pictures_are_there_and_small():
    pictures = re.findall(r"^!\[[^]]+\]\((\w+\.jpg)\)$", PAGE, flags=re.M)
    assert len(pictures) >= 3
    for name in pictures:
        assert (ROOT / "docs" / name).stat().st_size < 60_000
