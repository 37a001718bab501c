"""The command ``meshdepict``: results on stdout, messages on stderr, one line per error."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from contextlib import suppress

from cyclopts import App, CycloptsError, Parameter, UnknownCommandError

import meshdepict
from meshdepict.console import FAULT, complain, notes
from meshdepict.errors import MeshdepictError

__all__ = ["app", "main"]

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

# By name, so that a command loads its own modules and no other's.
_COMMANDS = {
    "bake": "[INPUT...] [OPTIONS]",
    "methods": "[NAME...]",
    "info": "INPUT...",
    "view": "INPUT [OPTIONS]",
    "movie": "INPUT [OPTIONS]",
    "compare": "[INPUT] [OPTIONS]",
    "volume": "[CT] [OPTIONS]",
}
for _name, _words in _COMMANDS.items():
    _usage = f"Usage: meshdepict {_name} {_words}"
    app.command(f"meshdepict.commands.{_name}:{_name}", name=_name, usage=_usage)


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
        if sys.stdout is not None:  # none where it was closed from the beginning
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
    return FAULT


def _close_stdout() -> None:
    """Send what is left for stdout and stderr nowhere, so that Python doesn't fail at its exit."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except (AttributeError, OSError, ValueError):
            with suppress(AttributeError, OSError, ValueError):
                os.dup2(nowhere, stream.fileno())


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
