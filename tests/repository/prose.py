# Checks the English of pages, headers and messages: banned openings and phrases, sentence lengths, spelling.
# SPDX-License-Identifier: Apache-2.0
"""usage: prose.py ROOT | prose.py FILE...

ROOT checks every page, the comments of every header, and the string literals of the product's sources.
FILE... checks these files, and prints words and sentence lengths of each.
The rules that a script can count; CONTRIBUTING.md has the others. Spelling needs codespell."""

import pathlib
import re
import subprocess
import sys

# Limits for the sentences of a page, in words: median, 95th percentile, longest.
MEDIAN, NEARLY_ALL, LONGEST = 16, 25, 40
FEWEST = 10  # sentences of a page for a median and a percentile
WORDS_IN_ALL = 55_400

PERSON = r"(?:code|program|firmware|board|host|page|file|name|state|test|function|kaz|robot|simulator|it)"
RULES = [(re.compile(pattern, re.I), advice) for pattern, advice in (
    (r"^(?:of|who|whoever|what|whatever|nothing|in vain)\b(?!.*\?$)", "begin with the subject"),
    (r"^that (?=the |a |an |it |they |so |no |each |every |`)", "begin with the subject, not with a clause"),
    (r"\b(?:is|are|was|were|be) of (?!(?:interest|use|course|type|order|the order)\b)", "name the relation"),
    (r"\bthere (?:is|are|was|were) none\b|\bis none\b", "say what is missing"),
    (r"\bso many\b", "give the number"),
    (r"\bin vain\b", "retries exhausted, without success"),
    (r"\bwhoever\b", "name who it is"),
    (r"\bthousand million\b", "standard notation, as 3.03e10"),
    (rf"\b{PERSON} (?:may |can |will |does not |cannot )?(?:tell|know|think|hear|want|ask)s?\b",
     "code reads, checks, returns, reports"),
    (r"\bdesign, section\b|\bthe project's plan\b|\bthe requirement says\b|\bthe plan (?:had|says)\b",
     "refers to a document that is not in the tree"),
)]

FENCE = re.compile(r"^ {0,3}(```+|~~~+).*?^ {0,3}\1[ \t]*$", re.M | re.S)
BREAK = re.compile(r"(?<!e\.g)(?<!i\.e)(?<!vs)(?<!cf)(?<!Fig)(?<!approx)"
                   r"[.!?][)\"*_]*\s+(?=[\"(*_]*[A-Z0-9`\[-])")
LITERAL = re.compile(r'//[^\n]*|/\*.*?\*/|R"(\w*)\((?P<raw>.*?)\)\1"|"(?P<text>(?:\\.|[^"\\\n])*)"'
                     r"|'(?:\\.|[^'\\\n])+'", re.S)
CODE = re.compile(r"""((?:"(?:\\.|[^"\\])*"|'(?:\\.|[^'\\])+'|(?!//).)*)(//|)(.*)""")
ITEM = re.compile(r"^(\s*)(?:[-*+]|\d+[.)])\s+")


def plain(text):
    """Text as it is read: a link is its text, code is one word."""
    text = re.sub(r"<!--.*?-->|<[a-z/][^>]*>", " ", text, flags=re.S)
    text = re.sub(r"!\[[^\]]*\]\([^)]*\)", " ", text)
    text = re.sub(r"\[((?:[^\[\]]|\[[^\]]*\])*)\]\([^)]*\)", r"\1", text)
    text = re.sub(r"``[^`]+(?:`[^`]+)*``|`[^`]+`", "`x`", text)
    return re.sub(r"[*_]{1,3}(?=\S)|(?<=\S)[*_]{1,3}", "", text)


def blocks(page):
    """(line number, text, whether it is a cell or a heading) of each paragraph, item, cell and heading."""
    lines = FENCE.sub(lambda found: "\n" * found[0].count("\n"), page).splitlines()
    found, gathered, start, in_list = [], [], 0, False

    def end():
        if gathered:
            found.append((start, plain(" ".join(gathered)), False))
            gathered.clear()

    for number, line in enumerate(lines, 1):
        is_item = ITEM.match(line)
        if not line.strip() or line.lstrip().startswith(("#", "<!--")):
            end()
            if title := re.match(r"#+ +(.*)", line):
                found.append((number, plain(title[1]), True))
            in_list = in_list and not line.lstrip().startswith("#")
        elif line.lstrip().startswith("|"):
            end()
            if not re.fullmatch(r"[\s|:-]+", line):
                cells = (plain(cell.strip()) for cell in re.split(r"(?<!\\)\|", line))
                found += [(number, cell, True) for cell in cells if cell]
        elif line.startswith("    ") and not gathered and not (in_list and not line.startswith("        ")):
            in_list = False  # code
        else:
            if is_item:
                end()
                in_list = True
            elif not line.startswith(" ") and not gathered:
                in_list = False
            if not gathered:
                start = number
            gathered.append(ITEM.sub("", line).strip())
    end()
    return found


def comments(source):
    """(line number, text, whether it stands behind code) of each paragraph and item of comments in C or C++.
    Lines that are indented within a comment are tables or formulas."""
    found, gathered, start, in_item = [], [], 0, False

    def end():
        if gathered:
            found.append((start, plain(" ".join(gathered)), False))
            gathered.clear()

    for number, line in enumerate(source.splitlines(), 1):
        code, mark, text = CODE.match(line).groups()
        text = text.lstrip("/")
        indent = len(text) - len(text.lstrip())
        text = text.strip("/< ")
        if not mark or code.strip() or not text or text.startswith(("SPDX", "clang-format")):
            end()
            in_item = False
        if mark and code.strip():
            found.append((number, plain(re.sub(r"NOLINT.*", "", text)), True))
        elif mark and text and not text.startswith(("SPDX", "clang-format")):
            if ITEM.match(text) or (indent < 2 and in_item):
                end()
            in_item = bool(ITEM.match(text)) or (in_item and indent >= 2)
            if indent >= 2 and not in_item:
                end()
                continue
            if not gathered:
                start = number
            gathered.append(ITEM.sub("", text))
    end()
    return found


def messages(source):
    """(line number, text, True) of each line with three words or more in the string literals of C or C++."""
    source = re.sub(r"^[ \t]*#[ \t]*include.*$", "", source, flags=re.M)
    joined = re.sub(r'"(?:[ \t]*\n)+[ \t]*"', lambda gap: "\0" * gap[0].count("\n"), source)
    for found in LITERAL.finditer(joined):
        literal = found["raw"] if found["raw"] is not None else found["text"]
        if literal is None:
            continue
        before = joined[:found.start()]
        for text in re.split(r"\n|\\n", literal.replace('\\"', '"').replace("\0", "")):
            if len(text.split()) >= 3:
                # A literal such as " of link `" continues a sentence.
                text = re.sub(r"^(?=of |that |[^\w`])", "... ", text)
                yield before.count("\n") + before.count("\0") + 1, plain(text), True


def sentences(text):
    return [part.strip() for part in BREAK.split(text) if part.strip()]


def words(sentence):
    return len([word for word in sentence.split() if re.search(r"\w", word)])


def broken_rules(sentence):
    """(what stands there, advice) of each rule that the sentence breaks."""
    bare = sentence.strip(" \"(*_-")
    return [(found[0].strip(), advice) for pattern, advice in RULES if (found := pattern.search(bare))]


def check(name, passages):
    """(faults, lengths of the sentences outside of cells and comments behind code)"""
    faults, lengths = [], []
    for number, text, is_cell in passages:
        for sentence in sentences(text):
            for found, advice in broken_rules(sentence):
                faults.append(f"{name}:{number}: '{found}' in '{sentence[:60]}': {advice}")
            count = words(sentence)
            if count > LONGEST:
                faults.append(f"{name}:{number}: {count} words, more than {LONGEST}: '{sentence[:60]}...'")
            if not is_cell:
                lengths.append(count)
    lengths.sort()
    if len(lengths) >= FEWEST:
        for share, limit in ((0.5, MEDIAN), (0.95, NEARLY_ALL)):
            if (value := percentile(lengths, share)) > limit:
                faults.append(f"{name}: {100 * share:.0f} % of the sentences have up to {value} words, "
                              f"more than {limit}: split the long ones")
    return faults, lengths


def check_file(name, path):
    text = path.read_text()
    if path.suffix == ".md":
        return check(name, blocks(text))
    passages = comments(text) if path.suffix in (".h", ".hpp") else []
    return check(name, [*passages, *messages(text)])


def percentile(values, share):
    return values[min(len(values) - 1, int(share * len(values)))] if values else 0


def misspelled(files):
    """American spelling, by codespell: pages and headers as they are, the literals of other sources."""
    whole = [path for path in files if path.suffix in (".md", ".h", ".hpp")]
    literals = "".join(f"{path}:{number}: {text}\n" for path in files if path not in whole
                       for number, text, _ in messages(path.read_text()))
    command = ["codespell", "--builtin", "clear,en-GB_to_en-US", "--ignore-words",
               pathlib.Path(__file__).with_name("spelling.txt")]
    checked = [subprocess.run([*command, *names], input=text, capture_output=True, text=True)
               for names, text in ((whole, None), (["-"], literals)) if names != [] and text != ""]
    return [line for one in checked for line in one.stdout.splitlines()]


def tracked(root, *patterns):
    listed = subprocess.run(["git", "-C", root, "ls-files", "-co", "--exclude-standard", *patterns],
                            capture_output=True, text=True, check=True).stdout.split()
    return [root / name for name in listed if (root / name).exists() and name != "CHANGELOG.md"]


def is_product(root, path):
    name = path.relative_to(root).as_posix()
    return "_test" not in name and not name.startswith(("tests/", "examples/", "tools/fuzz/"))


def main(arguments):
    root = pathlib.Path(arguments[0])
    if root.is_dir():
        pages = tracked(root, "*.md")
        sources = tracked(root, "*.cpp", "*.c", "*.def")
        files = pages + tracked(root, "*.h", "*.hpp") + [path for path in sources if is_product(root, path)]
    else:
        files = pages = [pathlib.Path(name) for name in arguments]
    faults, in_all = [], 0
    for path in files:
        text = path.read_text()
        found, lengths = check_file(path.relative_to(root) if root.is_dir() else path, path)
        faults += found
        in_all += len(text.split()) if path in pages else 0
        if not root.is_dir():
            above = sum(count > NEARLY_ALL for count in lengths)
            print(f"{path}: {len(text.split())} words; {len(lengths)} sentences, median "
                  f"{percentile(lengths, 0.5)}, 95 % {percentile(lengths, 0.95)}, "
                  f"longest {max(lengths, default=0)}, {above} above {NEARLY_ALL}")
    faults += misspelled(files)
    if root.is_dir() and in_all > WORDS_IN_ALL:
        faults.append(f"all pages: {in_all} words, more than {WORDS_IN_ALL}: shorten before you add")
    print("\n".join(faults) if faults else f"{len(files)} files keep the rules")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
