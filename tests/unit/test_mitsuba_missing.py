"""The material for Mitsuba where Mitsuba is not installed."""

import sys
from importlib import import_module

import pytest

from clerestory import ClerestoryError


def test_what_to_install_is_said(monkeypatch):
    monkeypatch.setitem(sys.modules, "mitsuba", None)
    monkeypatch.setitem(sys.modules, "drjit", None)
    monkeypatch.delitem(sys.modules, "clerestory.mitsuba", raising=False)
    with pytest.raises(ClerestoryError, match=r"pip install 'clerestory\[mitsuba\]'"):
        import_module("clerestory.mitsuba")
