"""Open spoiled files one after the other in a process of its own, and say how each ended.

``python trial.py FOLDER FIRST LAST``: a line ``NUMBER<TAB>SEED<TAB>OUTCOME<TAB>WORDS`` each. The
file under trial lies in the folder, and its number and seed are written before it is opened, so
that who started this process knows which file killed it.
"""

from __future__ import annotations

import os
import resource
import signal
import sys
import tempfile
import traceback
import warnings
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
sys.path.insert(0, str(Path(__file__).resolve().parent))

import mutated_files

from meshdepict.errors import MeshdepictError, MeshdepictWarning

MEMORY = 3 << 30  # bytes of address space beyond what the libraries take
SECONDS = 60  # for one small file, also on a loaded machine


class _TooSlowError(BaseException):
    """Raised by the alarm."""


def _alarm(*_: object) -> None:
    raise _TooSlowError


def outcome(path: Path) -> tuple[str, str]:
    """Open a file; return how that ended, and the words of it."""
    with tempfile.TemporaryFile() as noise:
        sys.stderr.flush()
        usual = os.dup(2)
        os.dup2(noise.fileno(), 2)
        signal.alarm(SECONDS)
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                warnings.simplefilter("ignore", MeshdepictWarning)
                found = "read", mutated_files.open_file(path)
        except MeshdepictError as error:
            words = str(error)
            plain = "\n" not in words and words.isprintable()
            found = ("refused" if plain else "unprintable"), repr(words)[:300]
        except _TooSlowError:
            found = "slow", f"more than {SECONDS} s"
        except BaseException as error:
            where = traceback.extract_tb(error.__traceback__)[-1]
            what = f"{type(error).__name__}: {error}"[:200].replace("\n", " ").replace("\t", " ")
            found = "fault", f"{what} at {Path(where.filename).name}:{where.lineno}"
        finally:
            signal.alarm(0)
            os.dup2(usual, 2)
            os.close(usual)
        noise.seek(0)
        said = noise.read().strip()
        if said and found[0] in ("read", "refused"):
            found = "noise", said.decode(errors="replace").splitlines()[0][:200]
    return found


def main() -> None:
    """Try a span of numbers."""
    folder, first, last = Path(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3])
    with tempfile.TemporaryDirectory() as scratch:
        good = mutated_files.seeds(Path(scratch))
    names = sorted(good)
    for name in names:  # compiles what there is to compile, before memory is limited
        (folder / name).write_bytes(good[name])
        outcome(folder / name)
        (folder / name).unlink()
    used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (used + MEMORY, used + MEMORY))
    signal.signal(signal.SIGALRM, _alarm)
    for number in range(first, last):
        name = names[number % len(names)]
        path = folder / name
        path.write_bytes(mutated_files.mutated(good[name], number))
        print(f"{number}\t{name}", end="\t", flush=True)
        ending, words = outcome(path)
        print(f"{ending}\t{words}", flush=True)
        path.unlink()


if __name__ == "__main__":
    main()
