"""The command ``meshdepict``: results on stdout, messages on stderr, one line per error."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any, Literal

from cyclopts import App, CycloptsError, Group, Parameter, UnknownCommandError

import meshdepict
from meshdepict import threads
from meshdepict.console import about, complain, notes
from meshdepict.errors import MeshdepictError

__all__ = ["app", "main"]

_FAULT = 2  # exit status of wrong input
_INTERRUPTED = 130  # … and of Ctrl-C and of a closed pipe, as shells count: 128 + the signal
_BROKEN_PIPE = 141

app = App(
    name="meshdepict",
    help="Shade a surface so that people see its form.",
    version=lambda: str(meshdepict.__version__),
    version_flags=["--version"],
    help_format="plaintext",
    default_parameter=Parameter(negative=()),
)

_FILES, _LOOK, _DETAIL, _EVERYWHERE = (
    Group(name, sort_key=place)
    for place, name in enumerate(("Files", "Look", "Detail", "Everywhere"))
)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return its exit status: 0, or 2 for wrong input."""
    words = tuple(sys.argv[1:] if arguments is None else arguments)
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):  # a file's name may be beyond the terminal's letters
            stream.reconfigure(errors="replace")
    try:
        with notes(quiet=False):
            command, bound, extra = app.parse_args(words, exit_on_error=False, print_error=False)
            if "given" in extra:  # what the words said, before defaults filled the rest
                bound.arguments["given"] = frozenset(bound.arguments)
            status = command(*bound.args, **bound.kwargs)
        sys.stdout.flush()
    except MeshdepictError as error:
        complain(error)
    except CycloptsError as error:
        complain(_sentence(error, words))
    except KeyboardInterrupt:
        complain("interrupted; no file was left half-written")
        return _INTERRUPTED
    except MemoryError:
        complain("out of memory")
    except BrokenPipeError:
        _close_stdout()
        return _BROKEN_PIPE
    except OSError as error:
        if error.filename is None:
            _close_stdout()
        complain(f"{error.filename or 'the output'}: {error.strerror or error}")
    else:
        return int(status or 0)
    return _FAULT


def _close_stdout() -> None:
    """Send what is left for stdout nowhere, so that Python doesn't fail again at its exit."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _sentence(error: CycloptsError, words: Sequence[str]) -> str:
    """Return what is wrong with a command line, and where help is."""
    if isinstance(error, UnknownCommandError):
        word = words[0]
        if word.startswith("-"):
            return f"unknown option {word}: options follow the command (see meshdepict --help)"
        if os.path.exists(word):
            return f"no command is called {word!r}; did you mean: meshdepict bake {word}"
    text = str(error).strip().rstrip(".")
    command = " ".join(("meshdepict", *(error.command_chain or ())))
    return f"{text[:1].lower()}{text[1:]} (see {command} --help)"


def _whole(_: Any, tokens: Sequence[Any]) -> int:
    """Convert a whole number strictly; cyclopts would round 1.5 to 2."""
    try:
        return int(tokens[0].value)
    except ValueError:
        raise ValueError(f"{tokens[0].value!r} is not a whole number") from None


def _number(_: Any, tokens: Sequence[Any]) -> float:
    try:
        return float(tokens[0].value)
    except ValueError:
        raise ValueError(f"{tokens[0].value!r} is not a number") from None


_Quiet = Annotated[
    bool, Parameter(group=_EVERYWHERE, show_default=False, help="No notes and no progress bar.")
]
_Threads = Annotated[
    int | None,
    Parameter(
        name="--threads",
        converter=_whole,
        group=_EVERYWHERE,
        help="Cores to use; all unless given.",
    ),
]


@app.command(usage="Usage: meshdepict bake [INPUT...] [OPTIONS]")
def bake(
    *inputs: Annotated[Path, Parameter(name="INPUT")],
    output: Annotated[str | None, Parameter(name=["--output", "-o"], group=_FILES)] = None,
    picture: Annotated[str | None, Parameter(group=_FILES)] = None,
    size: Annotated[str, Parameter(group=_FILES)] = "1000x1000",
    albedo: Annotated[Literal["keep", "none"], Parameter(group=_FILES)] = "none",
    winding: Annotated[Literal["auto", "keep"], Parameter(group=_FILES)] = "auto",
    fix_winding: Annotated[bool, Parameter(group=_FILES, show_default=False)] = False,
    force: Annotated[bool, Parameter(group=_FILES, show_default=False)] = False,
    recipe: Annotated[str | None, Parameter(group=_FILES)] = None,
    save_recipe: Annotated[str | None, Parameter(group=_FILES)] = None,
    method: Annotated[str, Parameter(name=["--method", "-m"], group=_LOOK)] = "exaggerated",
    light: Annotated[str, Parameter(group=_LOOK, allow_leading_hyphen=True)] = "northwest",
    view: Annotated[str, Parameter(group=_LOOK)] = "front",
    up: Annotated[Literal["y", "z"], Parameter(group=_LOOK)] = "y",
    options: Annotated[list[str] | None, Parameter(name="--set", group=_LOOK)] = None,
    colormap: Annotated[str | None, Parameter(group=_LOOK)] = None,
    colormap2d: Annotated[str | None, Parameter(name="--colormap2d", group=_LOOK)] = None,
    scales: Annotated[int | None, Parameter(converter=_whole, group=_DETAIL)] = None,
    width: Annotated[str | None, Parameter(group=_DETAIL, allow_leading_hyphen=True)] = None,
    ratio: Annotated[float | None, Parameter(converter=_number, group=_DETAIL)] = None,
    facing: Annotated[Literal[0, 1], Parameter(group=_DETAIL)] = 1,
    tolerance: Annotated[float, Parameter(converter=_number, group=_DETAIL)] = 1e-4,
    quiet: _Quiet = False,
    cores: _Threads = None,
    given: Annotated[frozenset[str], Parameter(parse=False)] = frozenset(),
) -> int:
    """Shade meshes and write the colours into files. Without INPUT: the built-in golf ball.

    Parameters
    ----------
    inputs
        Mesh files: PLY, OBJ, OFF, STL, GLB, glTF or VTP, gzipped or not.
    output
        File to write, or a folder; <name>-<method>.ply in the current folder unless given.
    picture
        Also render a PNG: a file, or a folder.
    size
        Size of the picture in pixels.
    albedo
        keep: multiply the file's own colours.
    winding
        auto: turn faces that look inwards before shading; keep: believe the file.
    fix_winding
        Write the turned faces, too, with vertex and face properties but nothing else of the file.
    force
        Replace existing files that meshdepict didn't write, the input among them.
    recipe
        Take method, light, view, scales, … from a file; what else is said here comes first.
    save_recipe
        Write them to a file.
    method
        How to shade: meshdepict methods lists what there is.
    light
        A name (north, northeast, … northwest, front), azimuth,elevation in degrees, x,y,z, or a
        panorama.hdr; several, where a method takes them, parted by semicolons.
    view
        Where names of lights and the picture look from: front, back, left, right, top, bottom or
        isometric.
    up
        Axis of the object that points up.
    options
        An option of the method as name=value; meshdepict methods NAME lists them. Repeatable.
    colormap
        Colours for dark to bright; grey unless given.
    colormap2d
        Colours for two lights, the other one 90° clockwise: dusk, earth or swiss.
    scales
        How often to smooth; unless given, as often as the method wants.
    width
        First smoothing width in the file's units, or a share of the diagonal such as 0.2%; unless
        given, the median edge.
    ratio
        From one width to the next.
    facing
        1 keeps the two sides of thin sheets apart; 0 is the plain sum of the paper.
    tolerance
        Largest error of a normal, in radians.
    """
    from meshdepict.batch import Batch, check_settings
    from meshdepict.recipe import load_recipe, merge_recipe
    from meshdepict.recipe import save_recipe as write_recipe

    threads.limit(cores)
    if fix_winding and winding == "keep":
        raise MeshdepictError("--fix-winding writes what --winding keep forbids: give one of them")
    settings: dict[str, Any] = {
        "method": method, "light": _light(light), "view": view, "up": up, "scales": scales,
        "width": width, "ratio": ratio, "facing": facing, "tolerance": tolerance,
        "colormap": colormap, "colormap2d": colormap2d, "albedo": albedo,
    }  # fmt: skip
    if recipe is not None:
        said = {name: value for name, value in settings.items() if name in given}
        settings = merge_recipe(load_recipe(recipe), said)
    settings |= _method_options(settings["method"], options or [])
    if save_recipe is not None:
        check_settings(settings)
        write_recipe(save_recipe, settings, force=force)
    batch = Batch(
        inputs=inputs, settings=settings, output=output, picture=picture, size=_size(size),
        winding=winding, fix_winding=fix_winding, force=force, quiet=quiet,
    )  # fmt: skip
    return _FAULT if batch.run() else 0


@app.command(usage="Usage: meshdepict methods [NAME...]")
def methods(
    *names: Annotated[str, Parameter(name="NAME")], quiet: _Quiet = False, cores: _Threads = None
) -> None:
    """List the shading methods, or one method's options with their ranges.

    Parameters
    ----------
    names
        Methods to describe.
    """
    from meshdepict import report

    del quiet, cores  # accepted everywhere
    described = [report.method(name) for name in names]
    print("\n\n".join(described) if described else report.methods())  # noqa: T201


@app.command(usage="Usage: meshdepict info INPUT...")
def info(
    *inputs: Annotated[Path, Parameter(name="INPUT")], quiet: _Quiet = False, cores: _Threads = None
) -> int:
    """Count what a mesh has, its defects too, and say how long a bake will take.

    Parameters
    ----------
    inputs
        Mesh files.
    """
    from meshdepict import report

    threads.limit(cores)
    if not inputs:
        raise MeshdepictError("info needs a mesh file: meshdepict info INPUT")
    failed = 0
    for path in inputs:
        try:
            with notes(path, quiet=quiet):
                text = report.info(path)
        except MeshdepictError as error:
            complain(about(path, error))
            failed += 1
        else:
            print(text, end="\n\n" if path is not inputs[-1] else "\n", flush=True)  # noqa: T201
    return _FAULT if failed else 0


def _light(text: str) -> Any:
    """Return a light's name, its angles or its direction; several where semicolons part them."""
    if ";" in text:
        return [_light(part.strip()) for part in text.split(";") if part.strip()]
    if "," not in text:
        return text
    try:
        numbers = tuple(float(part) for part in text.split(","))
    except ValueError:
        numbers = ()
    if len(numbers) not in (2, 3):
        raise MeshdepictError(
            f"--light {text} is neither a name, nor azimuth,elevation in degrees, nor x,y,z"
        )
    return numbers


def _size(text: str) -> tuple[int, int]:
    width, _, height = text.lower().partition("x")
    if not (width.isdecimal() and height.isdecimal()):
        raise MeshdepictError(f"--size {text} is not WIDTHxHEIGHT in pixels, such as 1200x900")
    return int(width), int(height)


def _method_options(method: str, given: Sequence[str]) -> dict[str, Any]:
    """Return the method's options from ``name=value`` texts, checked."""
    from meshdepict.baking import find_method
    from meshdepict.options import check

    function = find_method(method)
    texts = {}
    for text in given:
        name, equals, value = text.partition("=")
        if not equals:
            raise MeshdepictError(f"--set wants name=value, not {text!r}")
        texts[name.strip()] = value.strip()
    return check(function, texts, method)
