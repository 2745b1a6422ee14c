"""Scenes: what is simulated, key by key."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from palpate import _core
from palpate.errors import InputError
from palpate.paths import path_text


def _is_scene_or_empty(file: Path) -> bool:
    with open(file, "rb") as stream:
        beginning = stream.read(1 << 16)
    return not beginning or b"palpate_scene:" in beginning


def scene_path(name: str) -> Path:
    """The file of a scene that comes with Palpate, such as "stomach_probe".

    Raises:
        InputError: there is none of that name; the message lists those there are.
    """
    package = Path(os.path.abspath(__file__)).parent
    shares = [package / "share"] + [folder / "share" / "palpate" for folder in package.parents]
    if os.environ.get("PALPATE_SHARE"):
        shares.insert(0, Path(os.environ["PALPATE_SHARE"]))
    for share in shares:
        folder = share / "scenes"
        if not folder.is_dir():
            continue
        file = folder / f"{name}.yaml"
        if file.is_file():
            return file
        names = ", ".join(sorted(path.stem for path in folder.glob("*.yaml")))
        raise InputError(f"no scene '{name}' in {folder}; there are: {names}")
    raise InputError("Palpate's scenes are not installed; PALPATE_SHARE names the folder that holds them")


class Scene:
    """A scene, whose keys are read and changed by their path.

    >>> scene = Scene.load(scene_path("stomach_probe"))
    >>> scene["organs[0].tissue.youngs_modulus_pa"] = 8e3

    Keys, units, ranges and defaults are those of docs/scene.md. Each change is checked as if the file said it;
    one that is refused changes nothing.
    """

    def __init__(self, core: _core.Scene) -> None:
        self._core = core

    @classmethod
    def load(cls, file: str | os.PathLike[str]) -> Scene:
        """Reads a scene file.

        Raises:
            SceneError: with file, line and key of what cannot be accepted.
        """
        return cls(_core.Scene.load(path_text(file)))

    @classmethod
    def parse(cls, text: str, file: str | os.PathLike[str] = "scene.yaml") -> Scene:
        """A scene from its text. `file` is named in messages; meshes are looked for beside it.

        Raises:
            SceneError: as load().
        """
        return cls(_core.Scene.parse(text, path_text(file)))

    def __getitem__(self, path: str) -> Any:
        """The value of a key, default or not: None, bool, int, float, str, list or dict (a copy).

        Raises:
            SceneError: there is no such key.
        """
        return self._core.value(path)

    def __setitem__(self, path: str, value: Any) -> None:
        """Changes a key; None gives it its default back. An entry one behind a list's last is added.

        Raises:
            SceneError: the value, or the scene with it, is not allowed.
            TypeError: for what no scene can hold.
        """
        self._core.change({path: value})

    def __delitem__(self, path: str) -> None:
        """Gives a key its default back, or takes an entry out of a list."""
        self._core.change({path: None})

    def update(self, values: Mapping[str, Any]) -> None:
        """Changes several keys at once, for those that are allowed only together. All of them, or none.

        Raises:
            SceneError, TypeError: as for one.
        """
        self._core.change(dict(values))

    def copy(self) -> Scene:
        """Another scene, the same."""
        return Scene(self._core.copy())

    def text(self) -> str:
        """The scene as YAML with every default written out; parse() of it is the same scene."""
        return self._core.text()

    def save(self, file: str | os.PathLike[str]) -> None:
        """Writes text() to a file, whole or not at all. Meshes keep their full names; comments are gone.

        Raises:
            FileExistsError: the file is there, not empty and no scene: such a one is not replaced.
            OSError: the file cannot be written.
        """
        place = Path(file).resolve()
        if place.exists() and not _is_scene_or_empty(place):
            raise FileExistsError(f"{file}: is there and no scene; it is not replaced")
        part = place.with_name(f"{place.name}.{os.getpid()}.part")
        try:
            part.write_text(self.text(), encoding="utf-8")
            part.replace(place)
        finally:
            part.unlink(missing_ok=True)

    @property
    def digest(self) -> str:
        """16 hexadecimal digits over the scene and the files it names: equal iff the physics is the same."""
        return self._core.digest()

    @property
    def name(self) -> str:
        """What the scene is called."""
        return self._core.name

    @property
    def file(self) -> Path:
        """Where it was read from."""
        return Path(self._core.file)

    @property
    def organs(self) -> list[str]:
        """The organs' names, in the scene's order."""
        return self._core.organs

    @property
    def probes(self) -> list[str]:
        """The probes' names, in the scene's order."""
        return self._core.probes

    def __repr__(self) -> str:
        return f"<palpate.Scene {self.name!r}: organs {', '.join(self.organs)}; probes {', '.join(self.probes)}>"

    def __reduce__(self) -> tuple[Any, ...]:
        return (Scene.parse, (self.text(), str(self.file)))

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Scene):
            return NotImplemented
        return self.text() == other.text()

    __hash__ = None  # type: ignore[assignment]  # it can change
