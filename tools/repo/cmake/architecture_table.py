# Writes the table of libraries in docs/architecture.md from the calls of kaz_library in CMakeLists.txt files.
# SPDX-License-Identifier: Apache-2.0
"""usage: architecture_table.py [--check | --write]

Prints a row for each library: its folder (and its name, where that is another), what it is (the first
sentence of the comment right above its kaz_library, or of the file), and the Kaz libraries that it links,
without those that these link in public. --check compares with docs/architecture.md; --write rewrites the
part between the markers there."""

import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[3]
PAGE = ROOT / "docs/architecture.md"
COMMAND = "tools/repo/cmake/architecture_table.py"
BEGIN, END = f"<!-- libraries: {COMMAND} -->", "<!-- end of libraries -->"
ROOMS = ("shared", "vision", "sim", "host", "hil", "tools", "tests")  # order of dependence
KAZ = re.compile(r"(?<![\w:])kaz::(\w+)")
CALL = re.compile(r"^([ \t]*)kaz_library\(\s*(\w+)([^()]*(?:\([^()]*\)[^()]*)*)\)", re.M)


def comment_of(lines):
    """The lines of the comment that `lines` begin with, without their `#`."""
    words = []
    for line in lines:
        if not line.lstrip().startswith("#"):
            break
        words.append(line.lstrip(" \t#"))
    return words


def description(text, at, alone, where):
    """First sentence of the comment right above `at`; for a file's only library, else of the file's first."""
    above = comment_of(reversed(text[:at].splitlines()))[::-1]
    comment = [line for line in above or (comment_of(text.splitlines()) if alone else [])
               if not line.startswith("SPDX")]
    if not comment:
        sys.exit(f"{where}: kaz_library has no comment right above it: describe the library there")
    sentence = re.split(r"\.(?:\s|$)", re.sub(r"^kaz::\w+: ", "", " ".join(comment)))[0]
    # Inside a row a sentence begins small, unless with a name (H8S, JUnit).
    return sentence[0].lower() + sentence[1:] if re.match(r"[A-Z][a-z']*\b", sentence) else sentence


def libraries(path):
    """Name, description, linked and publicly linked Kaz libraries of each library of a CMakeLists.txt."""
    text = path.read_text()
    calls = list(CALL.finditer(text))
    for call in calls:
        where = f"{path.relative_to(ROOT)}:{text.count(chr(10), 0, call.start()) + 1}"
        arguments = re.sub(r"#[^\n]*", "", call[3])
        public = re.search(r"\bPUBLIC\b(.*?)(?:\bPRIVATE\b|$)", arguments, re.S)
        yield (call[2], description(text, call.start(), len(calls) == 1, where), KAZ.findall(arguments),
               KAZ.findall(public[1]) if public else [])


def table():
    found = {}  # room -> [(folder in it, name, description, uses)]
    public = {}
    for room in ROOMS:
        for path in sorted((ROOT / room).rglob("CMakeLists.txt")):
            for name, text, uses, public[name] in libraries(path):
                folder = path.parent.relative_to(ROOT / room).as_posix()
                found.setdefault(room, []).append((folder, name, text, uses))
    if not found:
        sys.exit(f"{ROOT}: no CMakeLists.txt calls kaz_library")

    def reached(name):
        return set().union(*({use} | reached(use) for use in public.get(name, [])))

    lines = ["| library | purpose | links |", "|---|---|---|"]
    for room, entries in found.items():
        for folder, name, text, uses in entries:
            direct = [use for use in dict.fromkeys(uses) if not any(use in reached(other) for other in uses)]
            place = room if folder == "." else f"{room}/{folder}"
            alone = name.removeprefix("tool_") in (place, folder)
            shown = place if alone or place.endswith(f"/{name}") else f"{place}: {name}"
            lines.append(f"| `{shown}` | {text} | {', '.join(direct)} |")
    return "\n".join(lines)


def main(arguments):
    if arguments not in ([], ["--check"], ["--write"]):
        sys.exit(__doc__)
    made = table()
    if not arguments:
        print(made)
        return
    page = PAGE.read_text()
    if page.count(BEGIN) != 1 or page.count(END) != 1:
        sys.exit(f"{PAGE.relative_to(ROOT)} needs the lines '{BEGIN}' and '{END}', once each")
    before, rest = page.split(BEGIN)
    now = f"{before}{BEGIN}\n{made}\n{END}{rest.split(END)[1]}"
    if arguments == ["--write"]:
        PAGE.write_text(now)
    elif now != page:
        sys.exit("docs/architecture.md differs from the libraries in CMake: run `python3 -B "
                 f"{COMMAND} --write`")


main(sys.argv[1:])
