"""The guide to recipes says what the models check."""

import re
import tomllib
from pathlib import Path

import pytest

from clerestory.trace import load
from clerestory.trace.reference import tables

GUIDE = Path(__file__).parents[2] / "docs" / "recipes.md"


def test_the_guide_has_every_key():
    text = GUIDE.read_text(encoding="utf-8")
    assert text.endswith(tables()), "renew it: python -m clerestory.trace.reference docs/recipes.md"


@pytest.mark.parametrize("recipe", re.findall(r"```toml\n(.*?)```", GUIDE.read_text(encoding="utf-8"), re.DOTALL))
def test_recipes_of_the_guide_can_be_followed(recipe):
    assert load(tomllib.loads(recipe)).warnings == []
