# Stages the Markdown pages of the tree for the site: links and pictures lead to staged places, the navigation
# is that of docs/README.md. The pages stay as they are for a Git host; what a generator needs is added here.
# SPDX-License-Identifier: Apache-2.0
import pathlib
import posixpath
import re

LINK = re.compile(r"(!?\[(?:[^\[\]]|\[[^\]]*\]|!\[[^\]]*\]\([^)]*\))*\]\()([^)\s]+)(\))")
FENCE = re.compile(r"^\s*(```+|~~~+)")
HEADER = re.compile(r"(?<![\[`])`([\w/]+\.(?:h|hpp))`(?![\]`])")  # a path in code marks, outside of links
PICTURES = (".png", ".jpg", ".svg", ".webp")
INDEX = "docs/README.md"
LANGUAGES = {
    ".py": "python", ".h": "cpp", ".hpp": "cpp", ".cpp": "cpp", ".c": "c", ".sh": "sh", ".json": "json",
    ".xml": "xml", ".txt": "text", ".def": "cpp", ".md": "markdown"
}


class SiteError(Exception):
    """One sentence: which page, what, and what to do."""


def document(path):
    """Where the site has the page `path` of the tree, without a suffix."""
    if path == "README.md":
        return "index"
    if path == INDEX:
        return "all-pages"
    inside = path.removeprefix("docs/").removesuffix(".md")
    return inside.lower() if "/" not in inside else inside


def prose_lines(text):
    """Each line, and whether it is outside of fenced code."""
    fence = ""
    for line in text.splitlines():
        found = FENCE.match(line)
        if fence:
            yield line, False
            if found and found[1].startswith(fence) and line.strip() == found[1]:
                fence = ""
        elif found:
            fence = found[1]
            yield line, False
        else:
            yield line, True


def tree_target(root, page, target):
    """The path in the tree that a link of `page` leads to, or nothing if it is no link into the tree."""
    if re.match(r"\w+:", target) or target.startswith("#"):
        return None
    path = posixpath.normpath(posixpath.join(posixpath.dirname(page), target.split("#")[0]))
    return path if (root / path).exists() else None


def passages(text):
    """The text in pieces: (lines, whether they are prose). A link may go over the end of a line."""
    pieces = []
    for line, prose in prose_lines(text):
        if pieces and pieces[-1][1] == prose:
            pieces[-1][0].append(line)
        else:
            pieces.append(([line], prose))
    return [("\n".join(lines), prose) for lines, prose in pieces]


def links(root, page):
    """(path in the tree, anchor) of each link of a page into the tree."""
    for passage, prose in passages((root / page).read_text()):
        for found in LINK.finditer(passage) if prose else ():
            path = tree_target(root, page, found[2])
            if path:
                yield path, found[2].partition("#")[2]


def page_paths(root):
    """Every page of the site: all of docs/, README, CONTRIBUTING, and Markdown files that these link to."""
    found = ["README.md", "CONTRIBUTING.md"]
    found += sorted(path.relative_to(root).as_posix() for path in (root / "docs").rglob("*.md"))
    for page in found:
        found += [path for path, _ in links(root, page) if path.endswith(".md") and path not in found]
    return found


def sections(root, pages):
    """[(title, [page])] of docs/README.md, each page at its first link. Every page has to be there."""
    result = []
    seen = {"README.md", INDEX}
    passage = "\n".join(piece for piece, prose in passages((root / INDEX).read_text()) if prose)
    for heading in re.split(r"^## +", "\n" + passage, flags=re.M):
        title, _, passage = heading.partition("\n")
        if title:
            result.append((title.strip(), []))
        for found in LINK.finditer(passage):
            path = tree_target(root, INDEX, found[2])
            if path in pages and path not in seen:
                if not result:
                    raise SiteError(
                        f"{INDEX}: '{path}' is linked above the first '## ' heading: put the link below one")
                result[-1][1].append(path)
                seen.add(path)
    missing = [page for page in pages if page not in seen]
    if missing:
        raise SiteError(
            f"{INDEX} has no link to {', '.join(missing)}: add one for each page; it sets the page's "
            "place in the site's navigation")
    return result


class Stage:
    """Collects the staged files: path below the source folder -> bytes."""
    def __init__(self, root, api_pages):
        self.root = root
        self.files = {}
        self.api_pages = api_pages  # path of a header -> its document
        self.pages = page_paths(root)
        self.sections = sections(root, self.pages)
        self.sources = []  # files and folders of the tree that pages link to

    def place(self, path):
        """The staged file that a link to `path` of the tree leads to."""
        if path in self.pages:
            return document(path) + ".md"
        if path in self.api_pages:
            return self.api_pages[path] + ".md"
        if path.endswith(PICTURES):
            name = path.removeprefix("docs/")
            self.files[name] = (self.root / path).read_bytes()
            return name
        if path not in self.sources:
            self.sources.append(path)
        return f"source/{path}.md"

    def rewrite(self, page, text):
        here = posixpath.dirname(document(page))

        def changed(found):
            inner = LINK.sub(changed, found[1][:-2]) + found[1][-2:] if "](" in found[1] else found[1]
            path = tree_target(self.root, page, found[2])
            if not path:
                return inner + found[2] + found[3]
            anchor = found[2].partition("#")[2]
            target = posixpath.relpath(self.place(path), here or ".")
            if page == path and anchor:
                target = ""
            return inner + target + ("#" + anchor if anchor else "") + found[3]

        def header_link(found):
            path = self.api_pages.get(found[1])
            return f"[{found[0]}]({posixpath.relpath(path, here or '.')}.md)" if path else found[0]

        pieces = []
        for piece, prose in passages(text):
            if prose:  # without marks of generators and licences, which are for those who edit the page
                piece = LINK.sub(changed, re.sub(r"^[ \t]*<!--.*-->[ \t]*$\n?", "", piece, flags=re.M))
                piece = HEADER.sub(header_link, piece)
            pieces.append(piece)
        return "\n".join(pieces).strip("\n") + "\n"

    def add_pages(self, more_navigation):
        for page in self.pages:
            text = self.rewrite(page, (self.root / page).read_text())
            if page == "README.md":
                text += "\n" + self.navigation() + more_navigation
            self.files[document(page) + ".md"] = text.encode()
        for path in self.sources:  # grows while folders are listed
            self.files[f"source/{path}.md"] = self.source_page(path).encode()

    def navigation(self):
        blocks = []
        for number, (title, pages) in enumerate(self.sections):
            entries = [document(page) for page in pages] + (["all-pages"] if number == 0 else [])
            blocks.append(toctree(title, entries))
        return "\n".join(blocks)

    def source_page(self, path):
        """A page with a file of the tree, or with the list of a folder's files; not searched."""
        head = f"---\norphan: true\nnosearch: true\n---\n# {path}\n\n"
        if (self.root / path).is_dir():
            names = sorted(
                file.relative_to(self.root / path).as_posix() for file in (self.root / path).rglob("*")
                if file.is_file() and "__pycache__" not in file.parts)
            for name in names:
                self.place(f"{path}/{name}")
            folder = posixpath.basename(path)
            return head + "".join(f"- [{name}]({folder}/{name}.md)\n" for name in names)
        text = (self.root / path).read_text()
        fence = "`" * (max([2, *map(len, re.findall(r"`+", text))]) + 1)
        language = LANGUAGES.get(pathlib.PurePosixPath(path).suffix, "text")
        return f"{head}{fence}{language}\n{text.rstrip()}\n{fence}\n"


def toctree(title, entries):
    return "```{toctree}\n:hidden:\n:caption: " + title + "\n\n" + "\n".join(entries) + "\n```\n"
