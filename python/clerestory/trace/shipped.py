"""The recipes that come with Clerestory."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from clerestory.trace.keys import RecipeError, suggestion


@dataclass(frozen=True)
class Shelf:
    """A folder of recipes that come with Clerestory."""

    folder: Path
    """Where they are."""
    what: str
    """What they are called: recipe, room."""
    command: str
    """The command that lists them."""

    def names(self) -> list[str]:
        """The names of all."""
        return sorted(path.stem for path in self.folder.glob("*.toml"))

    def path_of(self, name: str) -> Path | None:
        """The file of one by its name."""
        return self.folder / f"{name}.toml" if name in self.names() else None

    def about(self, name: str) -> str:
        """What one is, in one line: the comment at its head."""
        first = (self.folder / f"{name}.toml").read_text(encoding="utf-8").splitlines()[0]
        return first.removeprefix("#").strip().rstrip(".")

    def find(self, source: str | Path) -> Path:
        """The file that a person means by a name of one, or by a path.

        Raises
        ------
        RecipeError
            It looks like a name, and there is none such.
        """
        path = Path(source)
        shipped = self.path_of(str(source)) if not path.suffix else None
        if shipped is None and not path.suffix and not path.exists():
            hint = suggestion(str(source), self.names())
            raise RecipeError(
                f"{source}: no {self.what} has this name ({hint}; `clerestory {self.command} --list` tells more)"
            )
        return shipped or path


def beside(given: str, folder: Path, *shelves: Shelf) -> Path:
    """The file that a file in a folder means by a path, or by a name of what comes with Clerestory.

    Raises
    ------
    RecipeError
        It looks like a name, and there is none such.
    """
    within = folder / given
    if within.suffix or within.is_file():
        return within
    for shelf in shelves:
        if (path := shelf.path_of(given)) is not None:
            return path
    if within.exists():
        return within
    known = [name for shelf in shelves for name in shelf.names()]
    raise RecipeError(f"{given}: neither a file nor a name that comes with Clerestory ({suggestion(given, known)})")


RECIPES = Shelf(Path(__file__).parent / "recipes", "recipe", "trace")
names = RECIPES.names
