# Which sources of a target are compiled together, so that headers are read once for several of them.
# SPDX-License-Identifier: Apache-2.0
"""usage: unity_groups.py ROOT <list

Reads lines `TARGET;SIZE;SOURCE;SOURCE...` (paths of C++ sources, absolute) and prints one line `SOURCE;GROUP`
for each source that joins a group. Two sources are in one group only if neither has a name of file scope (in
an unnamed namespace, static, a macro, an alias) that is a word of the other one, so that none can mean or
hide anything in the other. Words behind `.`, `->` or `::` are looked up elsewhere, and an alias that both
sources declare alike means the same in both. A group has at most SIZE sources."""

import pathlib
import re
import sys

COMMENT = re.compile(r'//[^\n]*|/\*.*?\*/|R"\((?:.|\n)*?\)"|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])+\'', re.S)
WORDS = {"operator", "if", "for", "while", "switch", "return", "sizeof", "alignas", "decltype", "noexcept",
         "static_assert", "TEST", "TEST_F", "TEST_P", "TYPED_TEST", "INSTANTIATE_TEST_SUITE_P", "BENCHMARK",
         "extern", "defined", "template", "requires", "void", "bool", "int", "double"}


def declared(statement):
    """The names that a statement of namespace scope declares."""
    statement = re.sub(r"^\s*template\s*<[^{}]*?>\s*(?=\w)", "", statement.strip())
    statement = re.sub(r"\[\[.*?\]\]", "", statement)
    kind = re.match(r"(?:typedef\s+)?(?:struct|class|union|enum(?:\s+class|\s+struct)?)\s+(\w+)", statement)
    if kind and not re.search(r"\)\s*(?:const)?\s*$", statement):
        return [kind.group(1)]
    alias = re.match(r"using\s+(?:namespace\s+)?(?:\w+::)*(\w+)\s*(?:=|$)", statement)
    if alias:
        return [alias.group(1)]
    space = re.match(r"namespace\s+(\w+)\s*=", statement)
    if space:
        return [space.group(1)]
    head = re.split(r"=(?!=)|\{", statement)[0]
    if "(" in head:
        names = re.findall(r"([A-Za-z_]\w*)\s*\(", head)
        names = [name for name in names if name not in WORDS]
        return names[:1]
    names = re.findall(r"[A-Za-z_]\w*", re.sub(r"\[.*?\]|<.*?>", " ", head))
    if len(names) < 2:
        return []
    return names[-1:] + re.findall(r",\s*([A-Za-z_]\w*)\s*(?==[^=]|,|\{|$)", statement)


def names_of(path):
    """Names of file scope, each with its statement if that is an alias, and the words that are looked up."""
    text = path.read_text(errors="replace")
    names = dict.fromkeys(re.findall(r"^\s*#\s*define\s+(\w+)", text, re.M))
    if re.search(r"^using namespace (?!std::\w*literals;)", text, re.M):
        names["*"] = None
    text = COMMENT.sub(lambda m: '""' if m.group(0)[0] in "\"R" else " ", text)
    text = re.sub(r"^\s*#(?:[^\n\\]|\\\n|\\.)*", "", text, flags=re.M)
    scopes, statement = [], ""  # of each open brace: "anonymous", "named" or "other"
    for piece in re.split(r"([{};])", text):
        if piece == "{":
            head = statement.strip()
            outer = all(scope != "other" for scope in scopes)
            if outer and re.search(r"(?:^|\s)namespace\s*$", head):
                scopes.append("anonymous")
            elif outer and re.match(r"(?:inline\s+)?namespace\s+[\w:]+$|extern\s*\"\"$", head):
                scopes.append("named")
            else:
                if outer and head:
                    record(names, head, scopes)
                scopes.append("other")
            statement = ""
        elif piece == "}":
            if scopes:
                scopes.pop()
            statement = ""
        elif piece == ";":
            if all(scope != "other" for scope in scopes) and statement.strip():
                record(names, statement, scopes)
            statement = ""
        else:
            statement += piece
    return names, set(re.findall(r"(?<![\w.])(?<!->)(?<!::)[A-Za-z_]\w*", text))


def record(names, statement, scopes):
    inner = "anonymous" in scopes
    hidden = re.match(r"\s*(?:static|using|constexpr|const|namespace\s+\w+\s*=|struct|class|enum)\b",
                      statement)
    if inner or hidden:
        alias = re.match(r"\s*(?:using|namespace)\b", statement)
        meaning = re.sub(r"\s+", "", statement) if alias else None
        names.update((name, meaning) for name in declared(statement))


def conflict(names, other_names, other_words):
    return any(name in other_words and (meaning is None or other_names.get(name) != meaning)
               for name, meaning in names.items())


def main():
    root = pathlib.Path(sys.argv[1])
    for line in sys.stdin:
        target, size, *sources = line.strip().split(";")
        groups = []  # (names of file scope, words, sources)
        for source in sources:
            path = pathlib.Path(source)
            names, words = names_of(path if path.is_absolute() else root / path)
            if "*" in names:
                continue
            for group in groups:
                if (len(group[2]) < int(size) and not conflict(group[0], names, words)
                        and not conflict(names, group[0], group[1])):
                    group[0].update(names)
                    group[1].update(words)
                    group[2].append(source)
                    break
            else:
                groups.append((dict(names), set(words), [source]))
        for number, (_, _, members) in enumerate(groups):
            if len(members) > 1:
                for source in members:
                    print(f"{source};{target}_{number}")


main()
