"""A document as a PDF file of A4 pages.

It holds no date, so that the same document makes the same bytes. Letters are those of matplotlib, which has θ, − and ≤.
"""

from __future__ import annotations

from functools import cache
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

from reportlab.lib.colors import HexColor
from reportlab.lib.enums import TA_RIGHT
from reportlab.lib.pagesizes import A4
from reportlab.lib.styles import ParagraphStyle
from reportlab.lib.units import mm
from reportlab.lib.utils import ImageReader
from reportlab.pdfbase import pdfmetrics
from reportlab.pdfbase.ttfonts import TTFont
from reportlab.platypus import (
    Flowable,
    Image,
    KeepTogether,
    ListFlowable,
    ListItem,
    LongTable,
    SimpleDocTemplate,
    Spacer,
)
from reportlab.platypus import Paragraph as Text
from reportlab.platypus import Table as Grid

from clerestory.report.document import Box, Figure, Heading, Items, Paragraph, Table
from clerestory.report.frame import subscripts

if TYPE_CHECKING:
    from collections.abc import Sequence

    from reportlab.pdfgen.canvas import Canvas

    from clerestory.report.document import Block, Cell, Document

INK, SOFT, LINE, MARK = (HexColor(code) for code in ("#1d2430", "#5b6472", "#d8dce2", "#b54708"))
_KINDS = {"key": (HexColor("#f4f6f8"), HexColor("#0072b2")), "note": (HexColor("#fff6e5"), HexColor("#e69f00"))}
_MARGIN = 15 * mm
_WIDTH, _HEIGHT = A4[0] - 2 * _MARGIN, A4[1] - 2 * _MARGIN
_PIXELS_AN_INCH = 150.0
"""Of pictures that are not made smaller to fit."""
_TALLEST = 0.82 * _HEIGHT


def pdf(document: Document) -> bytes:
    """The bytes of the file."""
    _fonts()
    flow: list[Flowable] = [_text(document.title, "title"), _text(document.subtitle, "sub")]
    for block, number in document.numbered():
        flow += _flowables(block, number)
    buffer = BytesIO()
    made = SimpleDocTemplate(
        buffer,
        pagesize=A4,
        leftMargin=_MARGIN,
        rightMargin=_MARGIN,
        topMargin=_MARGIN,
        bottomMargin=_MARGIN + 4 * mm,
        title=document.title,
        creator=f"Clerestory {document.version}",
        producer=f"Clerestory {document.version}",
        author="",
        invariant=1,
    )

    def foot(canvas: Canvas, template: Any) -> None:  # noqa: ANN401 (the library's)
        canvas.setFont("report", 7)
        canvas.setFillColor(SOFT)
        canvas.drawString(_MARGIN, 0.6 * _MARGIN, document.title)
        canvas.drawRightString(A4[0] - _MARGIN, 0.6 * _MARGIN, str(template.page))

    made.build(flow, onFirstPage=foot, onLaterPages=foot)
    return buffer.getvalue()


@cache
def _fonts() -> None:
    """Make the letters known, once."""
    import matplotlib

    folder = Path(matplotlib.get_data_path()) / "fonts" / "ttf"
    pdfmetrics.registerFont(TTFont("report", folder / "DejaVuSans.ttf"))
    pdfmetrics.registerFont(TTFont("report-bold", folder / "DejaVuSans-Bold.ttf"))


@cache
def _style(name: str) -> ParagraphStyle:
    plain = ParagraphStyle("plain", fontName="report", fontSize=8.5, leading=12.5, textColor=INK, spaceAfter=5)
    made = {
        "plain": plain,
        "title": ParagraphStyle("title", plain, fontName="report-bold", fontSize=19, leading=24, spaceAfter=2),
        "sub": ParagraphStyle("sub", plain, textColor=SOFT, spaceAfter=10),
        "2": ParagraphStyle(
            "2", plain, fontName="report-bold", fontSize=13, leading=17, spaceBefore=14, keepWithNext=1
        ),
        "3": ParagraphStyle("3", plain, fontName="report-bold", fontSize=10, leading=14, spaceBefore=9, keepWithNext=1),
        "caption": ParagraphStyle("caption", plain, fontSize=7.5, leading=10, textColor=SOFT, spaceBefore=3),
        "cell": ParagraphStyle("cell", plain, fontSize=6.8, leading=8.6, spaceAfter=0),
    }
    made["head"] = ParagraphStyle("head", made["cell"], fontName="report-bold", leading=10.2)
    for key in ("cell", "head"):
        made[f"{key}-right"] = ParagraphStyle(f"{key}-right", made[key], alignment=TA_RIGHT)
    return made[name]


def _text(text: str, style: str) -> Text:
    return Text(_marked(text), _style(style))


def _marked(text: str) -> str:
    """With subscripts, in the markup of the library; what comes from files is escaped."""
    # A hyphen that does not part is not among the letters.
    return str(subscripts(text)).replace("\u2011", "-")


def _bold(markup: str) -> str:
    return f'<font name="report-bold">{markup}</font>'


def _flowables(block: Block, number: int) -> list[Flowable]:
    if isinstance(block, Heading):
        return [_text(block.text, str(block.level))]
    if isinstance(block, Paragraph):
        return [_text(block.text, "plain")]
    if isinstance(block, Items):
        return [_list(block.items)]
    if isinstance(block, Box):
        return [_box(block), Spacer(1, 8)]
    if isinstance(block, Table):
        caption = Text(f"{_bold(f'Table {number}.')} {_marked(block.caption)}", _style("caption"))
        return [caption, _table(block), Spacer(1, 8)]
    return [_figure(block, number)]


def _list(items: Sequence[str]) -> ListFlowable:
    rows = [ListItem(_text(item, "plain"), leftIndent=10, bulletColor=SOFT) for item in items]
    return ListFlowable(rows, bulletType="bullet", start="•", bulletFontName="report", leftIndent=10, bulletFontSize=7)


def _box(box: Box) -> Grid:
    wash, edge = _KINDS[box.kind]
    # A row an item, so that a long box parts between pages.
    rows: list[list[Flowable]] = [[Text(_bold(_marked(box.title)), _style("plain"))]]
    rows += [[_list([item])] for item in box.items]
    style = [
        ("BACKGROUND", (0, 0), (-1, -1), wash),
        ("LINEBEFORE", (0, 0), (0, -1), 3, edge),
        ("LEFTPADDING", (0, 0), (-1, -1), 9),
        ("TOPPADDING", (0, 0), (-1, -1), 1),
        ("BOTTOMPADDING", (0, 0), (-1, -1), 1),
    ]
    return Grid(rows, colWidths=[_WIDTH], style=style)


def _table(table: Table) -> LongTable:
    def of(text: str, style: str, column: int) -> Text:
        return _text(text, style if column < table.left else f"{style}-right")

    def cell(given: Cell, column: int) -> Text:
        if not given.note:
            return of(given.text, "cell", column)
        style = _style("cell" if column < table.left else "cell-right")
        return Text(f'<font color="#b54708">{_marked(given.text)} ⚠</font>', style)

    rows = [[of(head, "head", k) for k, head in enumerate(table.heads)]]
    rows += [[cell(given, k) for k, given in enumerate(row)] for row in table.rows]
    style = [
        ("LINEBELOW", (0, 0), (-1, 0), 1.0, INK),
        ("LINEBELOW", (0, 1), (-1, -1), 0.4, LINE),
        ("VALIGN", (0, 0), (-1, 0), "BOTTOM"),
        ("VALIGN", (0, 1), (-1, -1), "TOP"),
        ("LEFTPADDING", (0, 0), (-1, -1), 3),
        ("RIGHTPADDING", (0, 0), (-1, -1), 3),
        ("TOPPADDING", (0, 0), (-1, -1), 1.6),
        ("BOTTOMPADDING", (0, 0), (-1, -1), 1.6),
    ]
    return LongTable(rows, colWidths=_widths(table), repeatRows=1, style=style, hAlign="LEFT")


def _widths(table: Table) -> list[float]:
    """Of the columns: what their longest text needs, or its share of the page if that is too much."""
    wanted, least = [], []
    for k, head in enumerate(table.heads):
        texts = [row[k].text + (" ⚠" if row[k].note else "") for row in table.rows]
        cells = [pdfmetrics.stringWidth(text, "report", 6.8) for text in texts]
        words = [pdfmetrics.stringWidth(word, "report-bold", 6.8) for word in head.split()]
        # Words may part between lines, numbers may not.
        longest = max(cells, default=0.0)
        parted = max((pdfmetrics.stringWidth(w, "report", 6.8) for t in texts for w in t.split()), default=0.0)
        least.append(max([*words, parted if k < table.left else longest]) + 8.0)
        wanted.append(max([*words, longest, 24.0]) + 8.0)
    if sum(wanted) <= _WIDTH:
        return wanted
    spare = _WIDTH - sum(least)
    if spare < 0.0:
        return [_WIDTH * w / sum(least) for w in least]
    more = sum(wanted) - sum(least)
    return [low + spare * (high - low) / more for low, high in zip(least, wanted, strict=True)]


def _figure(figure: Figure, number: int) -> KeepTogether:
    across, down = ImageReader(BytesIO(figure.png)).getSize()
    scale = min(72.0 / _PIXELS_AN_INCH, _WIDTH / across, _TALLEST / down)
    caption = Text(f"{_bold(f'Figure {number}.')} {_marked(figure.caption)}", _style("caption"))
    picture = Image(BytesIO(figure.png), width=scale * across, height=scale * down)
    return KeepTogether([picture, caption, Spacer(1, 8)])
