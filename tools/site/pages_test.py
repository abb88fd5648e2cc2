# Tests of how pages of a tree are staged: links, navigation, and what is refused.
# SPDX-License-Identifier: Apache-2.0
import pathlib
import tempfile
import unittest

import components
import pages

# Of a tree made for these tests.
DOCS, TOOLS, LINK = "docs", "tools", "/".join(("host", "link.h"))
INDEX = ("# All\n\n## Start\n\n- [Run](tutorial/run.md), [how\n  to](howto/do.md#it)\n\n"
         "## Project\n\n- [us](../CONTRIBUTING.md)\n")


class Pages(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.root = pathlib.Path(scratch.name)
        self.write(
            "README.md",
            "# Kaz\n\n![a robot](docs/pictures/a.png) [all](docs/README.md) [us](CONTRIBUTING.md)\n")
        self.write("CONTRIBUTING.md",
                   f"# Us\n\n[a]({DOCS}/howto/do.md#it) [code]({TOOLS}) [h]({LINK}) `{LINK}`\n")
        self.write("docs/README.md", INDEX)
        self.write(f"{DOCS}/tutorial/run.md",
                   "# Run\n\n<!-- made by x -->\n[x](#run)\n\n```cpp\n[](README.md)\n```\n")
        self.write(f"{DOCS}/howto/do.md",
                   "# Do\n\n## It\n\n[![p](../pictures/a.png)](../tutorial/run.md) <https://a.org>\n")
        self.write("docs/pictures/a.png", "png")
        self.write(f"{TOOLS}/x.py", "# ```python\n")
        self.write(LINK, "// Link.\n")

    def write(self, name, text):
        path = self.root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)

    def staged(self):
        stage = pages.Stage(self.root, {LINK: f"api/include/{LINK}"})
        stage.add_pages("")
        return {name: data.decode() for name, data in stage.files.items()}

    def test_links(self):
        files = self.staged()
        self.assertIn("![a robot](pictures/a.png) [all](all-pages.md) [us](contributing.md)",
                      files["index.md"])
        self.assertIn(f"[a](howto/do.md#it) [code](source/tools.md) [h](api/include/{LINK}.md) "
                      f"[`{LINK}`](api/include/{LINK}.md)",
                      files["contributing.md"])
        self.assertIn("[![p](../pictures/a.png)](../tutorial/run.md)", files["howto/do.md"])
        self.assertEqual(files["tutorial/run.md"], "# Run\n\n[x](#run)\n\n```cpp\n[](README.md)\n```\n")
        self.assertIn("[how\n  to](howto/do.md#it)", files["all-pages.md"])

    def test_sources(self):
        files = self.staged()
        self.assertIn(f"- [x.py]({TOOLS}/x.py.md)", files["source/tools.md"])
        self.assertIn("````python\n# ```python\n````", files[f"source/{TOOLS}/x.py.md"])

    def test_navigation(self):
        index = self.staged()["index.md"]
        self.assertIn(":caption: Start\n\ntutorial/run\nhowto/do\nall-pages\n```", index)
        self.assertIn(":caption: Project\n\ncontributing\n```", index)

    def test_forgotten_page(self):
        self.write(f"{DOCS}/results/new.md", "# New\n")
        with self.assertRaisesRegex(pages.SiteError,
                                    f"{DOCS}/README.md has no link to {DOCS}/results/new.md"):
            self.staged()


class Components(unittest.TestCase):
    def test_tree(self):
        root = pathlib.Path(__file__).resolve().parents[2]
        headers = components.public_headers(root)
        self.assertIn("host/robot/robot.h", headers["host"])
        self.assertIn("sim/h8s/chip/chip.h", headers["h8s"])
        self.assertIn("shared/base/result.hpp", headers["base"])
        self.assertFalse(
            [path for paths in headers.values() for path in paths if path.endswith("_testing.h")])
        self.assertEqual(sorted(name for name, paths in headers.items() if not paths), [])


unittest.main()
