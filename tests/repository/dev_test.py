# `./tools/dev`, with programs that only write down how they were called in place of cmake and kaz.
# SPDX-License-Identifier: Apache-2.0
"""usage: dev_test.py ROOT"""

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(sys.argv.pop(1))
HANG_S = 1200  # of a busy machine

# Configures and builds nothing. The target kaz_product takes until the robot runs, or for long.
CMAKE = """#!/bin/sh
echo "cmake $*" >>"$CALLS"
case "$*" in
  --preset*) mkdir -p build/release/bin; touch build/release/build.ninja
    cp "$PROGRAM" build/release/bin/kaz; cp "$PROGRAM" build/release/bin/joint_loop_trials ;;
  *kaz_product*) echo $$ >product.pid; exec $PRODUCT ;;
esac
"""
# Begins once the product is being built, and fails where FAILS names its first words.
PROGRAM = """#!/bin/sh
echo "$(basename "$0") $*" >>"$CALLS"
case "$*" in
  run*) for i in $(seq 100); do [ -e product.pid ] && break; sleep 0.1; done; [ -e product.pid ] || exit 9 ;;
  conformance*) echo "487 passed" ;;
esac
case "$*" in "${FAILS:-none}"*) exit 1 ;; esac
"""


class Dev(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = pathlib.Path(folder.name)
        self.tree = self.path / "tree"
        (self.tree / "tools").mkdir(parents=True)
        (self.tree / "build").mkdir()
        shutil.copy(ROOT / "tools/dev", self.tree / "tools/dev")
        (self.tree / "tools/packages.txt").touch()
        for name, text in {"cmake": CMAKE, "program": PROGRAM, "dpkg-query": "#!/bin/sh\n"}.items():
            program = self.path / "bin" / name
            program.parent.mkdir(exist_ok=True)
            program.write_text(text)
            program.chmod(0o755)

    def dev(self, *arguments, tree=None, **environment):
        """Runs it; returns (status, standard error, the calls of cmake, kaz and the trials)."""
        calls = self.path / "calls"
        calls.write_text("")
        (self.tree / "product.pid").unlink(missing_ok=True)
        ran = subprocess.run(
            [(tree or self.tree) / "tools/dev", *arguments], capture_output=True, text=True, timeout=HANG_S,
            env={"PATH": f"{self.path / 'bin'}:/usr/bin:/bin", "CALLS": str(calls), "KAZ_JOBS": "2",
                 "PROGRAM": str(self.path / "bin/program"), "PRODUCT": "true", **environment})
        if "opencv-doc are left out" in ran.stderr:
            self.skipTest("without the photographs of opencv-doc tools/dev builds nothing")
        return ran.returncode, ran.stderr, calls.read_text().splitlines()

    def made_in(self, folder):
        (self.tree / "build/release").mkdir(exist_ok=True)
        (self.tree / "build/release/CMakeCache.txt").write_text(f"CMAKE_CACHEFILE_DIR:INTERNAL={folder}\n")

    def test_a_tree_that_was_moved_names_the_command(self):
        other = self.path / "other/build/release"
        other.mkdir(parents=True)  # a copy: the first tree is still there
        for made_in in (self.path / "gone/build/release", other):
            self.made_in(made_in)
            for verb in ("build", "demo", "prove"):
                (self.tree / "build/release/build.ninja").touch()
                status, error, calls = self.dev(verb)
                self.assertEqual((status, calls), (1, []), verb)
                self.assertIn(f"build/release was made as {made_in}, ", error)
                self.assertTrue(error.endswith(": ./tools/dev clean\n"), error)

    def test_a_tree_that_was_not_moved_is_built(self):
        link = self.path / "link"
        link.symlink_to(self.tree)
        for made_in in (self.tree, link):
            for called in (self.tree, link):
                self.made_in(made_in / "build/release")
                self.assertEqual(self.dev("build", "kaz_page", tree=called)[0::2],
                                 (0, ["cmake --preset release",
                                      "cmake --build --preset release -j 2 --target kaz_page"]))

    def test_demo_builds_page_and_module_while_the_robot_runs(self):
        status, error, calls = self.dev("demo", "--seed", "7", PRODUCT="sleep 1")
        self.assertEqual((status, error), (0, ""))
        product = "cmake --build --preset release -j 2 --target kaz_product"
        self.assertIn(product, calls)
        calls.remove(product)  # it begins when it gets the processor
        self.assertEqual(calls, [
            "cmake --preset release", "cmake --build --preset release -j 2 --target kaz",
            "kaz run catch-ball --world catch --eyes real --imu --out out/demo --seed 7",
            "kaz demo --out out/demo/track"])
        status, error, _ = self.dev("demo", PRODUCT="false")
        self.assertEqual(status, 1)
        self.assertTrue(error.endswith(" is done. Build them with: ./tools/dev build kaz_product\n"), error)

    def test_nothing_is_built_on_behind_a_demo_that_failed(self):
        status, error, _ = self.dev("demo", FAILS="run catch-ball", PRODUCT="sleep 1000")
        self.assertEqual(status, 1)
        self.assertIn("the ball was not caught", error)
        with self.assertRaises(ProcessLookupError):
            os.kill(int((self.tree / "product.pid").read_text()), 0)

    def test_prove(self):
        proofs = ["kaz mcu compare --ticks 20000", "joint_loop_trials --trials 500000",
                  "kaz conformance --virtual native"]
        build = "cmake --build --preset release -j 2 --target kaz joint_loop_trials"
        self.assertEqual(self.dev("prove")[0::2], (0, ["cmake --preset release", build, *proofs]))
        # Built once, ninja alone looks for what has changed.
        self.assertEqual(self.dev("prove", "--seed", "7")[0::2],
                         (0, [build, "kaz mcu compare --seed 7", *proofs[1:]]))
        for n, fails in enumerate(("mcu", "--trials", "conformance")):
            status, _, calls = self.dev("prove", FAILS=fails)
            self.assertEqual((status, calls), (1, [build, *proofs[:n + 1]]))


class CommitMessage(unittest.TestCase):
    def check(self, message):
        with tempfile.NamedTemporaryFile("w") as file:
            file.write(message)
            file.flush()
            ran = subprocess.run([ROOT / "tools/commit-msg", file.name], capture_output=True, text=True)
        return ran.returncode, ran.stderr

    def test_accepted(self):
        for message in ("h8s: Count wait states\n\nMemory tests ran 4 % too fast.\n", "Revert \"h8s: X\"\n",
                        "docs, cli: Shorten\n\n# comment\nRead by three people.\n\nSigned-off-by: A\n"):
            self.assertEqual(self.check(message), (0, ""), message)

    def test_rejected(self):
        for message, reason in (("h8s: Count\n", "body is missing"),
                                ("h8s: Count\n\n# why\nSigned-off-by: A\n", "body is missing"),
                                ("h8s: Count\nbody\n\nmore\n", "second line"),
                                ("h8s: Count.\n\nWhy.\n", "period"),
                                ("count states\n\nWhy.\n", "area: Imperative"),
                                ("h8s: count\n\nWhy.\n", "area: Imperative"),
                                (f"h8s: C{'o' * 67}\n\nWhy.\n", "73 characters")):
            status, error = self.check(message)
            self.assertEqual(status, 1, message)
            self.assertIn(reason, error)


if __name__ == "__main__":
    unittest.main()
