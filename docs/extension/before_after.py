"""Two pictures in one place, with a slider between.

    ```{before-after} before.png after.png
    :alt: A stone under plain light, and in Exaggerated Shading
    :captions: Lambert | exaggerated
    ```

Without a script both stand beside each other.
"""

from __future__ import annotations

from html import escape
from typing import Any

from docutils import nodes
from docutils.parsers.rst import directives
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective


class Pair(nodes.General, nodes.Element):
    """Holds two images and their captions."""


class BeforeAfter(SphinxDirective):
    """The directive."""

    required_arguments = 2
    option_spec = {"alt": directives.unchanged_required, "captions": directives.unchanged}  # noqa: RUF012

    def run(self) -> list[nodes.Node]:
        """Return a pair of images, which the builder copies as any."""
        if "alt" not in self.options:
            raise self.error("before-after wants an :alt: text")
        words = [word.strip() for word in self.options.get("captions", "before | after").split("|")]
        pair = Pair(alt=self.options["alt"], captions=words)
        for uri, word in zip(self.arguments, words, strict=True):
            pair += nodes.image(uri=uri, alt=f"{self.options['alt']}: {word}")
        return [pair]


def setup(app: Sphinx) -> dict[str, Any]:
    app.add_node(Pair, html=(_open, _close))
    app.add_directive("before-after", BeforeAfter)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def _open(writer: Any, node: Pair) -> None:
    first, second = (escape(word) for word in node["captions"])
    writer.body.append(
        f'<div class="before-after" data-before="{first}" data-after="{second}" '
        f'data-alt="{escape(node["alt"])}">'
    )


def _close(writer: Any, node: Pair) -> None:
    writer.body.append("</div>")
