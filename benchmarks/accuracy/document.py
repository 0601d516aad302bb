"""Writes the tables of a run into docs/accuracy.md, between its markers."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from benchmarks.accuracy.case import Case
from benchmarks.accuracy.rows import Row
from benchmarks.accuracy.table import HEADINGS, PUBLISHED_HEADINGS, markdown, published, summary

BEGIN, END = "<!-- tables: begin -->", "<!-- tables: end -->"


def write_document(path: Path, cases: Sequence[Case], rows: Sequence[Row], about: dict[str, Any]) -> None:
    """Replaces what is between the markers. Raises ValueError where they are missing."""
    text = path.read_text()
    if text.count(BEGIN) != 1 or text.count(END) != 1:
        raise ValueError(f"{path} must hold one line {BEGIN} and one line {END}")
    head, rest = text.split(BEGIN)
    tail = rest.split(END)[1]
    machine = f"{about['cpu']}, {about['cores']} cores, {about['compiler']}; {about['date'][:10]}."
    tables = [machine, markdown(HEADINGS, summary(cases, rows)), markdown(PUBLISHED_HEADINGS, published(cases, rows))]
    path.write_text("\n\n".join([head + BEGIN, *tables, END + tail]))
