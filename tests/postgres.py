"""A PostgreSQL server to throw away, for tests: its data in a temporary folder, reached through a socket there."""

import os
import shutil
import subprocess
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

ABSENT = "PostgreSQL absent (its programs initdb and pg_ctl are neither on PATH nor in /usr/lib/postgresql)"
_PORT = "54329"  # only the name of the socket: the server listens to no network


def programs() -> Path | None:
    """The folder of the server's programs, the newest where there are several; none where they are absent."""
    on_path = shutil.which("pg_ctl")
    if on_path is not None:
        return Path(on_path).resolve().parent
    found = [path.parent for path in Path("/usr/lib/postgresql").glob("*/bin/pg_ctl")]
    return max(found, key=lambda folder: float(folder.parent.name), default=None)


@contextmanager
def server(bin_folder: Path) -> Iterator[str]:
    """The address of a server's database `postgres`, which is stopped in the end."""
    # PostgreSQL refuses to run as root, and a socket's path may not be long.
    as_user = ["runuser", "-u", "nobody", "--"] if os.geteuid() == 0 else []
    folder = Path(tempfile.mkdtemp(prefix="pg-", dir="/tmp"))
    try:
        if as_user:
            shutil.chown(folder, "nobody")
        data, log = folder / "data", folder / "log"
        run = [*as_user, str(bin_folder / "initdb"), "-D", str(data), "-U", "tester", "-A", "trust", "-E", "UTF8"]
        _run([*run, "--no-sync", "--locale=C"], folder)
        settings = f"-k {folder} -p {_PORT} -c listen_addresses= -c fsync=off"
        control = [*as_user, str(bin_folder / "pg_ctl"), "-D", str(data)]
        _run([*control, "-l", str(log), "-w", "-t", "60", "-o", settings, "start"], folder)
        try:
            yield f"postgresql://tester@/postgres?host={folder}&port={_PORT}"
        finally:
            _run([*control, "-m", "immediate", "-w", "stop"], folder)
    finally:
        shutil.rmtree(folder)


def _run(command: list[str], folder: Path) -> None:
    done = subprocess.run(command, capture_output=True, text=True, cwd=folder, check=False)
    if done.returncode:
        raise RuntimeError(f"{' '.join(command)}: {done.stderr or done.stdout}")
