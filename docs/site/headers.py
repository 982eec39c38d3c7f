# SPDX-License-Identifier: GPL-3.0-or-later
"""C++ headers as people read them: what each declares, with its comment, without bodies and without what is private.

Not a compiler: it reads what .clang-format lays out. Declarations that stand together without an empty line between
them belong together, as they do for the comment above them.
"""
import dataclasses
import re

TYPE = re.compile(r"(?:template\s*<.*?>\s*(?:requires [^{;]*?\s)?)?(class|struct|enum class|enum|union)\s+(\w+)", re.S)
ALIAS = re.compile(r"(?:template\s*<.*?>\s*)?(?:using|concept)\s+(\w+)\s*=", re.S)
NOT_CODE = re.compile(r'//.*|"(?:\\.|[^"\\])*"|\'(?:\\.|[^\'\\])+\'(?!\w)')


def code_of(line):
    """A line with its comments, strings and characters blanked out, as long as it was."""
    return NOT_CODE.sub(lambda found: " " * len(found[0]), line)


def depth_of(line):
    code = code_of(line)
    return sum(code.count(c) for c in "{([") - sum(code.count(c) for c in "})]")


@dataclasses.dataclass
class Entry:
    """Declarations and the comment above them."""
    comment: list
    declarations: list  # of lists of lines
    apart: bool  # an empty line stands before it

    @property
    def names(self):
        return list(dict.fromkeys(name for name in map(name_of, self.declarations) if name))

    @property
    def types(self):
        return [name for code in self.declarations if (name := type_of(code)) is not None]

    @property
    def text(self):
        return "\n".join("\n".join(shown(lines)) for lines in self.declarations)


def entries(lines):
    """Of a namespace's lines, or of a class's."""
    comment, declarations, current, depth, apart = [], [], [], 0, False
    for line in [*lines, ""]:
        stripped = line.strip()
        if not current and (not stripped or stripped.startswith("///")) and (declarations or (comment and not stripped)):
            yield Entry(comment, declarations, apart)
            comment, declarations, apart = [], [], False
        if current or (stripped and not stripped.startswith(("//", "#"))):
            current.append(re.sub(r" *// NOLINT.*", "", line))
            depth += depth_of(line)
            if depth == 0 and code_of(line).rstrip().endswith((";", "}", ":")) and not is_open(current):
                declarations.append(current)
                current = []
        elif stripped.startswith("///") and "@" not in stripped[:6]:
            comment.append(stripped[3:].removeprefix(" "))
        apart = apart or not stripped


def is_open(lines):
    """Whether a line that ends with a colon goes on: only public:, protected: and private: end there."""
    last = code_of(lines[-1]).strip()
    return last.endswith(":") and not re.fullmatch(r"(public|protected|private):", last)


def joined(lines):
    return "\n".join(code_of(line) for line in lines)


def type_of(lines):
    """Name of the type that is defined, None for what is no type."""
    code = joined(lines).strip()
    found = TYPE.match(code)
    if found:
        return found[2] if "{" in code else None
    alias = ALIAS.match(code)
    return alias[1] if alias else None


def name_of(lines):
    code = joined(lines).strip()
    if name := type_of(lines):
        return name
    if TYPE.match(code) or code.startswith(("static_assert", "extern template", "friend", "using namespace")):
        return None
    head = code[:body_at(code)] if body_at(code) is not None else code
    head = re.sub(r"^template\s*<.*?>\s", "", head, flags=re.S) if head.startswith("template") else head
    operator = re.search(r"operator\s*([^\s\w(]+|\(\)|\w+)\s*\(", head)
    if operator:
        return "operator" + operator[1]
    function = re.search(r"([A-Za-z_]\w*)\s*\(", without_angles(head))
    if function and "=" not in without_angles(head)[:function.start()]:
        return function[1]
    variable = re.search(r"(\w+)\s*(?:\[[^\]]*\]\s*)*(?:=|;|\{)", without_angles(head))
    return variable[1] if variable else None


def without_angles(code):
    """With what is between < and > blanked out."""
    before = None
    while before != code:
        before, code = code, re.sub(r"(?<=[\w>])<[^<>()=]*>|(?<=[\w>])<[^<>=]*>", lambda f: " " * len(f[0]), code)
    return code


def body_at(code):
    """Where a function's body, or what its members are made of, begins in code; None if there is none."""
    code, depth, parameters = without_angles(code), 0, False
    code = re.sub(r"operator\s*(\(\)|[^\s\w(]+)", lambda f: " " * (len(f[0]) - 1) + "f", code)
    for place, c in enumerate(code):
        if depth == 0 and c == "=" and not parameters:
            return None
        if depth == 0 and parameters and (c == "{" or (c == ":" and ":" not in (code[place - 1], code[place + 1:place + 2]))):
            return place
        if c in "([{":
            parameters = parameters or (c == "(" and depth == 0)
            depth += 1
        elif c in ")]}":
            depth -= 1
    return None


def shown(lines):
    """A declaration without body; a class without what is private."""
    code, text = joined(lines), "\n".join(lines)
    if type_of(lines) is not None and TYPE.match(code.strip()):
        return lines if re.match(r"\s*enum", code) else shown_class(lines)
    place = body_at(code)
    return lines if place is None else (text[:place].rstrip() + ";").split("\n")


def shown_class(lines):
    code, text = joined(lines), "\n".join(lines)
    begin, end = code.index("{") + 1, code.rindex("}")
    if "\n" not in text[begin:end]:
        return lines
    result, private = text[:begin].split("\n"), TYPE.match(code.strip())[1] == "class"
    for entry in entries(text[begin:end].lstrip("\n").split("\n")):
        part = []
        for declaration in entry.declarations:
            label = re.fullmatch(r"\s*(public|protected|private):", joined(declaration).rstrip())
            if label:
                private = label[1] == "private"
            if not private:
                part += shown(declaration)
        if part:
            indent = re.match(r" *", part[0])[0]
            part = [f"{indent}/// {line}".rstrip() for line in entry.comment] + part
            result += [""] * ((entry.apart or bool(entry.comment)) and not result[-1].endswith(("{", ":"))) + part
    return result + [re.match(r" *", lines[-1])[0] + text[end:]]


def declared(text):
    """Entries of a header's namespace."""
    inside = re.search(r"^namespace [\w:]+ \{\n(.*)^\}  // namespace", text, re.S | re.M)
    if not inside:
        return
    for entry in entries(inside[1].split("\n")):
        entry.declarations = [lines for lines in entry.declarations
                              if not re.match(r"(class|struct|enum class) \w+( : [\w:]+)?;", joined(lines))
                              and not joined(lines).startswith(("static_assert", "extern template"))]
        if entry.declarations or entry.comment:
            yield entry
