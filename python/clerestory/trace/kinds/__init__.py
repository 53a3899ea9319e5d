"""The kinds of samples, a file a family."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from clerestory.trace.kinds.blind import Louvre, VenetianBlind

Single = Annotated[VenetianBlind | Louvre, Field(discriminator="kind")]
"""A sample of one kind."""
AnySample = Single
"""A sample of any kind."""
