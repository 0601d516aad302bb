"""What a C++ header declares for others, with its comments: parsed by tree-sitter, without a compiler."""

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import tree_sitter_cpp
from tree_sitter import Language, Node, Parser

PARSER = Parser(Language(tree_sitter_cpp.language()))
CLASSES = {"class_specifier": "class", "struct_specifier": "struct", "union_specifier": "union"}
FUNCTIONS = ("function_declarator", "operator_cast")
# Inner workings, which only headers of this project include.
HIDDEN = re.compile(r"(^|_)(detail|internal)(_|$)")
RULER = re.compile(r"^-{3,}")


@dataclass
class Symbol:
    """One declaration. `comment` is Markdown; empty where the header says nothing."""

    kind: str  # class, struct, union, enum, function, variable, type, concept, enumerator
    name: str
    signature: str
    comment: str
    line: int
    members: list["Symbol"] = field(default_factory=list)
    shared: bool = False  # the comment is that of a group, of which this is not the first


@dataclass
class Header:
    """A header: what its first comment says, and what it declares."""

    summary: str
    symbols: list[Symbol]


def read_header(path: Path) -> Header:
    """Parses a header. What lies in unnamed or inner namespaces, and what is not public, is left out."""
    source = path.read_bytes()
    root = PARSER.parse(source).root_node
    first = next((node for node in root.children if node.type == "comment"), None)
    summary = []
    node = first
    while node is not None and node.type == "comment":
        summary.append(comment_text(node))
        node = node.next_sibling
    return Header(" ".join(summary).strip(), list(declared(root)))


def text(node: Node) -> str:
    """The source of a node."""
    return (node.text or b"").decode()


def comment_text(node: Node) -> str:
    """A comment's words; a ruler such as `// ---- state ----` has none."""
    words = re.sub(r"^//[/!]?<?\s?", "", text(node)).rstrip()
    return "" if RULER.match(words.strip()) else words


def comment_of(node: Node) -> tuple[str, bool]:
    """What is said of a declaration, above it or behind it; and whether it is said above of a whole group."""
    behind: list[str] = []
    after = node.next_sibling
    while after is not None and after.type == ";":
        after = after.next_sibling
    row = node.end_point.row
    while after is not None and after.type == "comment" and after.start_point.row == row:
        behind.append(comment_text(after))
        row = after.end_point.row + 1
        after = after.next_sibling
        if after is not None and not text(after).startswith("///<"):
            break
    above: list[str] = []
    before = node.prev_sibling
    row = node.start_point.row
    while before is not None and before.type == "comment" and before.end_point.row == row - 1 and is_alone(before):
        above.insert(0, comment_text(before))
        row = before.start_point.row
        before = before.prev_sibling
    said = "\n".join([*above, *behind]).strip() or opening_comment(node)
    return (said, False) if said else (group_comment(node), True)


def opening_comment(node: Node) -> str:
    """What is said behind the brace that opens a body."""
    inner = [node, *node.children, *(grandchild for child in node.children for grandchild in child.children)]
    bodies = (body for body in (part.child_by_field_name("body") for part in inner) if body is not None)
    body = next(bodies, None)
    if body is None or len(body.children) < 2 or body.children[1].type != "comment":
        return ""
    is_beside = body.children[1].start_point.row == body.start_point.row
    return comment_text(body.children[1]) if is_beside else ""


def is_alone(comment: Node) -> bool:
    """Whether no code stands before a comment on its line."""
    before = comment.prev_sibling
    return before is None or before.end_point.row < comment.start_point.row or before.type == "access_specifier"


def group_comment(node: Node) -> str:
    """The comment of the declaration right above, on the line before: one comment speaks for a group."""
    before = node.prev_sibling
    while before is not None and (before.type == ";" or (before.type == "comment" and not is_alone(before))):
        before = before.prev_sibling
    if before is None or before.type in ("comment", "access_specifier", "preproc_include", "{", ":"):
        return ""
    if node.start_point.row - before.end_point.row > 1:
        return ""
    return comment_of(before)[0]


def declared(parent: Node, public: bool = True) -> Iterator[Symbol]:
    """The symbols that a scope declares."""
    for node in parent.children:
        if node.type == "access_specifier":
            public = text(node) == "public"
        elif node.type.startswith("preproc_if") or node.type in ("preproc_else", "linkage_specification"):
            yield from declared(node, public)
        elif node.type == "namespace_definition":
            name, body = node.child_by_field_name("name"), node.child_by_field_name("body")
            if name is not None and body is not None and not HIDDEN.search(text(name)):
                yield from declared(body)
        elif public:
            yield from symbols_of(node, node)


def symbols_of(node: Node, whole: Node) -> Iterator[Symbol]:
    """The symbol of one declaration; `whole` has its template line."""
    if node.type == "template_declaration":
        for child in node.children:
            yield from symbols_of(child, whole)
        return
    specifier = node.child_by_field_name("type") if node.type in ("declaration", "field_declaration") else node
    declarator = node.child_by_field_name("declarator")
    if specifier is not None and specifier.type in (*CLASSES, "enum_specifier") and declarator is None:
        if specifier.child_by_field_name("body") is not None:
            yield class_symbol(specifier, whole)
    elif re.match(r"(extern )?template\b(?! <\w)", text(whole)):
        return  # what is said of the template holds for its instances
    elif node.type in ("declaration", "field_declaration", "function_definition"):
        if function := function_declarator(node):
            yield make(whole, "function", function_name(function), before_body(whole, node))
        elif declarator is not None:
            name = text(declarator).split("=")[0].split("{")[0].split("[")[0].strip("*& ")
            yield make(whole, "variable", name, one_line(text(whole)).rstrip(";"))
    elif node.type in ("alias_declaration", "concept_definition"):
        kind = "type" if node.type == "alias_declaration" else "concept"
        yield make(whole, kind, text(name_of(node)), one_line(text(whole)).rstrip(";"))


def class_symbol(node: Node, whole: Node) -> Symbol:
    """A class with its public members, or an enumeration with its values."""
    body = node.child_by_field_name("body")
    assert body is not None
    name = node.child_by_field_name("name")
    signature = one_line(source_between(whole, body.start_byte))
    if node.type == "enum_specifier":
        symbol = make(whole, "enum", text(name) if name else "", signature)
        for value in body.children:
            if value.type == "enumerator":
                comment = enumerator_comment(value)
                symbol.members.append(
                    Symbol("enumerator", text(name_of(value)), text(value), comment, value.start_point.row + 1)
                )
        return symbol
    symbol = make(whole, CLASSES[node.type], text(name) if name else "", signature)
    symbol.members = list(declared(body, public=node.type != "class_specifier"))
    return symbol


def enumerator_comment(node: Node) -> str:
    """What is said behind a value, beyond its comma, or above it."""
    after = node.next_sibling
    if after is not None and after.type == ",":
        after = after.next_sibling
    if after is not None and after.type == "comment" and after.start_point.row == node.end_point.row:
        return comment_text(after)
    before = node.prev_sibling
    is_above = before is not None and before.type == "comment" and before.end_point.row == node.start_point.row - 1
    return comment_text(before) if before is not None and is_above else ""


def make(whole: Node, kind: str, name: str, signature: str) -> Symbol:
    """A symbol with what is said of it."""
    comment, shared = comment_of(whole)
    return Symbol(kind, name, signature, comment, whole.start_point.row + 1, shared=shared and bool(comment))


def name_of(node: Node) -> Node:
    """The node of a declaration's name."""
    return node.child_by_field_name("name") or node


def function_declarator(node: Node) -> Node | None:
    """The part `name(arguments)` of a declaration, if it declares a function."""
    found = node.child_by_field_name("declarator")
    while found is not None and found.type not in FUNCTIONS:
        inner = found.child_by_field_name("declarator")
        if inner is None and found.type == "reference_declarator":
            inner = next((child for child in found.children if child.is_named), None)
        found = inner
    return found


def function_name(declarator: Node) -> str:
    """A function's name, `operator+` and `~World` among them."""
    name = declarator.child_by_field_name("declarator")
    if name is None or declarator.type == "operator_cast":
        return one_line(text(declarator).split("(")[0])
    words = one_line(text(name))
    # After a macro the type is taken for a part of the name.
    return words if words.startswith("operator") else re.sub(r"^.*[>&*] |^\w+ ", "", words)


def before_body(whole: Node, node: Node) -> str:
    """A function's declaration without its body and initialisers."""
    end = whole.end_byte
    for child in node.children:
        if child.type in ("compound_statement", "field_initializer_list", "try_statement"):
            end = min(end, child.start_byte)
    return one_line(source_between(whole, end)).rstrip("; ")


def source_between(node: Node, end_byte: int) -> str:
    """The source of a node up to a byte, without comments in it."""
    return (node.text or b"")[: end_byte - node.start_byte].decode()


def one_line(source: str) -> str:
    """Source without comments and line breaks."""
    line = re.sub(r"\s+", " ", re.sub(r"(?m)//[^\n]*|^#.*$", "", source)).strip()
    # A class whose body macros write is taken for a function.
    unread = re.match(r"((?:template <.*?> )?(?:class|struct) \w+[^{(]*?) \{", line)
    return unread[1] if unread else line
