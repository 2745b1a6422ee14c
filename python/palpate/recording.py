"""Recordings of sessions."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from pathlib import Path

from palpate import _core
from palpate.messages import Topic, Topics, topic_from
from palpate.paths import path_text


class Recording(Topics):
    """What a recording holds: its topics by name, each with its messages as arrays.

    Attributes:
        file: where it was read from.
        scene: name and digest of its scene, where one was heard.
        invalid: by topic, how many samples no reader would have accepted; they are left out.
        warning: one line about a file that was not ended; "" for a whole one.
    """

    def __init__(
        self, file: Path, topics: Mapping[str, Topic], scene: dict[str, str], invalid: dict[str, int], warning: str
    ) -> None:
        super().__init__(topics)
        self.file = file
        self.scene = scene
        self.invalid = invalid
        self.warning = warning

    def __repr__(self) -> str:
        torn = f"\n  {self.warning}" if self.warning else ""
        return f"<palpate.Recording {str(self.file)!r} of scene {self.scene.get('name', '?')}{self._summary()}{torn}>"


def read(file: str | os.PathLike[str], topics: Iterable[str] = ()) -> Recording:
    """Reads a recording (.mcap), all of it or these topics alone.

    Raises:
        InputError: it cannot be read, or is no recording of ours; there is no such topic.
    """
    wanted = {topics} if isinstance(topics, str) else set(topics)
    read_topics, scene, invalid, torn = _core.read_recording(path_text(file), wanted)
    return Recording(Path(file), {t[0]: topic_from(*t) for t in read_topics}, scene, invalid, torn)
