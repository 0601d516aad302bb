"""The pages of the site, gathered from where they lie: documents, READMEs of folders, sources that pages link to."""

import os
import re
import shutil
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
LINK = re.compile(r"(\]\()([^)\s#:]+)(#[^)\s]*)?(\))")
TOP = {"CONTRIBUTING.md": "contributing", "CONVENTIONS.md": "conventions", "CHANGELOG.md": "changelog",
       "SECURITY.md": "security", "README.md": "index"}  # fmt: skip
LANGUAGES = {".py": "python", ".cpp": "cpp", ".h": "cpp", ".txt": "cmake", ".cmake": "cmake", ".sh": "sh"}


class Pages:
    """Which file of the tree is which page, without ending, and the files themselves."""

    def __init__(self) -> None:
        self.of_file = {ROOT / file: page for file, page in TOP.items()}
        self.of_file |= {file: file.stem for file in sorted((ROOT / "docs").glob("*.md"))}
        for file in sorted(ROOT.glob("manyhands/**/README.md")):
            self.of_file[file] = "inside/" + "_".join(file.relative_to(ROOT / "manyhands").parent.parts)
        for name in ("assets", "examples/rl_zoo", "packages/manyhands-pybullet", "python/manyhands/compat/stand_ins"):
            self.of_file[ROOT / name / "README.md"] = "inside/" + Path(name).name
        for file in [*sorted(ROOT.glob("examples/**/*.py")), *sorted(ROOT.glob("examples/**/*.cpp"))]:
            self.add_source(file)

    def add_source(self, file: Path) -> str:
        """The page that shows a source file."""
        return self.of_file.setdefault(file, "sources/" + "_".join(file.relative_to(ROOT).parts).replace(".", "_"))

    def link(self, page: str, file: Path) -> str:
        """Where a page's link to a file or folder leads; empty where the site has no page for it."""
        if file.is_dir():
            file = file / "README.md"
        if file not in self.of_file and file.suffix in LANGUAGES and file.is_file():
            self.add_source(file)
        if file not in self.of_file:
            return ""
        return os.path.relpath(self.of_file[file] + ".md", Path(page).parent)

    def with_links(self, page: str, file: Path) -> str:
        """A document's text, with the links of the site."""

        def replaced(match: re.Match[str]) -> str:
            target = (file.parent / match[2]).resolve()
            if target.is_relative_to(ROOT / "docs/images"):
                image = os.path.relpath(target.relative_to(ROOT / "docs"), Path(page).parent)
                return f"{match[1]}{image}{match[4]}"
            if not target.exists():
                return match[0]  # a page of the site alone
            found = self.link(page, target)
            return f"{match[1]}{found}{match[3] or ''}{match[4]}" if found else f"{match[1]}{page_link(page)}{match[4]}"

        return LINK.sub(replaced, file.read_text())


def page_link(page: str) -> str:
    """A link to the page itself, for what has no page."""
    return Path(page).name + ".md"


def source_page(file: Path) -> str:
    """A page that shows a source file."""
    name = file.relative_to(ROOT).as_posix()
    language = LANGUAGES[file.suffix]
    return f"---\norphan: true\n---\n\n# {name}\n\n`````{language}\n{file.read_text().rstrip()}\n`````\n"


def gather(out: Path) -> None:
    """Writes all pages that lie in the tree into `out`."""
    shutil.copytree(ROOT / "docs/site", out, dirs_exist_ok=True)
    shutil.copytree(ROOT / "docs/images", out / "images", dirs_exist_ok=True)
    shutil.copytree(ROOT / "docs/tutorials", out / "tutorials", dirs_exist_ok=True)
    pages = Pages()
    for file in sorted((ROOT / "docs/site").rglob("*.md")):
        page = file.relative_to(ROOT / "docs/site").with_suffix("").as_posix()
        (out / f"{page}.md").write_text(pages.with_links(page, file))
    written: set[Path] = set()
    while rest := [file for file in pages.of_file if file not in written]:
        for file in rest:
            written.add(file)
            page = pages.of_file[file]
            if page == "index":
                continue
            path = out / f"{page}.md"
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(pages.with_links(page, file) if file.suffix == ".md" else source_page(file))
