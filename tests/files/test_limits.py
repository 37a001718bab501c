"""Memory follows a file's size, not its claims."""

from __future__ import annotations

import gzip
import tracemalloc
from collections.abc import Iterator
from pathlib import Path

import pytest

from meshdepict.errors import MeshdepictError
from meshdepict.files import limits

MB = 1 << 20


@pytest.fixture(autouse=True)
def unset() -> Iterator[None]:
    yield
    limits.set_max_memory(None)


@pytest.mark.parametrize(
    ("amount", "count"),
    [
        ("4GB", 4 << 30), ("4 gb", 4 << 30), ("4GiB", 4 << 30), ("4g", 4 << 30), ("1.5MB", 3 << 19),
        ("500", 500), ("500b", 500), ("2TB", 2 << 40), ("8k", 8 << 10), (700, 700), (1e3, 1000),
    ],
)  # fmt: skip
def test_amounts_of_memory_are_read(amount, count):
    assert limits.as_bytes(amount) == count


@pytest.mark.parametrize(
    "amount",
    ["", "GB", "4 XB", "-4GB", "0", 0, -1, "nan", "1e3", float("nan"), float("inf"), True, None,
     [4], "4GB4", "9" * 5000],
)  # fmt: skip
def test_other_amounts_are_refused(amount):
    with pytest.raises(MeshdepictError, match="is no amount of memory such as 4GB"):
        limits.as_bytes(amount)


def test_amounts_are_said_as_people_say_them():
    said = [limits.as_text(count) for count in (12, 2 << 10, 1023 * MB, 3 << 29)]
    assert said == ["12 bytes", "2 kB", "1,023 MB", "1.5 GB"]


def test_the_allowance_follows_the_size_between_its_bounds():
    least, most = 1 * MB, limits.max_memory()
    assert limits.allowance(1, least=least) == least
    assert limits.allowance(MB, least=least) == min(limits.FACTOR * MB, most)
    assert limits.allowance(most) == most
    assert limits.allowance(0) == min(limits.LEAST, most)


def test_a_person_has_the_last_word():
    for amount in (MB, 1 << 50):
        limits.set_max_memory(amount)
        assert limits.allowance(1) == limits.allowance(1 << 40) == limits.max_memory() == amount
    limits.set_max_memory(None)
    assert limits.max_memory() < 1 << 50


def test_a_claim_is_refused_only_beyond_the_allowance():
    limits.set_max_memory("1MB")
    limits.check_claim(MB, 10, "vertices")
    with pytest.raises(
        MeshdepictError, match=r"claims more vertices than the 1 MB of memory .* --max-memory"
    ):
        limits.check_claim(MB + 1, 10, "vertices")


def test_half_of_the_memory_where_the_machine_tells_none(monkeypatch):
    def unknown(*_: object, **__: object) -> None:
        raise OSError("not here")

    monkeypatch.setattr(limits.os, "sysconf", unknown)
    monkeypatch.setattr(limits.Path, "read_text", unknown)
    assert limits.max_memory() == 8 << 30


def test_a_container_has_less_than_its_machine(monkeypatch):
    monkeypatch.setattr(limits.Path, "read_text", lambda *_, **__: f"{600 * MB}\n")
    assert limits.max_memory() == 300 * MB


def bomb(path: Path, megabytes: int) -> None:
    with gzip.open(path, "wb", 9) as file:
        for _ in range(megabytes):
            file.write(bytes(MB))


def test_a_packed_file_unpacks_to_what_was_packed(tmp_path):
    content = bytes(range(256)) * 3000
    path = tmp_path / "a.gz"
    path.write_bytes(gzip.compress(content[:1000]) + gzip.compress(content[1000:]))
    with path.open("rb") as file:
        unpacked = limits.unpacked(file, path)
        assert unpacked.peek(4)[:4] == content[:4]
        assert unpacked.read() == content


def test_a_bomb_is_refused_before_it_fills_the_memory(tmp_path):
    path = tmp_path / "bomb.ply.gz"
    bomb(path, 64)
    limits.set_max_memory("4MB")
    tracemalloc.start()
    try:
        with (
            path.open("rb") as file,
            pytest.raises(MeshdepictError, match=r"bomb.ply.gz unpacks to more than 4 MB"),
        ):
            limits.unpacked(file, path).read()
        _, most = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert most < 16 * MB  # the bytes read, and what joins them
    limits.set_max_memory("65MB")
    with path.open("rb") as file:
        assert len(limits.unpacked(file, path).read()) == 64 * MB
