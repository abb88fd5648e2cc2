# The prose check fails on sentences that our pages once had, and passes what they became.
# SPDX-License-Identifier: Apache-2.0
"""usage: prose_test.py [-v]"""

import pathlib
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import prose  # noqa: E402

BROKEN = (
    "Of damaged notes the name says what they are of.",
    "what one module sees of a frame is of that frame and no other",
    "No ball that it draws is of the size of one to catch.",
    "An error for a name that there is none of.",
    "Why the targets were refused the state may tell better.",
    "Its `result.json` is of the others and is marked as that of an interrupted evaluation",
    "Of a robot at a port nobody knows the true pose",
    "of each robot the worst of the 41, of which 95 % of the robots are below",
    "That `serve-port` obeys who connects is its documented purpose.",
    "Who does not look has no eyes",
    "--goal is of navigate: track-ball has no goal; leave the option out",
    "Whoever hears what a recording gets while the run goes on.",
    "That so many bytes fit shows that the disk is not full.",
    "30.3 thousand million instructions",
    "Notes say nothing of which board they are of but its port; (design, section 3).",
)
GOOD = (
    "If the file is damaged, identify it by its name.",
    "A module's inputs always belong to one frame.",
    "Distractor balls never have the target ball's radius.",
    "Returns an error for an unknown module name.",
    "The status reply often explains the refusal better.",
    "Returns Fault::usage if a file is not a run recording.",
    "Host code does not depend on the board side of the serial line.",
    "`result.json` covers the completed episodes and contains `\"interrupted\": true`.",
    "The true pose of a real robot is unknown.",
    "95th percentile over robots of the worst of 41 joint errors",
    "`serve-port` is unauthenticated by design.",
    "Cameras are created on first use",
    "--goal is only valid with navigate",
    "Observer of the messages written to the recording.",
    "A successful write of this size rules out ENOSPC.",
    "3.03e10 instructions",
    "What does it cost?",
    "That is why the board brakes.",
)


def page_of(*lengths):
    return "\n\n".join(" ".join(["Word"] + ["word"] * (length - 1)) + "." for length in lengths) + "\n"


def check_page(text):
    return prose.check("p", prose.blocks(text))


class ProseTest(unittest.TestCase):
    def test_broken_sentences_are_found(self):
        for sentence in BROKEN:
            self.assertTrue(prose.broken_rules(sentence), sentence)

    def test_good_sentences_pass(self):
        for sentence in GOOD:
            self.assertEqual(prose.broken_rules(sentence), [], sentence)

    def test_lengths(self):
        self.assertEqual(check_page(page_of(*[16] * 19, 25))[0], [])
        self.assertIn("50 %", check_page(page_of(*[17] * 20))[0][0])
        self.assertIn("95 %", check_page(page_of(*[10] * 18, 26, 26))[0][0])
        self.assertIn("41 words", check_page(page_of(*[10] * 30, 41))[0][0])

    def test_code_is_not_prose(self):
        page = ("Run it:\n\n```sh\nOf code: what is of it\n```\n\n    Of indented code\n\n"
                "- One item.\n\n  Its end.\n")
        self.assertEqual(check_page(page)[0], [])

    def test_each_place_is_read(self):
        for page in ("- Of an item\n", "## What it does\n", "A line\nthat goes on. Of it\n",
                     "| a | Of a cell |\n|---|---|\n",
                     "1. A step:\n   Good. Of it\n", "See [of it](x.md). Of [this](y.md).\n"):
            self.assertEqual(len(check_page(page)[0]), 1, page)

    def test_comments_are_read(self):
        for source in ("// Of it.\n", "int a;  // of it\n", "// A line\n// that goes on. Of it\nint a;\n",
                       "// - An item.\n//   What it is.\n", "/// Who reads this.\n"):
            self.assertEqual(len(prose.check("h", prose.comments(source))[0]), 1, source)
        for source in ("// A table:\n//   of what\n", 'auto a = "// of it";\n', "// SPDX-Id: of it\n",
                       "// One.\nint a;\n// two of it\n"):
            self.assertEqual(prose.check("h", prose.comments(source))[0], [], source)

    def test_messages_are_read(self):
        for source in ('f("Of it and more");\n', 'f("what was read " + a);\n', 'R"(Of raw text.)";\n',
                       'f("It is "\n  "of another kind");\n',
                       'f("of the board.\\nWho reads this?\\nWho reads this text");\n'):
            self.assertEqual(len(prose.check("m", prose.messages(source))[0]), 1, source)
        for source in ('f(a + " of link `" + b);\n', '// "Of a comment in quotes"\n', 'f("of it");\n',
                       '#include "of/what/it is.h"\n'):
            self.assertEqual(prose.check("m", prose.messages(source))[0], [], source)
        number, text, _ = next(prose.messages('a;\nf("a",\n  "one two "\n  "three");\n'))
        self.assertEqual((number, text), (3, "one two three"))

    def test_spelling(self):
        path = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory())) / "page.md"
        path.write_text("The behaviour of gray colors.\n")
        self.assertEqual(len(prose.misspelled([path])), 1)
        path.write_text("The behavior of gray colors.\n")
        self.assertEqual(prose.misspelled([path]), [])
        path = path.with_suffix(".cpp")
        path.write_text('// The behaviour.\nf("the behavior of it");\n')
        self.assertEqual(prose.misspelled([path]), [])
        path.write_text('f("the behaviour of it");\n')
        self.assertEqual(len(prose.misspelled([path])), 2)


if __name__ == "__main__":
    unittest.main()
