"""The report: whole, self-contained, escaped, the same every time."""

import re
from html.parser import HTMLParser

import pytest

from clerestory import Bsdf, Model
from clerestory.compare import compare, write_report
from clerestory.compare.report import html
from clerestory.plot.view import View
from clerestory.report.frame import subscripts

ET = ("exterior", "transmission")
EVIL = '<script>alert("x")</script> & "Co"'
VOID = {"meta", "img", "br", "link", "input", "hr"}


class Nesting(HTMLParser):
    """Every tag is closed in its order."""

    def __init__(self):
        super().__init__()
        self.open = []
        self.tags = []

    def handle_starttag(self, tag, attributes):
        self.tags.append((tag, dict(attributes)))
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag


@pytest.fixture(scope="module")
def comparison():
    milky = Bsdf.from_models({ET: Model.lambertian(0.5)}).with_metadata(name=EVIL)
    clear = Bsdf.from_models({ET: Model.sum([(1.0, Model.specular(0.3)), (1.0, Model.lambertian(0.2))])})
    return compare({EVIL: milky, "clear": clear}, patches=(1, 41), against_models=True)


@pytest.fixture(scope="module")
def report(comparison):
    return html(comparison, title="A & B", command="clerestory compare <a> b", date=None)


def test_report_is_well_formed_and_fetches_nothing(report):
    parser = Nesting()
    parser.feed(report)
    assert parser.open == []
    images = [a for tag, a in parser.tags if tag == "img"]
    assert len(images) == 3
    assert all(a["src"].startswith("data:image/png;base64,") and a["alt"] for a in images)
    assert not re.search(r"https?://|@import|url\(", report)
    assert not [tag for tag, _ in parser.tags if tag in {"script", "link", "iframe"}]


def test_labels_and_file_texts_are_escaped(report):
    assert "<script>" not in report
    assert "&lt;script&gt;" in report
    assert "A &amp; B" in report


def test_every_main_value_is_shown(comparison, report):
    assert "T<sub>d\u2011h</sub>" in report
    assert "Against simple models" in report
    assert f"Clerestory {comparison.version}" in report
    assert "clerestory compare &lt;a&gt; b" in report


def test_values_under_the_pictures_are_those_of_the_table(comparison, report):
    assert "Under each stands T<sub>d\u2011h</sub> of table 2, the mean over the incident patch" in report
    samples = comparison.settings.samples
    for patch in (1, 41):
        (quantity,) = [q for q in comparison.of_group("direct-hemispherical") if q.patch == patch]
        for label, value in zip(comparison.labels, quantity.values, strict=True):
            assert View.of(comparison.data[label], patch).total(samples=samples) == value


def test_the_same_data_make_the_same_bytes(comparison, report, tmp_path):
    path = tmp_path / "report.html"
    write_report(comparison, path, title="A & B", command="clerestory compare <a> b")
    assert path.read_text(encoding="utf-8") == report
    assert [p.name for p in tmp_path.iterdir()] == ["report.html"]
    dated = html(comparison, date="2026-11-22")
    assert "2026-11-22" in dated
    assert "2026-11-22" not in report


def test_a_report_that_cannot_be_written_leaves_nothing(comparison, tmp_path):
    with pytest.raises(OSError, match="no folder"):
        write_report(comparison, tmp_path / "no folder" / "report.html")
    assert list(tmp_path.iterdir()) == []


def test_subscripts_do_not_unescape():
    assert subscripts("T_d-h of <b>") == "T<sub>d\u2011h</sub> of &lt;b&gt;"
