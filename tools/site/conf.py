# Sphinx's configuration of the documentation's site; tools/site/build.py runs it over what it has staged.
# SPDX-License-Identifier: Apache-2.0
import os

project = "Kaz"
author = "the authors of Kaz"
version = release = os.environ["KAZ_SITE_VERSION"]
extensions = ["myst_parser"]
myst_heading_anchors = 6  # anchors of headings as a Git host makes them, so that the pages' links hold
root_doc = "index"
source_suffix = {".md": "markdown"}
highlight_language = "none"  # blocks without a language are mostly commands; guessing gives warnings
pygments_style = "default"
pygments_dark_style = "github-dark"

smartquotes = False  # --view is an option, not a dash

html_theme = "furo"
html_title = f"Kaz {version}"
html_static_path = [os.environ["KAZ_SITE_STATIC"]]
html_css_files = ["site.css"]
html_copy_source = False
html_show_sourcelink = False
html_show_copyright = False
html_domain_indices = False
html_use_index = False
html_baseurl = ""
html_theme_options = {
    "light_css_variables": {"color-brand-primary": "#0b5394", "color-brand-content": "#0b5394"},
    "dark_css_variables": {"color-brand-primary": "#7db7f0", "color-brand-content": "#7db7f0"},
}
