"""Files that are whole or not there."""

from __future__ import annotations

import os
from os import PathLike
from pathlib import Path


def write_whole(path: str | PathLike[str], contents: bytes) -> None:
    """Writes a file so that whoever looks, whenever, finds the old contents or all of the new ones.

    A link is followed, a file that must not be written is refused, and what is no file, such as a pipe, is written to.
    """
    target = Path(path).resolve()
    if target.exists() and not target.is_file():
        target.write_bytes(contents)
        return
    if target.exists():
        # A file may be protected although its folder is not.
        with open(target, "r+b"):
            pass
    unfinished = target.with_name(f".{target.name}.{os.getpid()}.tmp")
    try:
        with open(unfinished, "wb") as file:
            file.write(contents)
            file.flush()
            os.fsync(file.fileno())
        os.replace(unfinished, target)
    except BaseException:
        unfinished.unlink(missing_ok=True)
        raise
