"""Files are written wholly or not at all, whatever goes wrong."""

from __future__ import annotations

import errno
import os
import stat
from pathlib import Path

import pytest

from meshdepict.errors import MeshdepictError
from meshdepict.io import atomic_write

OLD = b"the old file"


@pytest.fixture
def old(tmp_path: Path) -> Path:
    path = tmp_path / "mesh.ply"
    path.write_bytes(OLD)
    return path


def alone(path: Path) -> bool:
    """Whether nothing but the file lies in its folder."""
    return list(path.parent.iterdir()) == [path]


def write_and_raise(path: Path, fault: BaseException) -> None:
    with atomic_write(path) as file:
        file.write(b"half")
        raise fault


def write(path: str | Path, content: bytes = b"new") -> None:
    with atomic_write(path) as file:
        file.write(content)


def test_the_new_file_appears_only_at_the_end(old):
    with atomic_write(old) as file:
        file.write(b"new")
        file.flush()
        assert old.read_bytes() == OLD
        assert Path(file.name).parent == old.parent
    assert old.read_bytes() == b"new"
    assert alone(old)


@pytest.mark.parametrize("fault", [KeyboardInterrupt, RuntimeError, SystemExit, GeneratorExit])
def test_an_interruption_leaves_the_old_file_whole(old, fault):
    with pytest.raises(fault):
        write_and_raise(old, fault())
    assert old.read_bytes() == OLD
    assert alone(old)


def test_an_interruption_leaves_no_new_file(tmp_path):
    path = tmp_path / "mesh.ply"
    with pytest.raises(KeyboardInterrupt):
        write_and_raise(path, KeyboardInterrupt())
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("number", "sentence"),
    [
        (errno.ENOSPC, "no space is left on the disk"),
        (errno.EDQUOT, "no space is left in your disk quota"),
        (errno.EACCES, "permission denied"),
        (errno.EPERM, "permission denied"),
        (errno.EROFS, "the disk is read-only"),
        (errno.EIO, "could not be written"),
    ],
)
def test_a_fault_while_writing_is_one_sentence(old, number, sentence):
    with pytest.raises(MeshdepictError, match=sentence) as caught:
        write_and_raise(old, OSError(number, os.strerror(number)))
    assert str(caught.value).startswith(str(old))
    assert old.read_bytes() == OLD
    assert alone(old)


def test_a_fault_when_the_file_takes_its_name(old, monkeypatch):

    def full(self: Path, target: Path) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(Path, "replace", full)
    with pytest.raises(MeshdepictError, match="no space is left"):
        write(old)
    assert old.read_bytes() == OLD
    assert alone(old)


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs Linux's /dev/full")
def test_a_full_device():
    with pytest.raises(MeshdepictError, match="/dev/full could not be written: no space"):
        write("/dev/full")
    assert stat.S_ISCHR(os.stat("/dev/full").st_mode)


@pytest.mark.skipif(os.name != "posix", reason="needs a named pipe")
def test_a_pipe_is_written_to_not_replaced(tmp_path):
    path = tmp_path / "pipe"
    os.mkfifo(path)
    end = os.open(path, os.O_RDONLY | os.O_NONBLOCK)
    try:
        write(path)
        assert os.read(end, 100) == b"new"
    finally:
        os.close(end)
    assert stat.S_ISFIFO(path.stat().st_mode)


def test_no_such_folder(tmp_path):
    with pytest.raises(MeshdepictError, match="there is no such folder"):
        write(tmp_path / "missing" / "mesh.ply")


def test_a_file_for_a_folder(old):
    with pytest.raises(MeshdepictError, match="is a file, not a folder"):
        write(old / "mesh.ply")


def test_a_folder_for_a_file(tmp_path):
    with pytest.raises(MeshdepictError, match="is a folder"):
        write(tmp_path)


def test_a_name_that_is_too_long(tmp_path):
    with pytest.raises(MeshdepictError, match="name is too long"):
        write(tmp_path / ("x" * 300))
    assert list(tmp_path.iterdir()) == []


def test_a_long_name_that_is_just_allowed(tmp_path):
    path = tmp_path / ("x" * 255)
    write(path)
    assert path.read_bytes() == b"new"


def test_a_file_that_its_owner_protected(old, monkeypatch):
    """Renaming would get round the protection (root may write it: so os.access is asked for)."""
    old.chmod(0o400)
    monkeypatch.setattr(os, "access", lambda path, mode: mode != os.W_OK)
    with pytest.raises(MeshdepictError, match="permission denied"):
        write(old)
    assert old.read_bytes() == OLD


def test_permissions_are_kept(old):
    old.chmod(0o640)
    write(old)
    assert stat.S_IMODE(old.stat().st_mode) == 0o640


def test_new_files_get_the_usual_permissions(tmp_path):
    (tmp_path / "usual").touch()
    write(tmp_path / "new")
    assert (tmp_path / "new").stat().st_mode == (tmp_path / "usual").stat().st_mode


def test_a_link_keeps_pointing_to_its_target(tmp_path, old):
    link = tmp_path / "link.ply"
    link.symlink_to(old.name)
    write(link)
    assert link.is_symlink()
    assert old.read_bytes() == b"new"


def test_a_relative_path(old, monkeypatch):
    monkeypatch.chdir(old.parent)
    write("mesh.ply")
    assert old.read_bytes() == b"new"
