# `import kaz` without its compiled module, by another Python than its own, without numpy: one sentence each.
# SPDX-License-Identifier: Apache-2.0
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

import kaz

BUILT = pathlib.Path(kaz.__file__).absolute().parent
TREE = pathlib.Path(kaz.__file__).resolve().parents[2]
THIS = f"{sys.executable} (Python {sys.version_info[0]}.{sys.version_info[1]})"


class Import(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = pathlib.Path(folder.name)
        self.package = self.path / "kaz"
        self.package.mkdir()

    def fill(self, *names):
        for name in names:
            (self.package / name).symlink_to(BUILT / name)

    def sentence(self, code="import kaz", path=None):
        """The last line of what `code` prints; its traceback has one error alone."""
        ran = subprocess.run([sys.executable, "-B", "-c", code], cwd=self.path, text=True,
                             capture_output=True, env={"PYTHONPATH": str(path or self.path)})
        self.assertEqual(ran.returncode, 1)
        self.assertEqual(ran.stderr.count("Traceback"), 1, ran.stderr)
        return ran.stderr.splitlines()[-1]

    def test_not_built(self):
        sources = [path.name for path in BUILT.glob("*.py")]
        self.fill(*sources, "built_for.txt")
        self.assertEqual(
            self.sentence(),
            f"ImportError: kaz's compiled module is not built: run {TREE}/tools/dev build kaz_python, then "
            f"start {(BUILT / 'built_for.txt').read_text().strip()} "
            f"with PYTHONPATH={TREE}/build/release/python")
        # Without a build folder, from the sources.
        self.assertIn(f"{TREE}/tools/dev build kaz_python", self.sentence(path=TREE / "python"))

    def test_another_python(self):
        self.fill(*(path.name for path in BUILT.glob("*.py")))
        (self.package / "_kaz.cpython-39-x86_64-linux-gnu.so").touch()
        self.assertEqual(self.sentence(),
                         "ImportError: kaz is built for Python 3.9, "
                         f"but this program runs on {THIS}: use Python 3.9")
        (self.package / "built_for.txt").write_text("/opt/bin/python3 (Python 3.9)\n")
        self.assertIn("built for /opt/bin/python3 (Python 3.9), but this program runs on", self.sentence())

    def test_no_numpy(self):
        without = "import sys; sys.modules['numpy'] = None; import kaz"
        self.assertEqual(self.sentence(without, BUILT.parent),
                         f"ImportError: kaz needs numpy, but {THIS} has no numpy: "
                         "install numpy for this Python")
        self.fill(*(path.name for path in BUILT.iterdir() if path.name != "built_for.txt"))
        (self.package / "built_for.txt").write_text("/opt/bin/python3 (Python 3.11)\n")
        self.assertIn("use /opt/bin/python3 (Python 3.11), or install numpy", self.sentence(without))

    def test_other_errors_stay_as_they_are(self):
        shutil.copytree(BUILT, self.path / "broken/kaz", symlinks=False,
                        ignore=shutil.ignore_patterns("share", "_kaz*", "__pycache__"))
        for module in BUILT.glob("_kaz*.so"):
            (self.path / "broken/kaz" / module.name).write_bytes(b"no shared object")
        self.assertNotIn("but this program runs on", self.sentence(path=self.path / "broken"))
        self.assertNotIn("not built", self.sentence(path=self.path / "broken"))


if __name__ == "__main__":
    unittest.main()
