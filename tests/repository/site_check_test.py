# The checks of the site see what they are for, on small sites with one fault each.
# SPDX-License-Identifier: Apache-2.0
import pathlib
import tempfile
import unittest

import site_check as check

PAGE = ('<html><body><nav class="sidebar-tree"></nav>'
        '<article><h1 id="{id}">Title</h1>{body}</article></body></html>')
INDEX = ('Search.setIndex({docnames:["index","other"],terms:{"in":0,rotat:[0,1],servo:1},'
         'titleterms:{titl:[0,1]}})')


class SiteChecks(unittest.TestCase):
    def setUp(self):
        self.scratch = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.scratch.name)
        self.addCleanup(self.scratch.cleanup)
        self.write("other.html", '<a href="index.html#top">first</a>')
        (self.folder / "searchindex.js").write_text(INDEX)

    def write(self, name, body, anchor="top"):
        (self.folder / name).parent.mkdir(exist_ok=True)
        (self.folder / name).write_text(PAGE.format(id=anchor, body=body))

    def links(self, body):
        self.write("index.html", body)
        return check.link_faults(self.folder, check.read_site(self.folder))

    def outside(self, body):
        self.write("index.html", body)
        return check.outside_faults(self.folder, check.read_site(self.folder))

    def test_whole(self):
        self.assertEqual(self.links('<a href="other.html#top">x</a> <a href="https://example.org">y</a>'),
                         [])
        self.assertEqual(
            self.outside('<a href="https://example.org">y</a> <link rel="next" href="other.html">'), [])

    def test_dead_links(self):
        self.assertIn("'gone.html' is not there", self.links('<a href="gone.html">x</a>')[0])
        self.assertIn("'p/no.png' is not there", self.links('<img src="p/no.png">')[0])
        self.assertIn("no such place", self.links('<a href="other.html#nowhere">x</a>')[0])
        self.assertIn("no such place", self.links('<a href="#nowhere">x</a>')[0])
        self.assertIn("two places", self.links('<p id="top"></p>')[0])

    def test_other_hosts(self):
        for body in ('<script src="https://cdn.example.org/x.js"></script>',
                     '<img src="//example.org/x.png">',
                     '<link rel="stylesheet" href="http://fonts.example.org/css">',
                     '<script src="/x.js"></script>'):
            self.assertEqual(len(self.outside(body)), 1, body)
        (self.folder /
         "x.css").write_text("@import url(/javascript/normalize.css); a { background: url(gone.png) }")
        self.assertEqual(len(self.outside("")), 2)
        (self.folder / "x.css").write_text("@font-face { src: url('https://fonts.example.org/a.woff2') }")
        (self.folder / "x.js").write_text('import a from "./a.js";\n')
        self.assertEqual(len(self.outside("")), 2)

    def test_reachable(self):
        self.write("index.html", "no link")
        self.assertNotIn("other.html", check.reached(check.read_site(self.folder)))
        self.write("index.html", '<a href="other.html">x</a>')
        self.assertIn("other.html", check.reached(check.read_site(self.folder)))

    def test_navigation(self):
        text = ('<nav class="sidebar-tree"><ul><li><a href="other.html">x</a></li></ul></nav>'
                '<a href="third.html">y</a>')
        self.assertEqual(check.Page(text).navigation, ["other.html"])

    def test_text(self):
        page = check.Page(PAGE.format(id="a", body="vectors of numbers"))
        self.assertEqual(
            check.text_faults("x", page, "vectors [of](where/ever.md) numbers\n<!-- hidden -->\n"), [])
        self.assertIn("'matrix'", check.text_faults("x", page, "vectors<Matrix> of numbers")[0])

    def test_search(self):
        terms = check.search_index(self.folder)
        self.assertEqual(terms, {"index": {"in", "rotat", "titl"}, "other": {"rotat", "servo", "titl"}})
        page = check.Page(PAGE.format(id="a", body="Rotation"))
        self.assertEqual(check.search_faults("x", page, terms["index"]), [])
        self.assertEqual(len(check.search_faults("x", page, {"servo"})), 1)

    def test_paths(self):
        self.write("index.html", "/home/somebody/kaz/docs")
        self.assertEqual(len(check.path_faults(self.folder, "/home/somebody/kaz")), 1)


unittest.main()
