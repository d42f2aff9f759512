"""Writes the reference of the Python package as pages in Markdown: signatures and docstrings, read from the sources.

Usage: python3 site/python_api.py OUT, at the top of the repository. Nothing is imported, so that neither the extension module nor any
package is needed. A page has the name of its module; the generator of the site shows it in the place of the source.
"""

from __future__ import annotations

import ast
import inspect
import re
import sys
from pathlib import Path

PACKAGE = Path("python/papilio")

#: Sections of a docstring, and how they are shown.
SECTIONS = {"Args": "Arguments", "Returns": "Returns", "Raises": "Raises", "Warns": "Warns", "Yields": "Yields", "Example": "Example"}

#: Longest signature in one line.
WIDTH = 88


def is_module(name: str) -> bool:
    """True if the package has a module of this name, written in Python."""
    return (PACKAGE / f"{name}.py").is_file()


class Module:
    """A source file: its top-level names."""

    def __init__(self, name: str) -> None:
        self.tree = ast.parse((PACKAGE / f"{name}.py").read_text(encoding="utf-8"))
        self.doc = ast.get_docstring(self.tree) or ""
        self.nodes: dict[str, ast.AST] = {}
        #: Names that another module of the package defines: module and name there.
        self.imported: dict[str, tuple[str, str]] = {}
        #: Lines of comments that begin with "#:", which describe constants.
        self.lines = (PACKAGE / f"{name}.py").read_text(encoding="utf-8").splitlines()
        for node in self.tree.body:
            if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
                if isinstance(node, ast.ClassDef) or not _is_marked(node, "overload"):
                    self.nodes[node.name] = node
            elif isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name):
                self.nodes[node.targets[0].id] = node
            elif isinstance(node, ast.ImportFrom) and node.level == 1:
                for one in node.names:
                    self.imported[one.asname or one.name] = (node.module or one.name, one.name)

    def exported(self) -> list[str]:
        """Returns the names of ``__all__``."""
        node = self.nodes.get("__all__")
        return list(ast.literal_eval(node.value)) if isinstance(node, ast.Assign) else []


class Package:
    """The package, with its modules read as they are needed."""

    def __init__(self) -> None:
        self.modules: dict[str, Module] = {}

    def module(self, name: str) -> Module:
        if name not in self.modules:
            self.modules[name] = Module(name)
        return self.modules[name]

    def find(self, module: str, name: str) -> tuple[str, ast.AST] | None:
        """Returns the module that defines a name, and the definition; None for a module, or a name of the extension module."""
        here = self.module(module)
        if name in here.nodes:
            return module, here.nodes[name]
        origin, there = here.imported.get(name, ("", ""))
        if not is_module(origin) or (origin == there and there not in self.module(origin).nodes):
            return None
        return self.find(origin, there)

    def inherited(self, module: str, node: ast.ClassDef) -> list[str]:
        """Returns the names of public methods that a class has from its bases in the package."""
        here = self.module(module)
        names: list[str] = []
        for base in map(_name, node.bases):
            found = self.find(module, base) if base in here.nodes or base in here.imported else None
            if found and isinstance(found[1], ast.ClassDef):
                names += [*members(found[1]), *self.inherited(*found)]
        own = members(node)
        return [name for name in dict.fromkeys(names) if name not in own and not name.startswith("_")]


def members(node: ast.ClassDef) -> dict[str, ast.FunctionDef]:
    """Returns the methods and properties of a class."""
    methods = [one for one in node.body if isinstance(one, ast.FunctionDef)]
    return {one.name: one for one in methods if not _is_marked(one, "overload", "setter")}


def _is_marked(node: ast.FunctionDef, *marks: str) -> bool:
    """True if a decorator's name ends with one of these."""
    return any(_name(one).endswith(marks) for one in node.decorator_list)


def _name(node: ast.AST) -> str:
    """Returns the name at the start of an expression: that of a decorator or a base."""
    if isinstance(node, (ast.Subscript, ast.Call)):
        return _name(node.value if isinstance(node, ast.Subscript) else node.func)
    return ast.unparse(node)


def signature(name: str, node: ast.FunctionDef, is_method: bool) -> str:
    """Returns the signature of a function as a code block, one argument per line if it is long."""
    arguments = node.args
    if is_method and not _is_marked(node, "staticmethod"):
        (arguments.posonlyargs or arguments.args)[:1] = []
    result = f" -> {ast.unparse(node.returns)}" if node.returns and name != "__init__" else ""
    line = f"{name}({ast.unparse(arguments)}){result}"
    if len(line) <= WIDTH:
        return line
    each = _each(arguments)
    return f"{name}(\n" + "".join(f"    {one},\n" for one in each) + f"){result}"


def _each(arguments: ast.arguments) -> list[str]:
    """Returns each argument as text."""
    every = [*arguments.posonlyargs, *arguments.args]
    defaults = [None] * (len(every) - len(arguments.defaults)) + list(arguments.defaults)
    texts = [_argument(one, default) for one, default in zip(every, defaults, strict=True)]
    if arguments.posonlyargs:
        texts.insert(len(arguments.posonlyargs), "/")
    if arguments.vararg:
        texts.append("*" + _argument(arguments.vararg, None))
    elif arguments.kwonlyargs:
        texts.append("*")
    texts += [_argument(one, default) for one, default in zip(arguments.kwonlyargs, arguments.kw_defaults, strict=True)]
    return texts + (["**" + _argument(arguments.kwarg, None)] if arguments.kwarg else [])


def _argument(one: ast.arg, default: ast.expr | None) -> str:
    kind = f": {ast.unparse(one.annotation)}" if one.annotation else ""
    value = "" if default is None else f" = {ast.unparse(default)}" if kind else f"={ast.unparse(default)}"
    return one.arg + kind + value


def markdown(doc: str) -> str:
    """Returns a docstring as Markdown: sections as lists, examples as code."""
    blocks: list[str] = []
    lines = inspect.cleandoc(doc).splitlines()
    at = 0
    while at < len(lines):
        line = lines[at]
        if line.rstrip(":") in SECTIONS and line.endswith(":"):
            body, at = _indented(lines, at + 1)
            blocks.append(f"**{SECTIONS[line.rstrip(':')]}**")
            blocks.append(_items(body) if line in ("Args:", "Raises:", "Warns:") else markdown("\n".join(body)))
        elif line.startswith(">>>"):
            end = next((number for number in range(at, len(lines)) if not lines[number].strip()), len(lines))
            blocks.append(_code("\n".join(lines[at:end])))
            at = end
        elif line.startswith("- "):
            end = next((n for n in range(at, len(lines)) if not lines[n].startswith(("- ", "  "))), len(lines))
            blocks.append("\n".join(_prose(one) for one in lines[at:end]))
            at = end
        elif line.strip():
            end = at
            while end < len(lines) and lines[end].strip() and not lines[end].startswith((">>>", "- ")):
                end += 1
            text = "\n".join(lines[at:end])
            at = end
            if text.endswith("::"):
                code, at = _indented(lines, at)
                blocks += [_prose(text[:-1]), _code("\n".join(code).strip("\n"))]
            else:
                blocks.append(_prose(text))
        else:
            at += 1
    return "\n\n".join(block for block in blocks if block)


def _indented(lines: list[str], at: int) -> tuple[list[str], int]:
    """Returns the indented or empty lines from here, without their indentation, and the number of the line after them."""
    end = at
    while end < len(lines) and (not lines[end].strip() or lines[end].startswith(" ")):
        end += 1
    return inspect.cleandoc("\n" + "\n".join(lines[at:end])).splitlines(), end


def _items(lines: list[str]) -> str:
    """Returns arguments or errors as a list: "name: what it is", with indented lines after it."""
    items: list[str] = []
    for line in lines:
        if line.startswith(" ") and items:
            items[-1] += " " + line.strip()
        elif line.strip():
            items.append(line.strip())
    shown = []
    for item in items:
        name, colon, text = item.partition(": ")
        shown.append(f"- `{name}`: {_prose(text)}" if colon else f"- {_prose(item)}")
    return "\n".join(shown)


def _code(text: str) -> str:
    return f"```python\n{text}\n```"


def _prose(text: str) -> str:
    """Returns a text with its code in single backquotes, and everything else free of markup."""
    pieces = re.split(r"(``.+?``|`.+?`)", text, flags=re.DOTALL)
    return "".join(
        f"`{piece.strip('`')}`" if number % 2 else re.sub(r"([\\*_<\[\]|$])", r"\\\1", piece)
        for number, piece in enumerate(pieces)
    )


def _title(name: str) -> str:
    return f"`{name}`"


def function(name: str, node: ast.FunctionDef, level: int, is_method: bool = False) -> list[str]:
    """Returns the blocks of a function or method."""
    return [f"{'#' * level} {_title(name)}", _code(signature(name, node, is_method)), markdown(ast.get_docstring(node) or "")]


def klass(package: Package, module: str, name: str, node: ast.ClassDef) -> list[str]:
    """Returns the blocks of a class: how to make one, its attributes, its methods."""
    own = members(node)
    blocks = [f"### {_title(name)}"]
    init = own.get("__init__")
    # Objects of the other classes are made by functions.
    about = (ast.get_docstring(init) or "") if init else ""
    if init and re.search(rf"Args:|papilio\.{name}\(", about + (ast.get_docstring(node) or "")):
        blocks.append(_code("class " + signature(name, init, is_method=True)))
    blocks += [markdown(ast.get_docstring(node) or ""), markdown(about)]
    public = {one: method for one, method in own.items() if not one.startswith("_")}
    rows = _fields(package.module(module), node)
    for one, method in public.items():
        if _is_marked(method, "property"):
            kind = ast.unparse(method.returns) if method.returns else ""
            rows.append((one, kind, ast.get_docstring(method) or ""))
    if rows:
        table = ["| attribute | type | value |", "|---|---|---|"]
        table += [f"| `{one}` | {_type(kind)} | {_cell(doc)} |" for one, kind, doc in rows]
        blocks.append("\n".join(table))
    for one, method in public.items():
        if not _is_marked(method, "property"):
            blocks += function(f"{name}.{one}", method, 4, is_method=True)
    inherited = package.inherited(module, node)
    if inherited:
        blocks.append("Inherited: " + ", ".join(f"`{one}`" for one in inherited) + ".")
    return blocks


def _fields(module: Module, node: ast.ClassDef) -> list[tuple[str, str, str]]:
    """Returns name, type and comment of the fields that a class declares."""
    declared = [one for one in node.body if isinstance(one, ast.AnnAssign) and isinstance(one.target, ast.Name)]
    fields = [(ast.unparse(one.target), ast.unparse(one.annotation), _comment(module, one)) for one in declared]
    return [field for field in fields if not field[0].startswith("_")]


def _comment(module: Module, node: ast.stmt) -> str:
    """Returns the comment "#:" above a statement."""
    found: list[str] = []
    for line in reversed(module.lines[: node.lineno - 1]):
        if not line.strip().startswith("#:"):
            break
        found.insert(0, line.strip()[2:].strip())
    return " ".join(found)


def _type(kind: str) -> str:
    """Returns a type for a cell of a table, where a bar would end the cell."""
    return "`" + kind.replace("|", "\\|") + "`" if kind else ""


def _cell(doc: str) -> str:
    """Returns the first paragraph of a docstring, for a cell of a table."""
    return _prose(" ".join(inspect.cleandoc(doc).split("\n\n")[0].split()))


def page(package: Package, module: str) -> str:
    """Returns the page of a module: functions, classes, errors and types, each in the order of ``__all__``."""
    here = package.module(module)
    sections: dict[str, list[str]] = {"Modules": [], "Functions": [], "Classes": [], "Errors and warnings": [], "Types": []}
    for name in here.exported():
        found = package.find(module, name)
        if found is None and is_module(name):
            first = package.module(name).doc.split("\n\n")[0].replace("\n", " ")
            sections["Modules"].append(f"- [`papilio.{name}`]({name}.py): {_prose(first)}")
        if found is None or (found[0] != module and module != "__init__"):
            continue
        origin, node = found
        if isinstance(node, ast.FunctionDef):
            sections["Functions"] += function(name, node, 3)
        elif isinstance(node, ast.ClassDef):
            is_error = name.endswith(("Error", "Warning", "Mistake"))
            sections["Errors and warnings" if is_error else "Classes"] += klass(package, origin, name, node)
        elif isinstance(node, ast.Assign):
            about = _prose(_comment(package.module(origin), node))
            sections["Types"] += [f"### {_title(name)}", _code(f"{name} = {ast.unparse(node.value)}"), about]
    title = "papilio" if module == "__init__" else f"papilio.{module}"
    blocks = [f"# {_title(title)}", markdown(here.doc)]
    sections["Modules"] = ["\n".join(sections["Modules"])] if sections["Modules"] else []
    for heading, inner in sections.items():
        blocks += [f"## {heading}", *inner] if inner else []
    return "\n\n".join(block for block in blocks if block) + "\n"


def anchors(module: str, text: str) -> dict[str, str]:
    """Returns a link for each name that a page documents: ``films.power``, ``Scenario.load``."""
    count: dict[str, int] = {}
    found = {}
    for name in re.findall(r"^#{3,4} `(.+)`$", text, flags=re.MULTILINE):
        slug = name.lower().replace(".", "")
        number = count.get(slug, 0)
        count[slug] = number + 1
        prefix = "" if module == "__init__" else f"{module}."
        found[prefix + name] = f"{module}.py#{slug}" + (f"-{number}" if number else "")
    return found


def linked(module: str, text: str, known: dict[str, str]) -> str:
    """Returns a page in which names of the package lead to their documentation; names of arguments stay as they are."""

    def link(match: re.Match[str]) -> str:
        name = match[1].removeprefix("papilio.")
        target = known.get(f"{module}.{name}") or known.get(name)
        # A word in lower case may be an argument of the same name.
        is_sure = target and (name[0].isupper() or "." in match[1] or module != "__init__")
        return f"[`{match[1]}`]({target})" if is_sure else match[0]

    lines, is_code = [], False
    for line in text.split("\n"):
        is_code ^= line.startswith("```")
        start = re.match(r"- `[^`]*`: ", line)
        at = start.end() if start else 0
        plain = is_code or line.startswith(("#", "|", "```"))
        lines.append(line if plain else line[:at] + re.sub(r"(?<!\[)`([\w.]+)`", link, line[at:]))
    return "\n".join(lines)


def main() -> None:
    """Writes the pages of the package and of its public modules."""
    out = Path(sys.argv[1])
    out.mkdir(parents=True, exist_ok=True)
    package = Package()
    exported = package.module("__init__").exported()
    names = ["__init__", *(name for name in exported if is_module(name) and package.find("__init__", name) is None)]
    pages = {name: page(package, name) for name in names}
    known = {target: link for name, text in pages.items() for target, link in anchors(name, text).items()}
    for name, text in pages.items():
        (out / f"{name}.md").write_text(linked(name, text, known), encoding="utf-8")


if __name__ == "__main__":
    main()
