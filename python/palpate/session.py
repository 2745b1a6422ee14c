"""Sessions in this process: haptics, collision and deformation in lockstep, as fast as the machine allows."""

from __future__ import annotations

import os
from collections.abc import Iterable
from typing import Any

import numpy as np
import numpy.typing as npt

from palpate import _core
from palpate.closing import Closing
from palpate.messages import Message, Topics, topic_from
from palpate.numbers import whole
from palpate.paths import path_text
from palpate.scene import Scene

FloatArray = npt.NDArray[np.float64]


class Session(Closing[_core.Session]):
    """A session of a scene, the same bits as `palpate run --in-process`.

    >>> with Session(Scene.load("stomach_probe.yaml")) as session:
    ...     session.run(2.0)
    ...     session.force()

    A session belongs to one thread at a time; as many sessions as you like run in threads (stepping releases the
    GIL) or processes. Probes and organs go by their index or name. Arrays that it gives are read-only views of what
    a module said last; they keep that alive and unchanged, however far the session goes on.

    Args:
        scene: a Scene, or the file of one.
        record: a recording (.mcap) of every message that carries physics goes here; close() ends it.
        from_snapshot: a snapshot (save_snapshot(), `palpate run --snapshot-at`) of the same scene; the session goes
            on there, the same bits as one never interrupted, and guides the probes that were guided. positions() are
            those of then at once; forces and contacts are zero until the next step says them.
        overwrite: replace a recording of that name; nothing else is replaced.

    Raises:
        FileExistsError: there is a file of the recording's name, and it is not to be replaced.
        SceneError, InputError: the scene, or a mesh or recording that it names, or the snapshot cannot be used.
    """

    def __init__(
        self,
        scene: Scene | str | os.PathLike[str],
        record: str | os.PathLike[str] | None = None,
        from_snapshot: str | os.PathLike[str] | None = None,
        overwrite: bool = False,
    ) -> None:
        self._scene = scene.copy() if isinstance(scene, Scene) else Scene.load(scene)
        self._organs = {name: i for i, name in enumerate(self._scene.organs)}
        self._probes = {name: i for i, name in enumerate(self._scene.probes)}
        files = [None if file is None else path_text(file) for file in (record, from_snapshot)]
        if files[0] is not None and not overwrite and os.path.exists(files[0]):
            raise FileExistsError(f"{files[0]}: is there already; give another name, or overwrite=True")
        self._core = _core.Session(self._scene._core, *files)

    def save_snapshot(self, file: str | os.PathLike[str], overwrite: bool = False) -> float:
        """Saves the session as it is now, for Session(scene, from_snapshot=file).

        Args:
            overwrite: replace a snapshot of that name; nothing else is replaced.

        Returns:
            Its simulated time [s].

        Raises:
            InputError: there is something of that name, or it cannot be written.
            ClosedError, BusyError.
        """
        return self._core.save_snapshot(path_text(file), overwrite)

    # Time goes on.

    def step(self, periods: int = 1) -> None:
        """Goes on by periods of deformation (1/250 s, unless the scene says otherwise), with the haptic ticks and
        contact searches that belong to them.

        Raises:
            KeyboardInterrupt: Ctrl-C, of a long call within 50 ms, in the main thread; the session can go on.
            ClosedError, BusyError.
        """
        self._core.step(whole("periods", periods, least=0))

    def run(self, seconds: float, keep: Iterable[str] = ()) -> Topics:
        """Goes on by simulated seconds, as run_until(time + seconds)."""
        return self.run_until(self.time + seconds, keep)

    def run_until(self, time: float, keep: Iterable[str] = ()) -> Topics:
        """Goes on until simulated `time` [s]: all cycles that begin before it. Nothing, if that is past.

        Args:
            keep: topics whose every message is wanted.

        Returns:
            Those topics, with what was said meanwhile.

        Raises:
            KeyError: there is no topic of that name.
            ValueError: for a time below 0, beyond 1e6 s or not a number.
            KeyboardInterrupt, ClosedError, BusyError: as step().
        """
        names = [keep] if isinstance(keep, str) else list(keep)
        if not names:
            self._core.run_until(time)
            return Topics({})
        return Topics({t[0]: topic_from(*t) for t in self._core.run_keeping(time, names)})

    def settle(self, speed_m_per_s: float = 1e-4, still_s: float = 0.1, within_s: float = 10.0) -> bool:
        """Goes on until no node of any organ was faster than `speed_m_per_s`, from one period to the next, for
        `still_s`. False if that did not come within `within_s`."""
        return self._core.settle(speed_m_per_s, still_s, self.time + within_s)

    @property
    def time(self) -> float:
        """When the next cycle begins, simulated [s]. Any thread may ask."""
        return self._core.time

    @property
    def period(self) -> float:
        """Of deformation [s]."""
        return self._core.period

    # What it is told.

    def set_probe(
        self,
        position_m: npt.ArrayLike,
        rotation_xyzw: npt.ArrayLike = (0, 0, 0, 1),
        *,
        probe: int | str = 0,
        linear_velocity_m_per_s: npt.ArrayLike = (0, 0, 0),
        angular_velocity_rad_per_s: npt.ArrayLike = (0, 0, 0),
    ) -> None:
        """At the next haptic tick the probe is there and goes on at this velocity until it is set again, in place of
        what its device in the scene does.

        Args:
            position_m: of its origin in the world (3,), within ±100 m.
            rotation_xyzw: unit quaternion (4,).
            linear_velocity_m_per_s, angular_velocity_rad_per_s: in the world (3,), within ±100.

        Raises:
            TypeError, ValueError: another shape, range, or not finite.
            IndexError, KeyError: there is no such probe.
        """
        self._core.guide_probe(
            _index(self._probes, probe),
            position_m,
            rotation_xyzw,
            linear_velocity_m_per_s,
            angular_velocity_rad_per_s,
        )

    def set_volume_ratio(self, ratio: float, organ: int | str = 0) -> None:
        """The volume asked for, over the rest volume [0.2 … 5], in place of the scene's `filling`; followed no
        faster than that one's `max_rate_per_s`.

        Raises:
            ValueError, IndexError, KeyError.
        """
        self._core.ask_for_volume(_index(self._organs, organ), ratio)

    # What it says.

    def latest(self, topic: str, key: int | str = 0) -> Message:
        """The newest message of `probe_state`, `haptic_force`, `contacts`, `contact_model` (key: a probe; of
        the first deformation process), `node_positions` or `surface` (key: an organ). Its arrays are not copied.

        Raises:
            KeyError, IndexError: there is none of that name or key.
        """
        names = self._organs if topic in ("node_positions", "surface") else self._probes
        return Message(topic, self._core.newest(topic, _index(names, key)))

    def positions(self, organ: int | str = 0) -> npt.NDArray[np.float32]:
        """Nodes of an organ in the world [m]  (nodes, 3): surface nodes first, as `triangles` counts them. A view."""
        return self._organ(organ)["positions_m"]  # type: ignore[no-any-return]

    def triangles(self, organ: int | str = 0) -> npt.NDArray[np.uint32]:
        """Nodes of each triangle of its surface, counter-clockwise seen from outside  (triangles, 3). A view."""
        return self.latest("surface", organ)["triangle_nodes"]  # type: ignore[no-any-return]

    def volume(self, organ: int | str = 0) -> float:
        """Enclosed by an organ [m³]."""
        return float(self._organ(organ)["volume_m3"])

    def pressure(self, organ: int | str = 0) -> float:
        """Of its contents over the outside [Pa]."""
        return float(self._organ(organ)["pressure_pa"])

    def force(self, probe: int | str = 0) -> FloatArray:
        """Rendered to the hand that holds a probe, in the world [N]  (3,). A view."""
        return self.latest("haptic_force", probe)["force_n"]  # type: ignore[no-any-return]

    def probe_position(self, probe: int | str = 0) -> FloatArray:
        """Of its origin in the world [m]  (3,). A view."""
        return self.latest("probe_state", probe)["position_m"]  # type: ignore[no-any-return]

    def contacts(self, probe: int | str = 0) -> Message:
        """Where a probe touches: "contacts.gap_m" (contacts,), "contacts.point_P_m" (contacts, 3), … Views."""
        return self.latest("contacts", probe)

    def guards(self) -> list[str]:
        """What keeps the session from what was asked for right now, "module: why"; mostly none."""
        return self._core.guards()

    @property
    def scene(self) -> Scene:
        """A copy of its scene."""
        return self._scene.copy()

    # Its end.

    def close(self) -> None:
        """Ends the session and its recording. Views stay good."""
        super().close()

    def __repr__(self) -> str:
        state = "closed at" if self.closed else "at"
        return f"<palpate.Session of {self._scene.name!r} {state} {self.time:.3f} s>"

    def __reduce__(self) -> Any:
        raise TypeError("a running session cannot be pickled; its scene can")

    def _organ(self, organ: int | str) -> Message:
        return self.latest("node_positions", organ)


def _index(names: dict[str, int], key: int | str) -> int:
    if not isinstance(key, str):
        index = whole("an index", key)
        if not 0 <= index < len(names):
            raise IndexError(f"no {index}; there are 0 to {len(names) - 1}: {', '.join(names)}")
        return index
    if key not in names:
        raise KeyError(f"no {key!r}; there are: {', '.join(names)}")
    return names[key]
