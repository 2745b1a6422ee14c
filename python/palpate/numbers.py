"""Whole numbers as they are given."""

from __future__ import annotations

import operator
from typing import Any

_MOST = 2**63 - 1


def whole(name: str, value: Any, least: int = -_MOST) -> int:
    """As an int; what is larger than any count becomes the largest, which is refused with the reason.

    Raises:
        TypeError: no whole number. ValueError: less than `least`.
    """
    try:
        number = operator.index(value)
    except TypeError:
        raise TypeError(f"{name} must be a whole number, not {value!r}") from None
    if number < least:
        raise ValueError(f"{name} must be at least {least}, not {number}")
    return min(number, _MOST)
