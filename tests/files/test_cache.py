"""The folder of what is kept: where it lies, and that nothing goes wrong with it."""

import os
import sys
import time

import pytest

from meshdepict.files import cache


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    return tmp_path / "meshdepict"


@pytest.mark.parametrize(
    ("system", "given", "expected"),
    [
        ("linux", {}, "home/.cache/meshdepict"),
        ("linux", {"XDG_CACHE_HOME": "{}/caches"}, "caches/meshdepict"),
        ("linux", {"XDG_CACHE_HOME": "caches"}, "home/.cache/meshdepict"),  # as XDG has it
        ("darwin", {"XDG_CACHE_HOME": "{}/caches"}, "home/Library/Caches/meshdepict"),
        ("win32", {}, "home/AppData/Local/meshdepict"),
        ("win32", {"LOCALAPPDATA": "{}/local"}, "local/meshdepict"),
        ("linux", {"NUMBA_CACHE_DIR": "{}/numba", "XDG_CACHE_HOME": "{}/c"}, "numba/meshdepict"),
    ],
)
def test_the_folder_is_where_the_system_has_such(tmp_path, monkeypatch, system, given, expected):
    for name in ("NUMBA_CACHE_DIR", "XDG_CACHE_HOME", "LOCALAPPDATA"):
        monkeypatch.delenv(name, raising=False)
    for name, value in given.items():
        monkeypatch.setenv(name, value.format(tmp_path))
    monkeypatch.setattr(sys, "platform", system)
    monkeypatch.setattr("pathlib.Path.home", lambda: tmp_path / "home")
    assert cache.cache_folder() == tmp_path / expected
    assert not any(tmp_path.iterdir())  # asking makes nothing


def test_without_a_home_nothing_is_kept(monkeypatch):
    def homeless():
        raise RuntimeError("Could not determine home directory.")

    for name in ("NUMBA_CACHE_DIR", "XDG_CACHE_HOME", "LOCALAPPDATA"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr("pathlib.Path.home", homeless)
    assert cache.cache_folder() is None
    assert not cache.keep("a/b", b"1")
    assert cache.kept("a/b") is None
    assert cache.clear("a") == (0, 0)


def test_what_is_kept_comes_back_and_is_for_its_owner_alone(folder):
    assert cache.kept("some/thing") is None
    assert cache.keep("some/thing", b"12")
    assert cache.keep("some/thing", b"123")
    assert cache.kept("some/thing") == b"123"
    assert [path.name for path in cache.kept_files("some")] == ["thing"]
    if os.name == "posix":
        assert (folder / "some").stat().st_mode & 0o077 == 0


def test_what_nobody_reads_is_thrown_away_and_what_is_read_stays(folder):
    for name in ("new", "old", "read"):
        cache.keep(f"some/{name}", b"1")
    past = time.time() - 90 * 86400
    for name in ("old", "read"):
        os.utime(folder / "some" / name, (past, past))
    assert cache.kept("some/read") == b"1"
    cache.throw_away_unused("some")
    assert sorted(path.name for path in cache.kept_files("some")) == ["new", "read"]


def test_clearing_counts(folder):
    cache.keep("some/one", b"12")
    cache.keep("some/two", b"345")
    cache.keep("other/three", b"6")
    assert cache.clear("some") == (2, 5)
    assert cache.clear("some") == (0, 0)
    assert cache.kept("other/three") == b"6"


def test_a_full_disk_leaves_nothing_half_written(folder, monkeypatch):
    cache.keep("some/one", b"12")

    def full(path, data):
        path.open("wb").close()
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("pathlib.Path.write_bytes", full)
    assert not cache.keep("some/one", b"345")
    assert cache.kept("some/one") == b"12"
    assert [path.name for path in cache.kept_files("some")] == ["one"]
