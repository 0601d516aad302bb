"""The command `manyhands compare`."""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.console import Console

    from manyhands.training.comparison import Band, Group

EXAMPLES = """\
examples:
  manyhands compare runs/PandaPush-v3-*                     curves of all runs of Push
  manyhands compare sweeps/PandaPush-v3 --out push          push.png and push.html, of a folder of runs
  manyhands compare runs/A runs/B runs/C --band range       from the worst to the best instead of 95 % intervals

Runs whose settings differ in the seed alone become one curve, the mean, with a band.
"""
_NO_TERMINAL = 1000  # columns: lines of a file or a pipe are as long as they need to be
_WIDE = 80  # columns of a terminal, from which on there is room for intervals


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What comes after `manyhands compare`."""
    parser.add_argument("runs", nargs="+", type=Path, metavar="RUN_DIR", help="run folders, or folders of them")
    parser.add_argument(
        "--out", type=Path, default=Path("comparison"), metavar="NAME",
        help="where NAME.png and NAME.html go (comparison)",
    )  # fmt: skip
    parser.add_argument(
        "--band", choices=("bootstrap", "range"), default="bootstrap",
        help="95 %% bootstrap interval of the mean over runs (default), or least and greatest",
    )  # fmt: skip


def run(arguments: argparse.Namespace) -> int:
    """Draws curves and prints a table."""
    from rich.console import Console

    from manyhands.training.comparison import read_groups

    console = Console()
    groups, left_out = read_groups(arguments.runs)
    for line in left_out:
        console.print(line, highlight=False, markup=False, soft_wrap=True)
    show(console, groups, arguments.band, arguments.out)
    return 0


def show(console: "Console", groups: "list[Group]", band: "Band", out: Path) -> None:
    """Prints the groups as a table, and writes out.png and out.html. Raises OSError where they cannot be written."""
    from rich import box
    from rich.table import Table

    from manyhands.extras import needs
    from manyhands.training.comparison_picture import draw_page, draw_png
    from manyhands.training.comparison_table import header, notes, table_row

    name = out.stem if out.suffix in (".png", ".html") else out.name
    picture, page = (out.with_name(f"{name}.{ending}") for ending in ("png", "html"))
    draw_png(groups, band, picture)
    with needs("train", "the page"):
        draw_page(groups, band, page)
    title = f"{groups[0].runs[0].env_id}: success at the end"
    if not console.is_terminal:
        console.width = _NO_TERMINAL
    shown = [number for number, name in enumerate(header(band)) if name != "95 %" or console.width >= _WIDE]
    table = Table(
        title=title, title_justify="left", caption=notes(groups, band), caption_justify="left", box=box.SIMPLE,
        show_edge=False, collapse_padding=True,
    )  # fmt: skip
    for number in shown:
        justify = "right" if number else "left"
        table.add_column(header(band)[number], justify=justify, overflow="fold", no_wrap=number > 0)
    for group in groups:
        table.add_row(*(table_row(group, band)[number] for number in shown))
    console.print(table)
    for path, what in ((picture, "the curves"), (page, "the same, to zoom in")):
        console.print(f"  {path}  {what}", highlight=False, markup=False, soft_wrap=True)
