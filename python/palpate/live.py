"""Sessions of other processes on this host, heard and spoken to over DDS."""

from __future__ import annotations

import atexit
import weakref
from typing import Any

import numpy.typing as npt

from palpate import _core
from palpate.closing import Closing
from palpate.messages import Message, Topic, topic_from


class Live(Closing[_core.Live]):
    """A connection to a running session (`palpate run`); connect() makes it.

    Every topic can be read. A topic is heard from the first time it is asked for. One thread at a time.
    """

    def __init__(self, session: str, domain: int) -> None:
        self._session = session
        self._core = _core.Live(session, domain)
        _open.add(self)

    def latest(self, topic: str, key: int | str | None = None, timeout_s: float = 1.0) -> Message:
        """The newest message of a topic; waits for the first one. Its arrays are read-only views that keep it.

        Args:
            key: a probe's or organ's index, or a module's name; None: whichever came last.

        Raises:
            KeyError: there is no such topic.
            TimeoutError: none came within `timeout_s`.
            KeyboardInterrupt, ClosedError, BusyError.
        """
        fields = self._core.newest(topic, "" if key is None else str(key), timeout_s)
        if fields is None:
            raise TimeoutError(f"no {topic} was heard in session {self._session!r} within {timeout_s} s")
        return Message(topic, fields)

    def take(self, topic: str) -> Topic:
        """All that came of a topic since the last `take`, as arrays of their own; the first time since it was asked
        for last. Who looks less often than every 50 ms may miss some of the fastest topics (`sequence_number` tells).

        Raises:
            KeyError, ClosedError, BusyError.
        """
        return topic_from(topic, *self._core.take(topic))

    def write_probe_input(
        self,
        position_m: npt.ArrayLike,
        rotation_xyzw: npt.ArrayLike = (0, 0, 0, 1),
        *,
        probe: int = 0,
        linear_velocity_m_per_s: npt.ArrayLike = (0, 0, 0),
        angular_velocity_rad_per_s: npt.ArrayLike = (0, 0, 0),
        buttons: int = 0,
    ) -> None:
        """Moves a probe whose device in the scene is `topic`, as a driver does: as often as the device is read, a
        thousand times a second if it can be. At 20 to 60 Hz forces come in steps of the slew limit; after 50 ms of
        silence they fade (docs/haptic_safety.md). Without a velocity the poses tell it.

        Raises:
            TypeError, ValueError: another shape, or not finite.
            IndexError: a probe below 0. (Of one that the scene has not nobody hears.)
            RuntimeError: it could not be sent.
        """
        if not self._core.write_probe_input(
            probe, position_m, rotation_xyzw, linear_velocity_m_per_s, angular_velocity_rad_per_s, buttons
        ):
            raise RuntimeError("probe_input could not be sent")

    def wait_for_haptics(self, timeout_s: float = 5.0) -> bool:
        """Waits until somebody hears probe_input; False if nobody did within `timeout_s`."""
        return self._core.wait_for_haptics(timeout_s)

    def control(self, command: str, timeout_s: float = 5.0) -> None:
        """Says `start` (or go on), `pause`, `reset` or `stop` to every process of the session (`session_control`).
        The launcher's last command is heard first, and its repetition of this one afterwards: then the connection
        may be closed. Each is waited for `timeout_s` at most.

        Raises:
            ValueError: another command.
            TimeoutError: the session was not heard within `timeout_s`.
        """
        if not self._core.control(command, timeout_s):
            raise TimeoutError(f"session {self._session!r} was not heard within {timeout_s} s")

    @property
    def phase(self) -> str:
        """What the session does by its own commands: waiting, running, paused or stopped."""
        return self._core.phase()

    def close(self) -> None:
        """Leaves the session, which goes on. Views stay good."""
        super().close()

    def __repr__(self) -> str:
        return f"<palpate.Live session {self._session!r}{', closed' if self.closed else ''}>"

    def __reduce__(self) -> Any:
        raise TypeError("a connection cannot be pickled")


def connect(session: str = "default", domain: int = 0) -> Live:
    """Connects to a session of other processes: its name (`palpate run --session`) and DDS domain [0 … 200].

    Raises:
        InputError: no such name or domain can be. RuntimeError: DDS cannot start.
    """
    return Live(session, domain)


_open: weakref.WeakSet[Live] = weakref.WeakSet()


@atexit.register
def _end() -> None:
    """Calls in daemon threads come back first, with a ClosedError; DDS has threads of its own, which must end before
    the interpreter does."""
    _core.end_work()
    for live in list(_open):
        live.close()
