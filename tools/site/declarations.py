# Reads a header of ours: its comment, and each public declaration with the comment above it. Private parts
# and bodies of functions are left out. Relies on clang-format; the test repository.site compares with ctags.
# SPDX-License-Identifier: Apache-2.0
import dataclasses
import re

LITERAL = re.compile(r'"(?:\\.|[^"\\])*"|\'(?:\\.|[^\'\\])+\'')
ACCESS = re.compile(r"^\s*(public|protected|private):")
TYPE = re.compile(r"^(?:typedef )?(class|struct|union|enum(?: class| struct)?)\b(?:[^;=(]|\([^)]*\))*\{",
                  re.S)
DROPPED = re.compile(
    r'^\s*(#\s*(pragma|include|if|ifdef|ifndef|elif|else|endif|undef|error)\b|extern "C" \{|namespace\b'
    r"|\}\s*(//.*)?$|[A-Z][A-Z0-9_]+$|(class|struct|union|enum|enum class) [\w:]+;|friend\b|static_assert\b"
    r"|#define KAZ_\w+_(H|HPP)$)")
LONGEST_LISTING = 40  # lines of a type or table that is shown as it is


@dataclasses.dataclass
class Item:
    kind: str  # section, text, code, type
    text: list = dataclasses.field(default_factory=list)  # comment lines without their marks
    code: str = ""
    name: str = ""  # of a type
    word: str = ""  # class, struct, enum, union
    members: list = dataclasses.field(default_factory=list)  # of a type that is not shown as it is
    names: list = dataclasses.field(default_factory=list)  # declared here


def blanked(text):
    """The text without comments and literals: only brackets and separators of code are left to count."""
    text = LITERAL.sub(lambda found: "_" * len(found[0]), text)
    return re.sub(r"//[^\n]*", lambda found: " " * len(found[0]), text)


def comment(line):
    """What stands behind the // of a line that is only a comment; None for other lines."""
    found = re.match(r"^\s*// ?(.*?)\s*$", line)
    return found[1] if found else None


def file_comment(lines):
    """The comment at the top of a file without the licence, and how many lines it has."""
    words = []
    for number, line in enumerate(lines):
        text = comment(line)
        if text is None:
            return words, number
        if not text.startswith("SPDX-License-Identifier"):
            words.append(text)
    return words, len(lines)


def statement_end(lines, begin):
    """The line behind a declaration that begins at `begin`."""
    if lines[begin].lstrip().startswith("#"):
        while lines[begin].endswith("\\"):
            begin += 1
        return begin + 1
    depth = 0
    for number in range(begin, len(lines)):
        code = blanked(lines[number])
        for character in code:
            depth += (character in "({[") - (character in ")}]")
        rest = code.rstrip()
        if depth <= 0 and (rest.endswith(
            (";", "}")) or re.match(r"^\s*[A-Z][A-Z0-9_]*\(.*\)$", code.rstrip())):
            return number + 1
    return len(lines)


def body_of(code):
    """Where the body of a function in `code` begins, or -1 if it is no function with a body."""
    flat = blanked(code)
    depth = 0
    close = False
    for at, character in enumerate(flat):
        if character == "{" and depth == 0:
            return at if close else -1
        if character == ";" and depth == 0:
            return -1
        if character == "=" and depth == 0 and not re.search(r"operator[=!<>+\-*/|&]*$", flat[:at]):
            return -1
        if character == ":" and depth == 0 and close and flat[at - 1] != ":" and flat[at + 1] != ":":
            return at
        depth += (character in "([") - (character in ")]")
        close = close or (character == ")" and depth == 0)
    return -1


def dedented(lines):
    width = min((len(line) - len(line.lstrip()) for line in lines if line.strip()), default=0)
    return "\n".join(line[width:] for line in lines)


def without_body(lines):
    """A declaration without the body of its function; the comment behind a one-line body stays."""
    code = dedented(lines)
    at = body_of(code)
    if at < 0:
        if len(lines) > LONGEST_LISTING:
            return "\n".join(code.splitlines()[:8] + ["  // ..."])
        return code
    behind = re.search(r"(?:\}|;)\s*(//[^\n]*)$", lines[-1]) if len(lines) == 1 else None
    first = re.sub(r"\s*//[^\n]*$", "", code[:at].rstrip())
    return first + ";" + ("  " + behind[1] if behind else "")


def names_in(code):
    """Names that a declaration declares, as far as links to them are wanted."""
    flat = re.sub(r"<[^<>]*>", "", re.sub(r"\bdecltype\([^)]*\)", "", blanked(code)))
    found = re.match(r"^\s*#\s*define (\w+)", flat)
    if found:
        return [found[1]]
    flat = re.sub(r"^(template\b[^\n]*\n|\s*\[\[\w+\]\])", "", flat)
    found = re.match(r"^\s*using (\w+)\s*=", flat) or \
        re.match(r"^\s*typedef\b.*?\(\*(\w+)\)", flat, re.S) or \
        re.match(r"^\s*typedef\b[^;]*?(\w+)(?:\[\w*\])*;", flat, re.S)
    if found:
        return [found[1]]
    found = re.search(r"\b(\w+|operator\W{1,3})\(",
                      flat.split("=")[0] if "operator" not in flat else flat)
    if found:
        return [] if found[1] in ("alignas", "noexcept") else [found[1]]
    return re.findall(r"(\w+)(?:\[[^\]]*\])*\s*(?=[=;,{]|$)",
                      flat.split("=")[0].split("{")[0].split(";")[0] + ";")


class Reader:
    def __init__(self, lines):
        self.lines = lines

    def items(self, begin, end, is_open=True):
        """Declarations in the lines begin..end-1; is_open: public at first."""
        result = []
        pending = []  # comment that has not met its declaration yet
        joined = False  # the next declaration continues the listing of the last one
        at = begin
        while at < end:
            line = self.lines[at]
            text = comment(line)
            access = ACCESS.match(line)
            if not line.strip() or text is not None:
                if pending and not line.strip() and is_open:
                    result.append(Item("text", pending))
                if text is None:
                    pending = []
                elif re.match(r"^(-{3,} .*|.* -{3,})$", text):
                    if is_open:
                        result.append(Item("section", name=text.strip("- ")))
                else:
                    pending.append(text)
                joined = False
                at += 1
                continue
            if access:
                is_open = access[1] == "public"
                pending, joined = [], False
                at += 1
                continue
            if re.match(r"^\s*namespace \w*detail\w* \{", line):
                at = statement_end(self.lines, at)
                continue
            if DROPPED.match(line):
                at += 1
                while self.lines[at - 1].endswith("\\"):
                    at += 1
                pending, joined = [], False
                continue
            stop = statement_end(self.lines, at)
            if is_open:
                self.add(result, pending, at, stop, joined)
                joined = result[-1].kind == "code"
            pending = []
            # A comment that continues the one behind the declaration.
            column = line.find("//")
            while stop < end and column > 0 and comment(self.lines[stop]) is not None and \
                    self.lines[stop].find("//") >= column - 1 and not line.strip().startswith("//"):
                if is_open and result[-1].kind == "code":
                    result[-1].code += "\n" + " " * column + self.lines[stop].strip()
                stop += 1
            at = stop
        return result

    def add(self, result, pending, begin, end, joined):
        lines = self.lines[begin:end]
        code = dedented(lines)
        template = re.match(r"^template\s*<[^\n]*>\n", code)
        found = TYPE.match(blanked(code)[template.end() if template else 0:])
        if not found:
            names = names_in(code)
            if joined and not pending:
                result[-1].code += "\n" + without_body(lines)
                result[-1].names += names
            else:
                result.append(Item("code", pending, without_body(lines), names=names))
            return
        head = code[:code.index("{", template.end() if template else 0)]
        name = re.match(
            r"(?:class|struct|union)?\s*(?:alignas\([^)]*\)\s*)?(?:\[\[\w+\]\]\s*)?(\w*)",
            head[(template.end() if template else 0) + found[0].index(found[1]) + len(found[1]):].strip())
        name = name[1] if name else ""
        if code.startswith("typedef"):
            name = (re.search(r"\}\s*(\w+)", code) or [None, name])[1]
        word = found[1].split()[0]
        item = Item("type", pending, name=name, word=word)
        hidden = re.search(r"^\s*(private|protected):", code, re.M) or (word == "class"
                                                                        and "public:" not in code)
        bodies = any(line.rstrip().endswith(") {") or line.rstrip().endswith("const {") for line in lines)
        if word == "enum" or len(lines) == 1 or not (hidden or bodies or len(lines) > LONGEST_LISTING):
            item.code = code
            item.names = re.findall(r"^\s+(\w+)\b", blanked(code), re.M) if word == "enum" else []
        else:
            first = next(number for number in range(begin, end) if "{" in blanked(self.lines[number])) + 1
            item.code = re.sub(r"\s+", " ", head).strip()
            item.members = self.items(first, end - 1, word != "class")
        result.append(item)


def read_header(text):
    """(comment at the top, declarations) of a header."""
    lines = text.splitlines()
    top, begin = file_comment(lines)
    return top, Reader(lines).items(begin, len(lines))
