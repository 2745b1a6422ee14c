"""Names of files, as Python's own functions take them."""

from __future__ import annotations

import os


def path_text(file: str | os.PathLike[str]) -> str:
    """The file's name.

    Raises:
        ValueError: it holds a zero byte, where the system would end it.
    """
    text = os.fspath(file)
    if "\0" in text:
        raise ValueError(f"embedded null byte: {text!r}")
    return text
