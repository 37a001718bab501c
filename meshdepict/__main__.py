"""``python -m meshdepict``, and where the command ``meshdepict`` begins.

Next to nothing is imported here before Ctrl-C is answered: half a second of imports follows. The
module ``signal`` alone takes milliseconds, for its enumerations; what it wraps takes none.
"""

import _signal as signal  # type: ignore[import-not-found]
import os
import sys

_INTERRUPTED = 130  # as shells count: 128 + the signal


def _leave(*_: object) -> None:
    """End at once: nothing has been begun."""
    os.write(2, b"meshdepict: interrupted; no file was left half-written\n")
    os._exit(_INTERRUPTED)


def _again(missed: "sys.UnraisableHookArgs") -> None:
    """Interrupt once more where Python could not: in a callback of some library."""
    if missed.exc_type is not KeyboardInterrupt:
        sys.__unraisablehook__(missed)
        return
    import threading

    later = threading.Timer(0.05, os.kill, (os.getpid(), signal.SIGINT))
    later.daemon = True
    later.start()


def run() -> None:
    """Run the command line and exit; Ctrl-C is one line at any time."""
    # Where the one who started this program ignores Ctrl-C, it is ignored.
    heard = signal.getsignal(signal.SIGINT) is signal.default_int_handler
    if heard:
        signal.signal(signal.SIGINT, _leave)
    from meshdepict.cli import main

    sys.unraisablehook = _again
    try:
        if heard:
            signal.signal(signal.SIGINT, signal.default_int_handler)
        status = main()
        if heard:  # from here on there is nothing left to interrupt
            signal.signal(signal.SIGINT, signal.SIG_DFL)
    except KeyboardInterrupt:  # before `main` looks out for it, or after
        _leave()
    sys.exit(status)


if __name__ == "__main__":
    run()
