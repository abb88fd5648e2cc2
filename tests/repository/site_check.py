# Checks a folder of HTML pages: links, anchors, pictures, outside hosts, reachability, text, search index.
# Knows nothing of how they were made.
# SPDX-License-Identifier: Apache-2.0
import html.parser
import json
import pathlib
import posixpath
import re
import urllib.parse

OUTSIDE = re.compile(r"^(?:[a-z][a-z0-9+.-]*:)?//", re.I)
# Attributes by which a page loads something, rather than leads to it.
LOADS = {("script", "src"), ("link", "href"), ("img", "src"), ("iframe", "src"), ("source", "src"),
         ("embed", "src"), ("object", "data"), ("video", "src"), ("audio", "src"), ("img", "srcset"),
         ("source", "srcset"), ("use", "href"), ("use", "xlink:href"), ("image", "href")}
NO_LOAD = {"search", "next", "prev", "index", "canonical", "author", "copyright", "top",
           "up"}  # rel of <link>


class Page(html.parser.HTMLParser):
    """Anchors, links, loaded files and text of one page."""
    def __init__(self, text):
        super().__init__(convert_charrefs=True)
        self.anchors, self.links, self.loads, self.navigation, self.words = [], [], [], [], []
        self.path = []  # open elements, with their classes
        self.feed(text)
        self.text = " ".join(self.words)

    def handle_starttag(self, tag, attributes):
        values = {name: value or "" for name, value in attributes}
        if "id" in values:
            self.anchors.append(values["id"])
        if tag == "a" and "name" in values:
            self.anchors.append(values["name"])
        if tag == "a" and "href" in values:
            self.links.append(values["href"])
            if any("sidebar-tree" in classes for _, classes in self.path):
                self.navigation.append(values["href"])
        for name, value in values.items():
            if (tag, name) in LOADS and not (tag == "link"
                                             and set(values.get("rel", "").split()) & NO_LOAD):
                self.loads.append(value)
        if tag not in ("meta", "link", "img", "br", "hr", "input", "source", "col", "wbr"):
            self.path.append((tag, values.get("class", "")))

    def handle_endtag(self, tag):
        for at in range(len(self.path) - 1, -1, -1):
            if self.path[at][0] == tag:
                del self.path[at:]
                break

    def handle_data(self, data):
        inside = [tag for tag, _ in self.path]
        if "article" in inside and "script" not in inside and "style" not in inside:
            self.words.append(data)


def read_site(folder):
    return {
        path.relative_to(folder).as_posix(): Page(path.read_text())
        for path in sorted(folder.rglob("*.html"))
    }


def place(page, target):
    """(file, anchor) that a link of `page` leads to, relative to the site; None: it leads outside."""
    if OUTSIDE.match(target) or re.match(r"^(mailto|data|https?):", target):
        return None
    path, _, anchor = target.partition("#")
    path = urllib.parse.unquote(path.split("?")[0])
    return (posixpath.normpath(posixpath.join(posixpath.dirname(page), path)) if path else page,
            urllib.parse.unquote(anchor))


def link_faults(folder, pages):
    files = {path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()}
    anchors = {name: set(page.anchors) for name, page in pages.items()}
    faults = []
    for name, page in pages.items():
        for target in page.links + page.loads:
            found = place(name, target)
            if found is None:
                continue
            if found[0] not in files:
                faults.append(f"{name}: '{target}' is not there")
            elif found[1] and found[0] in anchors and found[1] not in anchors[found[0]]:
                faults.append(f"{name}: '{target}': there is no such place on the page")
        for twice in {anchor for anchor in page.anchors if page.anchors.count(anchor) > 1}:
            faults.append(f"{name}: two places are called '{twice}'")
    return faults


def outside_faults(folder, pages):
    """What would be fetched from another host, or by an absolute path, when a page is looked at."""
    faults = [
        f"{name}: loads '{target}'" for name, page in pages.items() for target in page.loads
        if OUTSIDE.match(target) or target.startswith(("/", "file:"))
    ]
    for path in folder.rglob("*.css"):
        text = re.sub(r"/\*.*?\*/", "", path.read_text(), flags=re.S)
        for target in re.findall(r"url\(\s*['\"]?([^'\")]+)", text) + re.findall(
                r"@import\s+['\"]([^'\"]+)", text):
            name = path.relative_to(folder).as_posix()
            if OUTSIDE.match(target) or target.startswith("/"):
                faults.append(f"{name}: loads '{target}'")
            elif not target.startswith(
                ("data:", "#")) and not (path.parent / target.split("?")[0]).exists():
                faults.append(f"{name}: '{target}' is not there")
    for path in folder.rglob("*.js"):
        for line in path.read_text().splitlines():
            if re.match(r"^\s*(import\b.*\bfrom\b|export\b)", line):
                faults.append(
                    f"{path.relative_to(folder)}: is a module, which browsers do not load from file://")
    return faults


def reached(pages, start="index.html"):
    """Pages that links lead to from the first one."""
    found, ahead = set(), [start]
    while ahead:
        name = ahead.pop()
        if name in found or name not in pages:
            continue
        found.add(name)
        ahead += [target[0] for link in pages[name].links if (target := place(name, link))]
    return found


def words(text):
    return set(re.findall(r"[a-z]{5,}", text.lower()))


def markdown_words(text):
    """Words of a Markdown page that a reader sees: without targets of links, and comments."""
    text = re.sub(r"^\s*<!--.*?-->\s*$", "", text, flags=re.M)
    text = re.sub(r"^```[^\n]*$", "", text, flags=re.M)
    text = re.sub(r"!\[(?:[^\[\]]|\[[^\]]*\])*\]\([^)]*\)", "", text)
    return words(re.sub(r"\]\([^)\s]*\)", "]", text))


def text_faults(name, page, source):
    missing = markdown_words(source) - words(page.text)
    return [f"{name}: lacks '{word}' of its source" for word in sorted(missing)[:5]]


def search_index(folder):
    """{page: set of indexed terms} of searchindex.js, whose keys are words without quotes."""
    text = (folder / "searchindex.js").read_text()
    inside = re.fullmatch(r"Search\.setIndex\((.*)\)\s*;?\s*", text, re.S)[1]
    token = re.compile(r'"(?:\\.|[^"\\])*"|[A-Za-z_$][\w$]*(?=:)')
    index = json.loads(
        token.sub(lambda found: found[0] if found[0].startswith('"') else f'"{found[0]}"', inside))
    terms = {name: set() for name in index["docnames"]}
    for key in ("terms", "titleterms"):
        for term, places in index[key].items():
            for number in places if isinstance(places, list) else [places]:
                terms[index["docnames"][number]].add(term)
    return terms


def search_faults(name, page, terms):
    """The index has a word for most words of a page: stems, so only their beginning is compared."""
    wanted = {word for word in words(page.text) if len(word) >= 6}
    beginnings = {part[:4] for term in terms for part in re.findall(r"[a-z]+", term)}
    found = {word for word in wanted if word[:4] in beginnings}
    return [] if len(found) >= max(1, 0.9 * len(wanted)) else [
        f"{name}: {len(found)} of its {len(wanted)} longer words are in the search index"
    ]


def path_faults(folder, *paths):
    """Files that contain a path of the machine that built them."""
    return [
        f"{path.relative_to(folder)}: contains the path {wanted}"
        for path in pathlib.Path(folder).rglob("*") if path.suffix in (".html", ".js", ".css", ".txt")
        for wanted in paths if wanted in path.read_text()
    ]
