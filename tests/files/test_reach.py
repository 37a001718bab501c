"""What may be opened: no pipes and devices, and of what a file names only its neighbours."""

from __future__ import annotations

import os
import socket
from pathlib import Path

import pytest

from meshdepict.errors import MeshdepictError
from meshdepict.files.reach import inside, regular

posix = pytest.mark.skipif(os.name != "posix", reason="needs POSIX's kinds of files")


@pytest.fixture
def home(tmp_path: Path) -> Path:
    """A folder with a buffer in it and one below; a secret lies beside it."""
    folder = tmp_path / "home"
    (folder / "parts").mkdir(parents=True)
    (folder / "a.bin").write_bytes(b"a")
    (folder / "parts" / "b.bin").write_bytes(b"b")
    (tmp_path / "secret").write_bytes(b"secret")
    return folder


def test_files_folders_and_what_is_not_there_pass(home):
    for path in (home / "a.bin", home, home / "missing", "x" * 5000, "a\0b"):
        regular(path)


@posix
def test_a_pipe_is_refused_before_it_is_opened(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(MeshdepictError, match="pipe is a named pipe, not a file: save"):
        regular(tmp_path / "pipe")


@posix
def test_a_device_is_refused():
    with pytest.raises(MeshdepictError, match=r"^/dev/null is a device, not a file"):
        regular("/dev/null")


@posix
def test_a_socket_is_refused(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)  # a socket's address is short
    with socket.socket(socket.AF_UNIX) as end:
        end.bind("socket")
        with pytest.raises(MeshdepictError, match="socket is a socket"):
            regular("socket")


@posix
def test_a_link_to_a_device_is_the_device(tmp_path):
    (tmp_path / "link").symlink_to("/dev/zero")
    with pytest.raises(MeshdepictError, match="is a device"):
        regular(tmp_path / "link")


@pytest.mark.parametrize("name", ["a.bin", "parts/b.bin", "./a.bin", "parts\\b.bin", "no such.bin"])
def test_names_in_the_folder_and_below_are_found(home, name):
    found = inside(home, name, "buffer")
    assert found == home / name.replace("\\", "/")


@posix
def test_a_backslash_in_a_files_own_name_is_kept(home):
    (home / "parts\\b.bin").write_bytes(b"odd")
    assert inside(home, "parts\\b.bin", "buffer").read_bytes() == b"odd"


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("/etc/passwd", "an absolute path"),
        ("C:\\secret", "an absolute path"),
        ("c:secret", "an absolute path"),
        ("\\\\host\\share\\secret", "an absolute path"),
        ("//host/share/secret", "an absolute path"),
        ("../secret", "which leads out of its folder"),
        ("..\\secret", "which leads out of its folder"),
        ("parts/../../secret", "which leads out of its folder"),
        ("parts/../a.bin", "which leads out of its folder"),
        ("http://host/a.bin", "a URL"),
        ("file:///etc/passwd", "a URL"),
        ("file:secret", "a URL"),
        ("", "which is no name"),
        (" ", "which is no name"),
        ("a\0b", "which no file can be called"),
    ],
)
def test_names_that_reach_further_are_refused(home, name, words):
    with pytest.raises(MeshdepictError) as caught:
        inside(home, name, "buffer")
    assert str(caught.value).startswith(f"names the buffer {name!r}, {words}")


@posix
def test_a_link_out_of_the_folder_is_refused(home):
    (home / "link.bin").symlink_to("../secret")
    (home / "folder").symlink_to("..")
    for name in ("link.bin", "folder/secret"):
        with pytest.raises(MeshdepictError, match="a link out of its folder"):
            inside(home, name, "buffer")


@posix
def test_a_link_within_the_folder_and_a_linked_folder_are_followed(home, tmp_path):
    (home / "link.bin").symlink_to("parts/b.bin")
    assert inside(home, "link.bin", "buffer").read_bytes() == b"b"
    (tmp_path / "elsewhere").symlink_to(home)
    assert inside(tmp_path / "elsewhere", "a.bin", "buffer").read_bytes() == b"a"


@posix
def test_a_named_pipe_is_refused(home):
    os.mkfifo(home / "pipe")
    with pytest.raises(MeshdepictError, match="names the buffer 'pipe', a named pipe"):
        inside(home, "pipe", "buffer")


def test_the_current_folder_may_be_given(home, monkeypatch):
    monkeypatch.chdir(home)
    assert inside("", "a.bin", "buffer").read_bytes() == b"a"
