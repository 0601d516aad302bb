"""Builds the site: `python -m tools.site [--out FOLDER] [--external]`.

Gathers the pages, draws the charts, writes the C++ reference, runs Sphinx with warnings as errors, and looks whether
every link leads somewhere.
"""

import argparse
import shutil
import subprocess
import sys
from pathlib import Path

from tools.site.charts import write_charts
from tools.site.cpp_reference import write_cpp_reference
from tools.site.links import broken_links
from tools.site.pages import ROOT, gather


def main() -> int:
    """Returns the exit status."""
    parser = argparse.ArgumentParser("python -m tools.site", description=__doc__)
    parser.add_argument("--out", type=Path, default=ROOT / "build/docs", help="default: %(default)s")
    parser.add_argument("--external", action="store_true", help="ask for the pages of others, too, that ours point to")
    options = parser.parse_args()
    pages, html = options.out / "pages", options.out / "html"
    for folder in (pages, html):
        shutil.rmtree(folder, ignore_errors=True)
    gather(pages)
    write_charts(ROOT, pages)
    write_cpp_reference(ROOT, pages / "reference/cpp")
    sphinx = [sys.executable, "-m", "sphinx", "--fail-on-warning", "--keep-going", "--quiet", "--color"]
    builders = {"html": html, "linkcheck": options.out / "linkcheck"} if options.external else {"html": html}
    for builder, out in builders.items():
        cached = options.out / "doctrees"
        if status := subprocess.run([*sphinx, "-b", builder, "-d", str(cached), str(pages), str(out)]).returncode:
            return status
    if broken := broken_links(html):
        print("These links lead nowhere:", *broken, sep="\n  ")
        return 1
    print(f"{len(list(html.rglob('*.html')))} pages; every link leads somewhere. Open {html / 'index.html'}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
