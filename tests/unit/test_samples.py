"""The helpers that find sample data."""

import gzip

import samples


def test_absent_data_gives_one_skipped_parameter(monkeypatch, tmp_path):
    monkeypatch.setenv("CLERESTORY_DATA", str(tmp_path / "nowhere"))
    assert samples.sample_root() is None
    assert samples.find_samples("klems") == []
    (parameter,) = samples.sample_files("klems")
    assert parameter.marks[0].kwargs["reason"] == samples.ABSENT


def test_files_are_found_in_any_case_and_unpacked(monkeypatch, tmp_path):
    folder = tmp_path / "klems"
    folder.mkdir()
    (folder / "a.XML.gz").write_bytes(gzip.compress(b"<a/>"))
    (folder / "b.xml").write_bytes(b"<b/>")
    (folder / "README.md").write_bytes(b"")
    monkeypatch.setenv("CLERESTORY_DATA", str(tmp_path))
    packed, plain = samples.find_samples("klems")
    assert samples.unpacked(packed, tmp_path).read_bytes() == b"<a/>"
    assert samples.unpacked(plain, tmp_path) == plain
