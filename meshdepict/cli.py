"""The command ``meshdepict``: results on stdout, messages on stderr, one line per error."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from contextlib import suppress

from cyclopts import App, CycloptsError, Parameter

import meshdepict
from meshdepict.commands.sentences import sentence
from meshdepict.console import FAULT, complain, notes
from meshdepict.errors import MeshdepictError
from meshdepict.kernels.notice import told

__all__ = ["app", "main"]

_INTERRUPTED = 130  # … and of Ctrl-C and of a closed pipe, as shells count: 128 + the signal
_BROKEN_PIPE = 141

app = App(
    name="meshdepict",
    help="Shade a surface so that people see its form.",
    version=lambda: str(meshdepict.__version__),
    version_flags=["--version", "-V"],
    help_format="plaintext",
    default_parameter=Parameter(negative=()),
)

# By name, so that a command loads its own modules and no other's.
_COMMANDS = {
    "bake": "[INPUT...] [OPTIONS]",
    "batch": "FILES... [OPTIONS]",
    "view": "[INPUT] [OPTIONS]",
    "compare": "[INPUT] [OPTIONS]",
    "volume": "[CT] [OPTIONS]",
    "relief": "DEM... [OPTIONS]",
    "texture": "MESH [OPTIONS]",
    "plate": "[FILE...] [OPTIONS]",
    "movie": "[INPUT] [OPTIONS]",
    "info": "INPUT...",
    "methods": "[NAME...]",
    "warm": "[OPTIONS]",
}
for _place, (_name, _words) in enumerate(_COMMANDS.items()):
    app.command(
        f"meshdepict.commands.{_name}:{_name}", name=_name, sort_key=_place,
        usage=f"Usage: meshdepict {_name} {_words}",
    )  # fmt: skip
app.register_install_completion_command(
    help="Let the shell complete commands and options.", version_flags=[]
)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return its exit status: 0, or 2 for wrong input."""
    words = tuple(sys.argv[1:] if arguments is None else arguments)
    if words[:1] == ("help",):
        words = (*words[1:2], "--help")
    if words[:1] in ((), ("--help",), ("-h",)):
        for name in _COMMANDS:
            app[name]  # loaded, so that the list has each one's line
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):  # a file's name may be beyond the terminal's letters
            stream.reconfigure(errors="replace")
    try:
        with notes(quiet=False), told(_Once(words)):
            if words[:1] and words[0] in _COMMANDS:
                from meshdepict.commands.parameters import spelled_out

                words = spelled_out(words)
            command, bound, extra = app.parse_args(words, exit_on_error=False, print_error=False)
            if "given" in extra:  # what the words said, before defaults filled the rest
                bound.arguments["given"] = frozenset(bound.arguments)
            status = command(*bound.args, **bound.kwargs)
        if sys.stdout is not None:  # none where it was closed from the beginning
            sys.stdout.flush()
    except MeshdepictError as error:
        complain(error)
    except CycloptsError as error:
        complain(sentence(error, words))
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
    return FAULT


class _Once:
    """Tell whoever waits at a terminal that kernels are compiled, the first time."""

    def __init__(self, words: Sequence[str]) -> None:
        self._silent = "--quiet" in words or words[:1] == ("warm",)

    def __call__(self, _: str) -> None:
        if self._silent or sys.stderr is None or not sys.stderr.isatty():
            return
        self._silent = True
        complain("note: kernels are compiled, once; meshdepict warm does it for all commands")


def _close_stdout() -> None:
    """Send what is left for stdout and stderr nowhere, so that Python doesn't fail at its exit."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except (AttributeError, OSError, ValueError):
            with suppress(AttributeError, OSError, ValueError):
                os.dup2(nowhere, stream.fileno())
