"""What modules tell each other: one message, or many of a topic as arrays."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    import pandas  # type: ignore[import]

_KEYS = ("probe", "organ", "module_name")


class Message(Mapping[str, Any]):
    """One message: its fields by the names of docs/topics.md, "force_n", "contacts.gap_m".

    Numbers are int or float, words and texts str. Vectors have shape (3,), rotations (4,) as x, y, z, w, matrices
    (3, 3); a list of n entries (n,) or (n, …). Arrays look into the message's own memory without a copy; they are
    read-only, and stay as they are when newer messages come.
    """

    def __init__(self, topic: str, fields: dict[str, Any]) -> None:
        self._topic = topic
        self._fields = fields

    @property
    def topic(self) -> str:
        """The topic's name."""
        return self._topic

    @property
    def time(self) -> float:
        """Simulated time it belongs to [s]."""
        return float(self._fields["sim_time_ns"] * 1e-9)

    def __getitem__(self, field: str) -> Any:
        return self._fields[field]

    def __iter__(self) -> Iterator[str]:
        return iter(self._fields)

    def __len__(self) -> int:
        return len(self._fields)

    def __repr__(self) -> str:
        keys = [f"{key} {self._fields[key]}" for key in _KEYS if key in self._fields]
        lines = [f"<palpate {self._topic}{''.join(' of ' + key for key in keys)} at {self.time:.3f} s"]
        lines += [f"  {name}: {_short(value)}" for name, value in self._fields.items()]
        return "\n".join(lines) + ">"


class Ragged:
    """A field of which each message has any number of entries.

    `ragged[i]` is that of message i, a view (n, …); np.asarray(ragged) one array (messages, n, …) where all have as
    many.

    Attributes:
        values: the entries of all messages, one after the other  (total, …).
        offsets: where the entries of each message begin, and the end  (messages + 1,).
    """

    def __init__(self, values: Any, offsets: npt.NDArray[np.int64]) -> None:
        self.values = values
        self.offsets = offsets

    def __len__(self) -> int:
        return len(self.offsets) - 1

    def __getitem__(self, index: int) -> Any:
        i = range(len(self))[index]
        return self.values[self.offsets[i] : self.offsets[i + 1]]

    @property
    def counts(self) -> npt.NDArray[np.int64]:
        """Number of entries of each message  (messages,)."""
        return np.diff(self.offsets)

    def __array__(self, dtype: npt.DTypeLike = None) -> npt.NDArray[Any]:
        counts = self.counts
        if len(counts) and (counts != counts[0]).any():
            raise ValueError(f"messages have {counts.min()} to {counts.max()} entries: no array; take them one by one")
        values = np.asarray(self.values, dtype=dtype)
        return values.reshape(len(self), int(counts[0]) if len(counts) else 0, *values.shape[1:])

    def __repr__(self) -> str:
        return f"<palpate.Ragged {len(self)} messages, {len(self.values)} entries>"


class Topic(Mapping[str, Any]):
    """Messages of one topic as arrays, one per field of docs/topics.md, in the order in which they were said.

    A number is an array (messages,), a vector (messages, 3), a rotation (messages, 4), a matrix (messages, 3, 3);
    texts and words are a list of str; lists are Ragged. The arrays are yours: they can be written to.
    """

    def __init__(self, name: str, columns: Mapping[str, Any], length: int) -> None:
        self._name = name
        self._columns = dict(columns)
        self._length = length

    @property
    def name(self) -> str:
        """The topic's name."""
        return self._name

    @property
    def time(self) -> npt.NDArray[np.float64]:
        """Simulated time of each message [s]  (messages,)."""
        if self._length == 0:
            return np.empty(0)
        return np.asarray(self._columns["sim_time_ns"] * 1e-9, dtype=np.float64)

    @property
    def messages(self) -> int:
        """How many there are."""
        return self._length

    def of(self, key: int | str) -> Topic:
        """Those of one probe, organ or module alone.

        Raises:
            KeyError: the topic has no keys.
        """
        if self._length == 0:
            return self
        name = next((name for name in _KEYS if name in self._columns), None)
        if name is None:
            raise KeyError(f"topic {self._name} has no keys")
        wanted = np.array([value == key for value in self._columns[name]], dtype=bool)
        return Topic(self._name, {n: _chosen(c, wanted) for n, c in self._columns.items()}, int(wanted.sum()))

    def to_pandas(self) -> pandas.DataFrame:
        """A table with a row per message, indexed by time_s; parts of vectors as columns of their own (force_n_x
        would be force_n[0]); of lists the number of entries.

        Raises:
            ImportError: pandas is not installed.
        """
        import pandas

        table: dict[str, Any] = {}
        for name, column in self._columns.items():
            if isinstance(column, Ragged):
                table[f"{name}.count"] = column.counts
            elif isinstance(column, list) or column.ndim == 1:
                table[name] = column
            else:
                for part in np.ndindex(column.shape[1:]):
                    table[f"{name}[{','.join(map(str, part))}]"] = column[(slice(None), *part)]
        return pandas.DataFrame(table, index=pandas.Index(self.time, name="time_s"))

    def __getitem__(self, field: str) -> Any:
        if field not in self._columns and self._length == 0:
            raise KeyError(f"{field}: no message of {self._name} was heard")
        return self._columns[field]

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)

    def __repr__(self) -> str:
        lines = [f"<palpate {self._name}: {self._length} messages"]
        if self._length:
            lines[0] += f", {self.time.min():.3f} to {self.time.max():.3f} s"
        lines += [f"  {name}: {_short(column)}" for name, column in self._columns.items()]
        return "\n".join(lines) + ">"


class Topics(Mapping[str, Topic]):
    """Topics by their names."""

    def __init__(self, topics: Mapping[str, Topic]) -> None:
        self._topics = dict(topics)

    def __getitem__(self, name: str) -> Topic:
        if name not in self._topics:
            raise KeyError(f"no topic {name!r} here; there are: {', '.join(self._topics) or 'none'}")
        return self._topics[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._topics)

    def __len__(self) -> int:
        return len(self._topics)

    def _summary(self) -> str:
        return "".join(f"\n  {name}: {topic.messages} messages" for name, topic in self._topics.items())

    def __repr__(self) -> str:
        return f"<palpate.Topics{self._summary()}>"


def topic_from(name: str, columns: list[tuple[str, Any]], length: int) -> Topic:
    """A Topic from what the extension module gives."""
    return Topic(name, {field: Ragged(*c) if isinstance(c, tuple) else c for field, c in columns}, length)


def _chosen(column: Any, wanted: npt.NDArray[np.bool_]) -> Any:
    if isinstance(column, list):
        return [value for value, is_wanted in zip(column, wanted) if is_wanted]
    if not isinstance(column, Ragged):
        return column[wanted]
    parts = [column[int(i)] for i in np.flatnonzero(wanted)]
    offsets = np.concatenate([[0], np.cumsum(column.counts[wanted])]).astype(np.int64)
    if isinstance(column.values, list):
        return Ragged([value for part in parts for value in part], offsets)
    return Ragged(np.concatenate(parts) if parts else column.values[:0], offsets)


def _short(value: Any) -> str:
    if isinstance(value, np.ndarray) and value.size > 9:
        return f"array {value.shape} {value.dtype}"
    if isinstance(value, np.ndarray):
        return np.array2string(value, precision=4, separator=", ").replace("\n", "")
    text = repr(value)
    return text if len(text) <= 60 else f"{type(value).__name__} of {len(value)}"
