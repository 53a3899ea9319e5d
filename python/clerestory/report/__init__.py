"""Reports: documents of headings, tables and figures, and the frame that all HTML reports share.

* `document`: what a report is made of.
* `html` and `pdf`: the same document as one HTML file that opens anywhere, and as pages.
* `frame`: the templates' environment, and pictures within a page.
"""

from clerestory.report.document import Box, Cell, Document, Figure, Heading, Items, Paragraph, Table

__all__ = ["Box", "Cell", "Document", "Figure", "Heading", "Items", "Paragraph", "Table"]
