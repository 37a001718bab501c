"""MTL: the colours, pictures and normal maps of an OBJ file's materials."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath

import numpy as np
from numpy.typing import NDArray

from meshdepict.color.srgb import srgb_to_linear
from meshdepict.files.companions import Companions
from meshdepict.files.reach import inside
from meshdepict.io.texture_files import file_fault

__all__ = ["Library", "Map", "Material", "libraries", "with_companions"]

Floats = NDArray[np.float64]

_MOST = 1 << 24  # bytes of a library that are read
_LIBRARY = re.compile(rb"(?m)^[ \t]*mtllib[ \t]+([^\r\n#]*[^\r\n#\s])")
_WORD = re.compile(r"\S+")
# Options of maps, and how many words follow; -o, -s and -t have up to three numbers.
_OPTIONS = {
    "-blendu": 1, "-blendv": 1, "-boost": 1, "-mm": 2, "-texres": 1, "-clamp": 1, "-bm": 1,
    "-imfchan": 1, "-type": 1, "-cc": 1, "-colorspace": 1,
}  # fmt: skip
_VECTORS = ("-o", "-s", "-t")
_BASE = ("map_kd",)
_NORMAL = ("norm", "map_kn")
_BUMP = ("map_bump", "bump")
_OTHERS = ("disp", "decal", "refl")


@dataclass(frozen=True)
class Map:
    """A picture as a material names it, with how it is laid.

    ``span`` says where its name stands in the library, in characters.
    """

    name: str
    span: tuple[int, int]
    scale: tuple[float, float] = (1.0, 1.0)
    offset: tuple[float, float] = (0.0, 0.0)
    strength: float = 1.0
    clamp: bool = False
    fault: str = ""

    @property
    def wrap(self) -> tuple[str, str]:
        """What lies beyond the picture's edges."""
        return ("clamp", "clamp") if self.clamp else ("repeat", "repeat")

    def moved(self, uv: Floats) -> Floats:
        """Return coordinates where the map's options take them."""
        return uv * self.scale + self.offset


@dataclass
class Material:
    """What is read of a material; ``bump`` may turn out to be a normal map."""

    color: tuple[float, float, float] | None = None
    base: Map | None = None
    normal: Map | None = None
    bump: Map | None = None

    @property
    def factor(self) -> tuple[float, float, float, float]:
        """What a picture, or white, is multiplied by, linear.

        Kd, which are display colours. Beside a picture, greys are what programs write by habit:
        Blender 0.8, trimesh 0.4, others 0, and all of them mean the picture alone.
        """
        if self.color is None or (self.base is not None and len(set(self.color)) == 1):
            return 1.0, 1.0, 1.0, 1.0
        red, green, blue = (float(c) for c in srgb_to_linear(np.clip(self.color, 0, 1)))
        return red, green, blue, 1.0


@dataclass
class Library:
    """A material library: its text, its materials by name and all maps in it."""

    name: str  # as the OBJ file names it
    text: str = ""
    materials: dict[str, Material] = field(default_factory=dict)
    maps: list[Map] = field(default_factory=list)
    fault: str = ""

    def beside(self, name: str) -> str:
        """Return what a file that the library names is called from the OBJ file's folder."""
        parent = PurePosixPath(self.name.replace("\\", "/")).parent
        return name if parent == PurePosixPath() else f"{parent}/{name}"


def libraries(data: bytes, folder: Path) -> list[Library]:
    """Return the libraries that an OBJ file names, read as far as they can be.

    A line may name several; where a file is called like all of it, that is meant.
    """
    found: dict[str, Library] = {}
    for match in _LIBRARY.finditer(data):
        line = _text(match[1])
        names = [line] if not file_fault(folder, line) else line.split()
        for name in names:
            if name not in found:
                found[name] = _library(folder, name)
    return list(found.values())


def _text(data: bytes) -> str:
    """Return text whose bytes name files, whatever their encoding."""
    return data.decode("utf-8", "surrogateescape")


def _library(folder: Path, name: str) -> Library:
    library = Library(name, fault=file_fault(folder, name, "material library"))
    if library.fault:
        return library
    try:
        with inside(folder, name, "material library").open("rb") as file:
            library.text = _text(file.read(_MOST))
    except OSError as error:
        library.fault = f"names the material library {name!r}, which can't be read ({error})"
        return library
    material = Material()
    for line in re.finditer(r"[^\r\n]+", library.text):
        words = line[0].split(None, 1)
        if len(words) < 2 or words[0].startswith("#"):
            continue
        keyword, rest = words[0].lower(), words[1].rstrip()
        start = line.start() + line[0].index(words[1], line[0].index(words[0]) + len(words[0]))
        if keyword == "newmtl":
            material = library.materials.setdefault(rest, Material())
        elif keyword == "kd":
            material.color = _color(rest)
        elif keyword.startswith("map_") or keyword in (*_NORMAL, *_BUMP, *_OTHERS):
            laid = _map(rest, start)
            library.maps.append(laid)
            if keyword in _BASE:
                material.base = laid
            elif keyword in _NORMAL:
                material.normal = laid
            elif keyword in _BUMP:
                material.bump = laid
    return library


def _color(rest: str) -> tuple[float, float, float] | None:
    """Return three numbers, or None for a spectrum, CIEXYZ and nonsense."""
    try:
        numbers = [float(word) for word in rest.split()[:3]]
    except ValueError:
        return None
    if not numbers or not all(map(math.isfinite, numbers)):
        return None
    red, green, blue = (numbers * 3)[:3] if len(numbers) == 1 else (*numbers, 0, 0)[:3]
    return red, green, blue


def _map(rest: str, start: int) -> Map:
    """Return what a map's statement says behind its keyword: options, and the rest is a name."""
    words = list(_WORD.finditer(rest))
    at = 0
    options: dict[str, list[str]] = {}
    fault = ""
    while at < len(words) and re.fullmatch(r"-[A-Za-z]+", words[at][0]):
        option = words[at][0].lower()
        at += 1
        if option in _VECTORS:
            count = 0
            while count < 3 and at + count < len(words) - 1 and _number(words[at + count][0]):
                count += 1
        elif option in _OPTIONS:
            count = _OPTIONS[option]
        else:
            fault = f"has a texture with the option {option!r:.40}, which MTL doesn't know"
            break
        options[option] = [word[0] for word in words[at : at + count]]
        at += count
    begin = words[at].start() if at < len(words) else len(rest)
    name = rest[begin:]
    if len(name) > 2 and name[0] == name[-1] == '"':
        begin, name = begin + 1, name[1:-1]
    if not name and not fault:
        fault = "has a material that names no picture for its map"
    numbers = {key: [float(word) for word in options.get(key, ())] for key in _VECTORS}
    strength = options.get("-bm", ["1"])
    try:
        bump = float(strength[0]) if strength else 1.0
    except ValueError:
        bump = 1.0
    return Map(
        name,
        (start + begin, start + begin + len(name)),
        _pair(numbers["-s"], 1.0),
        _pair(numbers["-o"], 0.0),
        bump if math.isfinite(bump) else 1.0,
        options.get("-clamp", ["off"])[:1] == ["on"],
        fault,
    )


def _number(word: str) -> bool:
    try:
        return math.isfinite(float(word))
    except ValueError:
        return False


def _pair(numbers: list[float], usual: float) -> tuple[float, float]:
    u, v = (*numbers, *[usual] * 2)[:2]
    return u, v


# --- in another folder ----------------------------------------------------------------------------


def with_companions(data: bytes, folder: Path, companions: Companions) -> bytes:
    """Let an OBJ file's libraries and their pictures come along; return the file naming them.

    Parameters
    ----------
    data : bytes
        The OBJ file.
    folder : Path
        Of it.
    companions : Companions
    """
    for library in libraries(data, folder):
        if library.fault:
            continue
        text, shift = library.text, 0
        for laid in library.maps:
            name = library.beside(laid.name)
            called = companions.copied(folder, name)
            if called == name.replace("\\", "/") or called == name:
                continue
            short = called.removeprefix(library.beside(""))
            begin, end = (at + shift for at in laid.span)
            text = text[:begin] + short + text[end:]
            shift += len(short) - (end - begin)
        if text == library.text:
            named = companions.copied(folder, library.name)
        else:
            named = companions.written(library.name, text.encode("utf-8", "surrogateescape"))
        if named not in (library.name, Path(library.name).as_posix()):
            data = _renamed(data, library.name, named)
    return data


def _renamed(data: bytes, name: str, called: str) -> bytes:
    old, new = (each.encode("utf-8", "surrogateescape") for each in (name, called))

    def edit(match: re.Match[bytes]) -> bytes:
        words = [new if word == old else word for word in match[1].split()]
        rest = new if match[1] == old else b" ".join(words)
        return match[0][: match.start(1) - match.start(0)] + rest

    return _LIBRARY.sub(edit, data)
