"""Whatever a file holds, it is read or refused in a sentence; nothing hangs or kills."""

from collections import Counter

import pytest
from campaign import GOOD, outcomes

FILES = 3_000
_PARTS = 6


@pytest.mark.parametrize("part", range(_PARTS))
def test_spoiled_files_are_read_or_refused_in_a_sentence(part):
    step = FILES // _PARTS
    found = list(outcomes(part * step, (part + 1) * step))
    assert len(found) == step
    bad = [each for each in found if each.ending not in GOOD]
    assert not bad, "\n".join("\t".join(map(str, each)) for each in bad)
    counts = Counter(each.ending for each in found)
    assert counts["read"] > step // 20  # else the files are spoiled too much to say anything
    assert counts["refused"] > step // 20
