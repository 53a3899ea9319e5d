"""What all commands share: parsing, output, files written whole, errors in one line."""

import json
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
import typer

from clerestory import ClerestoryError
from clerestory.cli import _COMMANDS, _GROUPS, app, main
from clerestory.cli.common import (
    CommandError,
    UsageError,
    about,
    angle_pair,
    in_one_line,
    numbers,
    one_of,
    print_json,
    refuse_overwriting,
    scatter_of,
    side_of,
    table,
    write_whole,
)
from clerestory.cli.lazy import loaded


def test_help_answers_without_the_heavy_libraries():
    code = (
        "import sys; from clerestory.cli import main; main(['--help']); main(['measure', '--help']);"
        "heavy = {'numpy', 'scipy', 'matplotlib', 'jinja2', 'clerestory._core', 'clerestory.cli.annual'};"
        "print(sorted(heavy & set(sys.modules)))"
    )
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert out.splitlines()[-1] == "[]"
    assert "Usage: clerestory" in out
    assert "Usage: clerestory measure" in out


def test_listed_sentences_are_those_of_the_commands():
    top = typer.main.get_command(app)
    for group, package, names in (
        (top, "clerestory.cli", _COMMANDS),
        *((top.commands[name], f"clerestory.cli.{name}", members) for name, members in _GROUPS.items()),
    ):
        assert list(group.commands)[: len(names)] == list(names)
        for name in names:
            command = loaded(package, name)
            assert command.help
            assert group.commands[name].help == command.help
            assert "Example: clerestory" in command.epilog


def test_words_are_completed(monkeypatch, capsys):
    monkeypatch.setenv("_CLERESTORY_COMPLETE", "complete_bash")
    for words, place, wanted in (
        ("clerestory an", 1, ["annual"]),
        ("clerestory measure im", 2, ["import"]),
        ("clerestory annual --cr", 2, ["--critical"]),
    ):
        monkeypatch.setenv("COMP_WORDS", words)
        monkeypatch.setenv("COMP_CWORD", str(place))
        with pytest.raises(SystemExit):
            main([])
        assert capsys.readouterr().out.split() == wanted


def test_module_runs_as_a_program():
    run = subprocess.run([sys.executable, "-m", "clerestory", "--version"], capture_output=True, text=True)
    assert run.returncode == 0
    assert run.stdout.startswith("clerestory ")


def test_no_words_give_help(capsys):
    assert main([]) == 0
    assert "Usage" in capsys.readouterr().out


def test_wrong_usage_is_one_line_and_two(capsys):
    assert main(["nonsense"]) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err == "error: no such command 'nonsense' (see `clerestory --help`)\n"


def test_angles():
    assert angle_pair("40,90", "--incident") == (40.0, 90.0)
    assert angle_pair("0, -90", "--incident") == (0.0, 270.0)
    for text in ("95,0", "40", "40,x", "nan,0", "40,inf", "1,2,3", "-5,0"):
        with pytest.raises(UsageError, match=r"--incident .*\("):
            angle_pair(text, "--incident")


def test_numbers_and_names():
    assert numbers("5,15", "--ring", 2, "5,15") == (5.0, 15.0)
    with pytest.raises(UsageError, match="such as 5,15"):
        numbers("5", "--ring", 2, "5,15")
    assert side_of("ext") == "exterior"
    assert side_of("Interior") == "interior"
    assert scatter_of("r") == "reflection"
    assert one_of("t", "--scatter", ("transmission", "reflection")) == "transmission"
    for text in ("", "front", "x"):
        with pytest.raises(UsageError, match="give exterior or interior"):
            side_of(text)


@dataclass
class Result:
    value: float
    values: np.ndarray
    where: Path


def test_json_has_no_nan_and_keeps_letters(capsys):
    print_json({"a": Result(float("nan"), np.array([1.0, np.inf]), Path("x")), 3: ("φ", np.int64(2), None)})
    text = capsys.readouterr().out
    assert json.loads(text) == {"a": {"value": None, "values": [1.0, None], "where": "x"}, "3": ["φ", 2, None]}
    assert "φ" in text


def test_table_aligns():
    assert table(["θ", "T"], [["0°", "0.5"], ["30°", "0.25"]]) == "  θ       T\n  0°    0.5\n  30°  0.25"


def test_files_are_written_whole_or_not_at_all(tmp_path, monkeypatch):
    path = tmp_path / "x.txt"
    write_whole(path, "old")
    write_whole(path, b"new")
    assert path.read_bytes() == b"new"
    assert [p.name for p in tmp_path.iterdir()] == ["x.txt"]
    assert path.stat().st_mode & 0o600 == 0o600

    def no_space(*_args):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "replace", no_space)
    with pytest.raises(OSError, match="No space") as caught:
        write_whole(path, b"newer")
    assert in_one_line(caught.value) == f"{path}: no space left on device (free some space)"
    assert path.read_bytes() == b"new"
    assert [p.name for p in tmp_path.iterdir()] == ["x.txt"]


def test_writing_needs_a_folder(tmp_path):
    with pytest.raises(FileNotFoundError, match=r"no/x'$"):
        write_whole(tmp_path / "no" / "x", b"")
    with pytest.raises(IsADirectoryError):
        write_whole(tmp_path, b"")


def test_an_input_is_never_overwritten(tmp_path):
    path = tmp_path / "x.xml"
    path.write_bytes(b"")
    refuse_overwriting(tmp_path / "y.xml", [path])
    with pytest.raises(UsageError, match="would overwrite an input"):
        refuse_overwriting(tmp_path / "." / "x.xml", [path])


def test_errors_name_the_file_once():
    with pytest.raises(FileNotFoundError) as missing, about(Path("x.xml")):
        Path("x.xml").read_bytes()
    assert in_one_line(missing.value) == "x.xml: no such file or directory (check the path)"
    with pytest.raises(CommandError, match=r"^x\.xml: no band \(give one\)$"), about(Path("x.xml")):
        raise ClerestoryError("no band\n(give one)")
    with pytest.raises(ZeroDivisionError), about(Path("x.xml")):
        raise ZeroDivisionError
    assert in_one_line(PermissionError(13, "Permission denied", "a")) == "a: permission denied (check the permissions)"
