"""What is opened is closed, by hand or at the end of a `with` block."""

from __future__ import annotations

from types import TracebackType
from typing import Generic, Protocol, Self, TypeVar


class _Core(Protocol):
    def close(self) -> None: ...
    @property
    def closed(self) -> bool: ...


CoreType = TypeVar("CoreType", bound=_Core)


class Closing(Generic[CoreType]):
    """What a Session and a Live share."""

    _core: CoreType

    @property
    def closed(self) -> bool:
        """Whether close() was called."""
        return self._core.closed

    def close(self) -> None:
        """Ends it. Views stay good."""
        self._core.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()
