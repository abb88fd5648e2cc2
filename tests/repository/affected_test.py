# `./tools/dev check`: which tests depend on a file.
# SPDX-License-Identifier: Apache-2.0
"""usage: affected_test.py ROOT BUILD"""

import pathlib
import subprocess
import sys
import unittest

BUILD = pathlib.Path(sys.argv.pop(2))
ROOT = pathlib.Path(sys.argv.pop(1))


class Affected(unittest.TestCase):
    def run_list(self, *arguments):
        program = ROOT / "tools/repo/affected.py"
        return subprocess.run([sys.executable, "-B", program, "--build", BUILD, "--list", *arguments],
                              capture_output=True, text=True)

    def labels(self, *arguments):
        listed = self.run_list(*arguments)
        self.assertEqual(listed.returncode, 0, listed.stderr)
        return [name.partition(".")[0] for name in listed.stdout.splitlines()[1:]]

    def test_programs_that_are_linked_with_a_file_and_that_start_kaz(self):
        labels = set(self.labels("--all", "host/behavior/options.cpp"))
        self.assertLessEqual({"behavior", "tools", "catching", "cli", "navigate"}, labels)
        self.assertFalse({"h8s", "vision", "link"} & labels)

    def test_the_tests_of_a_test_file(self):
        labels = self.labels("--all", "tests/system/command_line/navigate_test.cpp")
        self.assertEqual(set(labels), {"navigate"})

    def test_the_file_s_own_come_first(self):
        labels = self.labels("--all", "host/behavior/options.cpp")
        last_own = len(labels) - labels[::-1].index("behavior")
        self.assertLess(last_own, labels.index("cli"))

    def test_files_without_tests_are_refused(self):
        for file, sentence in (("none.cpp", "none.cpp is not a file of this tree"),
                               ("README.md", "README.md: no target compiles this file")):
            refused = self.run_list(file)
            self.assertEqual(refused.returncode, 2, file)
            self.assertIn(sentence, refused.stderr)


unittest.main()
