"""A document as one HTML file that holds its pictures, fetches nothing and opens anywhere.

It holds no date, so that the same document makes the same bytes. Tables are sorted by a click on a column's head.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from clerestory.report.frame import address, environment

if TYPE_CHECKING:
    from clerestory.report.document import Document


def html(document: Document) -> str:
    """The text of the file."""
    made = environment()
    made.filters["address"] = address
    made.tests["block"] = lambda block, kind: type(block).__name__ == kind
    return made.get_template("document.html.j2").render(d=document)
