"""CSV files as rows of numbers and words."""

import csv
import math


def number(text):
    """NaN where a cell is empty or not a number."""
    try:
        return float(text)
    except ValueError:
        return math.nan


def rows_of(file, words=None):
    """Rows by column name; none where there is no file. All columns but `words` are numbers; all are words if None."""
    if not file.exists():
        return []
    with open(file, newline="", encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    if words is None:
        return rows
    return [{key: value if key in words else number(value) for key, value in row.items()} for row in rows]
