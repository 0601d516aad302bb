"""Runs the C++ benchmarks, which print rows as lines of JSON."""

import json
import subprocess
from pathlib import Path

from benchmarks.rows import Row

PROGRAMS = ("threads", "dynamics", "reach_stages", "contact_stages", "pictures")


def run_programs(folder: Path, quick: bool) -> list[Row]:
    """The rows of all programs in `folder`; one that is not there gives a row that says so."""
    rows: list[Row] = []
    for name in PROGRAMS:
        program = folder / name
        if not program.is_file():
            note = f"not built: {program}; run `make bench`"
            rows.append(Row(name, "manyhands", "", 1, None, "", note=note))
            continue
        command = [str(program), *(["--quick"] if quick else [])]
        finished = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=False)
        rows += [read_row(line) for line in finished.stdout.splitlines()]
        if finished.returncode != 0:
            failed = Row(name, "manyhands", "", 1, None, "")
            failed.refuse(f"{program} ended with status {finished.returncode}")
            rows.append(failed)
    return rows


def read_row(line: str) -> Row:
    """A row from a line of a program's output."""
    fields = json.loads(line)
    row = Row(
        benchmark=fields["benchmark"],
        engine=fields["engine"],
        number_type=fields["number_type"],
        threads=fields["threads"],
        value=fields["value"],
        unit=fields["unit"],
        variation=fields["variation"],
        note=fields.get("note", ""),
    )
    if fields["wrong"]:
        row.refuse(fields["wrong"])
    return row
