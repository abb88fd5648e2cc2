# Configuration of Sphinx for the documentation site; tools/repo/site/build.sh runs it on the tree.
# SPDX-License-Identifier: Apache-2.0
import pathlib
import re

ROOT = pathlib.Path(__file__).resolve().parents[3]

project = "Kaz"
author = "the authors of Kaz"
version = release = re.search(r"project\(kaz VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text())[1]
extensions = ["myst_parser"]
include_patterns = ["*.md", "docs/**", "sim/h8s/README.md"]
root_doc = "README"
myst_heading_anchors = 6
highlight_language = "none"
smartquotes = False  # --view is an option, not a dash
html_theme = "sphinx_rtd_theme"
html_title = f"Kaz {version}"
html_copy_source = False
html_show_search_summary = False  # browsers do not fetch excerpts from file://
html_show_sourcelink = False
html_show_copyright = False


def add_navigation(app, docname, source):
    """Adds the pages that docs/README.md lists, under its headings, and the API. A Git host shows neither."""
    if docname == "docs/README":
        source[0] += '\n## API\n\n<a href="../api/index.html">Public headers</a>: comments and declarations\n'
    if docname != root_doc:
        return
    index = (ROOT / "docs/README.md").read_text()
    for title, links in re.findall(r"^## (.*)\n((?:(?!## ).*\n)*)", index, re.M):
        pages = [f"docs/{page}".replace("docs/../", "") for page in re.findall(r"\]\(([^)#]+)\.md\)", links)]
        if title == "Start":
            pages.append("docs/README")
        entries = "\n".join(pages)
        source[0] += f"\n```{{toctree}}\n:hidden:\n:caption: {title}\n\n{entries}\n```\n"


def add_first_page(app, exception):
    (pathlib.Path(app.outdir) / "index.html").write_text(
        '<!DOCTYPE html><meta http-equiv="refresh" content="0; url=README.html">')


def setup(app):
    app.connect("source-read", add_navigation)
    app.connect("build-finished", add_first_page)
