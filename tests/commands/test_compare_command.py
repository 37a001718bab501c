"""``meshdepict compare`` as words of the command line."""

import inspect

from meshdepict.baking.choice_list import choice_fields
from meshdepict.commands.compare import compare as command
from meshdepict.congruence.comparison import compare


def test_every_word_of_a_look_is_one_that_compare_takes():
    look = inspect.unwrap(command).__kwdefaults__["look"]
    words = {name for name in choice_fields() if hasattr(look, name)}
    assert {"view", "up", "creases", "normals"} <= words
    assert words <= set(inspect.signature(compare).parameters)
