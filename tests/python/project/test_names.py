"""The files, folders and names that documents and comments speak of exist.

Files are meant by their path from the root, or by any end of it. A name in back-quotes must be a word of the code: in
comments every one, in documents those that can be nothing else, as `Class::member`, `function()` or `kConstant`.
"""

import ast
import io
import re
import subprocess
import tokenize
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]
FILE = re.compile(r"(?<![\w/.*<{~-])((?:[\w.-]+/)*[\w-]+\.(?:h|cpp|inl|py|md|sh|cmake))\b(?![\w/*])")
OF_PYBULLET = ("docs/pybullet_", "benchmarks/bullet/", "tests/python/pybullet/")  # name scripts of PyBullet's wheel
TOP = "manyhands|bindings|python|tests|tools|docs|benchmarks|examples|cmake"
FOLDER = re.compile(rf"(?<![\w/.*<{{~-])((?:{TOP})(?:/\w+)+)/?(?![\w.*])")
NAME = re.compile(r"`([A-Za-z_]\w*(?:(?:::|\.)[A-Za-z_]\w*)*)(\([^`\n]*\))?`")
CLEAR = re.compile(r".*(::|\.|\()|k[A-Z]\w+|[A-Z][a-z]+[A-Z]\w*$")
FILTER = re.compile(r"--gtest_filter='?(\w+)")
COMMENT = re.compile(r'//[^\n]*|/\*.*?\*/|R"\(.*?\)"|"(?:\\.|[^"\\\n])*"', re.DOTALL)
FENCED = re.compile(r"^```.*?^```", re.DOTALL | re.MULTILINE)


def words(text: str) -> set[str]:
    return set(re.findall(r"[A-Za-z_]\w*", text))


def blank(match: re.Match[str]) -> str:
    return "\n" * match[0].count("\n")


def split_cpp(text: str) -> tuple[str, list[tuple[int, str]]]:
    """The code without comments, and the comments by their lines."""
    comments = [(text[: m.start()].count("\n") + 1, m[0]) for m in COMMENT.finditer(text) if m[0].startswith("/")]
    return COMMENT.sub(lambda m: blank(m) if m[0].startswith("/") else m[0], text), comments


def split_python(text: str) -> tuple[str, list[tuple[int, str]]]:
    """The code without comments and docstrings, and these by their lines."""
    statements = (node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Expr))
    docstrings = {node.lineno for node in statements if isinstance(node.value, ast.Constant)}
    code: list[str] = []
    prose: list[tuple[int, str]] = []
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        is_docstring = token.type == tokenize.STRING and token.start[0] in docstrings
        if token.type == tokenize.COMMENT or is_docstring:
            prose.append((token.start[0], token.string))
        else:
            code.append(token.string)
    return " ".join(code), prose


@cache
def tree() -> tuple[set[str], set[str], list[tuple[str, int, str]]]:
    """Ends of all paths, words of all code, and all prose by file and line."""
    listed = subprocess.run(
        ["git", "ls-files", "-co", "--exclude-standard"], cwd=ROOT, capture_output=True, text=True, check=True
    ).stdout.split()
    files = [name for name in listed if (ROOT / name).is_file()]
    paths = {parent for name in files for parent in (name, *map(str, Path(name).parents))}
    ends = {"/".join(path.split("/")[k:]) for path in paths for k in range(path.count("/") + 1)}
    known = words(" ".join(ends))
    prose: list[tuple[str, int, str]] = []
    for name in files:
        split = {".h": split_cpp, ".cpp": split_cpp, ".inl": split_cpp, ".py": split_python}.get(Path(name).suffix)
        if name.endswith(".md"):
            prose.append((name, 1, (ROOT / name).read_text()))
        elif split is not None and name != Path(__file__).relative_to(ROOT).as_posix():
            code, comments = split((ROOT / name).read_text())
            known |= words(code)
            prose += [(name, *comment) for comment in comments]
        elif name.endswith((".cmake", ".txt", ".sh", ".toml", ".urdf", "Makefile")):
            known |= words((ROOT / name).read_text())
    return ends, known, prose


def missing(text: str, is_document: bool) -> Iterator[tuple[int, str]]:
    """What a piece of prose names that is not there, and after how many lines."""
    ends, known, _ = tree()
    for pattern in (FILE, FOLDER):
        for match in pattern.finditer(text):
            if re.sub(r"^(\.\.?/)+", "", match[1]) not in ends:
                yield text[: match.start()].count("\n"), match[1]
    for match in FILTER.finditer(text):
        if not any(word.startswith(match[1]) for word in known):
            yield text[: match.start()].count("\n"), match[1]
    for match in NAME.finditer(FENCED.sub(blank, text)):
        is_name = not is_document or CLEAR.match(match[1] + (match[2] or ""))
        if is_name and not words(match[1]) <= known:
            yield text[: match.start()].count("\n"), match[1]


@pytest.mark.parametrize(
    "text",
    [
        "see motors.h",
        "(batch_params.cpp)",
        "`tests/math/test_lane.cpp`",
        "in tests/phisics",
        "--gtest_filter='Rnea*'",
        "`World::fly_away`",
        "`World.fly_away`",
        "`fly_away(world)`",
        "`kNowhereAtAll`",
        "`WorldOfMine`",
    ],
)
def test_what_is_not_there_is_found(text: str) -> None:
    assert [name for _, name in missing(f"One line.\n{text}", is_document=True)], text


def test_what_is_there_is_passed_over() -> None:
    text = "`World::apply_force`, number.h, math/number.h, tests/physics, `kPi`, `World.from_file(path)`, `fly_away`"
    assert list(missing(text, is_document=True)) == []
    assert [name for _, name in missing(text, is_document=False)] == ["fly_away"]


def test_all_that_is_named_exists() -> None:
    found = [
        (f"{file}:{line + offset}", name)
        for file, line, text in tree()[2]
        for offset, name in missing(text, file.endswith(".md"))
        if not (file.startswith(OF_PYBULLET) and name.endswith((".py", ".urdf")))
    ]
    assert found == []
