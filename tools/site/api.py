# Pages of the API reference, from the comments and declarations of the public headers: one page for each
# header, one for each component, and one with all names.
# SPDX-License-Identifier: Apache-2.0
import html
import posixpath
import re

import components
import declarations
import pages

INTERNAL = re.compile(r"\bInternal\b")
FILE_NAME = re.compile(r"(?<![\w/.])([\w/-]+\.(?:h|hpp|md))\b")


def document(header):
    return f"api/include/{header}"


def escaped(text):
    """A comment's text as Markdown: only `code` and names of files keep a meaning."""
    parts = re.split(r"(`[^`]+`)", text)
    return "".join(part if part.startswith("`") and len(part) > 1 else re.
                   sub(r"([\\`*_{}\[\]<>#|~$&])", r"\\\1", part) for part in parts)


class Prose:
    """Turns comments into Markdown: paragraphs, lists, and lines whose columns matter as they are."""
    def __init__(self, header, documents):
        self.header = header
        self.documents = documents

    def linked(self, text):
        """Names of other public headers, and of pages, become links."""
        def link(found):
            beside = posixpath.join(posixpath.dirname(self.header), found[1])
            for path in (found[1], beside):
                if path in self.documents and path != self.header:
                    target = posixpath.relpath(self.documents[path],
                                               posixpath.dirname(document(self.header)))
                    return f"[{found[0]}]({target}.md)"
            return found[0]

        # Names in code marks lose them where they become links.
        text = re.sub(r"`([\w/-]+\.(?:h|hpp|md))`", r"\1", text)
        parts = re.split(r"(`[^`]+`)", text)
        return "".join(part if part.startswith("`") else FILE_NAME.sub(link, part).
                       replace("\\_", "_") if FILE_NAME.search(part) else part for part in parts)

    def paragraph(self, lines):
        text = " ".join(line.strip() for line in lines)
        marked = FILE_NAME.sub(lambda found: found[0].replace("_", "\0"), text)
        text = self.linked(escaped(marked).replace("\0", "_"))
        return re.sub(r"^(\d+)([.)])", r"\1\\\2", re.sub(r"^([-+=])", r"\\\1", text))

    def markdown(self, lines):
        blocks = []  # (kind, lines)
        for line in lines:
            kind = "text"
            if not line.strip():
                kind = "empty"
            elif re.match(r"^\s{0,3}(-|\d{1,2}[.)]) +\S", line):
                kind = "item"
            elif blocks and blocks[-1][0] == "item" and line.startswith(" "):
                blocks[-1][1].append(line)
                continue
            elif re.match(r"^\s{2,}\S", line) or (re.search(r"\S {3,}\S", line)):
                kind = "code"
            if blocks and blocks[-1][0] == kind and kind in ("text", "code"):
                blocks[-1][1].append(line)
            else:
                blocks.append((kind, [line]))
        out = []
        for kind, block in blocks:
            if kind == "text":
                out.append("\n" + self.paragraph(block) + "\n")
            elif kind == "code":
                out.append("\n```text\n" + declarations.dedented(block) + "\n```\n")
            elif kind == "item":
                found = re.match(r"^\s*(-|\d+[.)]) +(.*)$", block[0])
                item = self.paragraph([found[2], *block[1:]])
                if not out or not out[-1].startswith(("- ", "1. ")):
                    out.append("")
                out.append(("- " if found[1] == "-" else "1. ") + item)
        return re.sub(r"\n{3,}", "\n\n", "\n".join(out)).strip("\n") + "\n" if out else ""


def anchors(names):
    return "".join(f'<a id="{html.escape(name, quote=True)}"></a>' for name in names)


class HeaderPage:
    def __init__(self, header, component, text, documents):
        self.header = header
        self.component = component
        self.prose = Prose(header, documents)
        self.top, self.items = declarations.read_header(text)
        self.names = []  # (name, anchor) for the page of all names
        self.used = set()

    def summary(self):
        """The first line of the header, for the page of its component."""
        text = escaped(self.top[0]) if self.top else ""
        return text

    def take(self, names, owner):
        """Anchors for names that have none on this page yet."""
        new = []
        for name in names:
            if not re.fullmatch(r"\w+", name) or name == owner.split("::")[-1]:
                continue
            anchor = f"{owner}::{name}" if owner else name
            if anchor not in self.used:
                self.used.add(anchor)
                new.append(anchor)
                self.names.append((anchor, anchor))
        return new

    def block(self, item, owner):
        marks = anchors(self.take(item.names, owner))
        text = self.prose.markdown(item.text)
        return f"{marks}\n\n{text}\n```cpp\n{item.code}\n```\n"

    def render(self, items, level, owner=""):
        out = []
        for item in items:
            if item.kind == "section":
                out.append(f"{'#' * level} {escaped(item.name)}\n")
            elif item.kind == "text":
                out.append(self.prose.markdown(item.text))
            elif item.kind == "code":
                out.append(self.block(item, owner))
            elif level == 2 and item.name:
                out.append(
                    f"{anchors(self.take([item.name], owner))}\n\n## {item.word} {escaped(item.name)}\n")
                out.append(self.block(item, item.name))
                out.append(self.render(item.members, 3, item.name))
            else:  # within another type, or without a name
                inner = f"{owner}::{item.name}".strip(":")
                out.append(anchors(self.take([item.name], owner)) + "\n")
                out.append(self.block(item, inner))
                out.append(self.render(item.members, level, inner))
        return "\n".join(out)

    def page(self):
        up = posixpath.relpath("api/" + self.component, posixpath.dirname(document(self.header)))
        head = (f"---\norphan: true\n---\n# {escaped(self.header)}\n\n"
                f"```cpp\n#include \"{self.header}\"\n```\n\nComponent [{self.component}]({up}.md).\n\n")
        return head + self.prose.markdown(self.top) + "\n" + self.render(self.items, 2)


def component_table(root):
    """{component: row of the table in docs/reference/libraries.md}: what it is, as Markdown."""
    text = (root / components.TABLE).read_text()
    return dict(re.findall(r"^\| `(\w+)` \| [^|]*\| ([^|]*?) *\|", text, re.M))


def headers(root):
    """{component: [header]} without those that call themselves internal."""
    return {
        component: [path for path in paths if not INTERNAL.search((root / path).open().readline())]
        for component, paths in components.public_headers(root).items()
    }


def documents(root):
    return {path: document(path) for paths in headers(root).values() for path in paths}


def add_pages(stage):
    """Stages the API pages; returns the Markdown that puts them into the navigation."""
    described = component_table(stage.root)
    described["base"] = "what all components include: errors, time, files"
    grouped = {component: paths for component, paths in headers(stage.root).items() if paths}
    linked = {**stage.api_pages, **{page: pages.document(page) for page in stage.pages}}
    found = {
        path: HeaderPage(path, component, (stage.root / path).read_text(), linked)
        for component, paths in grouped.items() for path in paths
    }
    for path, page in found.items():
        stage.files[document(path) + ".md"] = page.page().encode()
    rows = []
    for component, paths in grouped.items():
        if component not in described:
            raise pages.SiteError(
                f"component '{component}' has no row in the table of {components.TABLE}: add it")
        what = stage.rewrite(components.TABLE,
                             described[component]).strip().replace("](", "](../reference/")
        what = what.replace("../reference/../", "../")
        text = f"# {component}\n\n{what[0].upper()}{what[1:]}.\n"
        for folder in dict.fromkeys(posixpath.dirname(path) for path in paths):
            text += f"\n## {folder}\n\n| header | content |\n|---|---|\n"
            for path in paths:
                if posixpath.dirname(path) == folder:
                    text += f"| [{posixpath.basename(path)}](include/{path}.md) | {found[path].summary()} |\n"
        stage.files[f"api/{component}.md"] = text.encode()
        rows.append(f"| [{component}]({component}.md) | {what} | {len(paths)} |\n")
    stage.files["api/overview.md"] = (
        "# API: public headers\n\nEach component of the [installed package](../reference/libraries.md), its "
        "headers, their comments and declarations. Private parts, bodies of functions, and headers that call "
        "themselves internal are left out. [All names](names.md)\n\n"
        "| component | description | headers |\n|---|---|---|\n" + "".join(rows)).encode()
    stage.files["api/names.md"] = names_page(found).encode()
    return pages.toctree("API",
                         ["api/overview", *(f"api/{component}" for component in grouped), "api/names"])


def names_page(found):
    """All names with links, by first letter. HTML: a Markdown link per name would take Sphinx a minute."""
    names = sorted(((name, path, anchor) for path, page in found.items() for name, anchor in page.names),
                   key=lambda entry: (entry[0].lower(), entry[1]))
    out = ["---\nnosearch: true\n---\n# All names\n"]
    letter = ""
    for name, path, anchor in names:
        if name[0].upper() != letter:
            if letter:
                out.append("</ul>\n")
            letter = name[0].upper()
            out.append(f"## {letter}\n\n<ul class=\"api-names\">")
        out.append(
            f'<li><a href="include/{path}.html#{html.escape(anchor, quote=True)}">{html.escape(name)}</a> '
            f"<span>{path}</span></li>")
    out.append("</ul>\n")
    return "\n".join(out)
