"""The exceptions of this package. All of them are an Error."""

from __future__ import annotations


class Error(Exception):
    """What this package refuses or cannot do."""


class InputError(Error, ValueError):
    """Input that cannot be accepted: a scene, a mesh, a recording. The message names place, value and what is allowed."""


class SceneError(InputError):
    """A scene that cannot be accepted.

    Attributes:
        file: the scene's file.
        line: of the key, from 1; 0 where the file as a whole is meant.
        key: in full, such as "organs[0].tissue.drag_per_s"; "" where there is none.
    """

    def __init__(self, message: str, file: str = "", line: int = 0, key: str = "") -> None:
        super().__init__(message, file, line, key)
        self.file = file
        self.line = line
        self.key = key

    def __str__(self) -> str:
        return str(self.args[0])


class ClosedError(Error, RuntimeError):
    """A session or connection was used after close()."""


class BusyError(Error, RuntimeError):
    """A session or connection was used while another thread did: one at a time."""
