# Findings are reported and kept, also when the run is interrupted at the same time; time is CPU time.
# SPDX-License-Identifier: Apache-2.0
import importlib.util
import json
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import time
import unittest

HANG_S = 600  # of a busy machine
RUN = pathlib.Path(__file__).with_name("run.py")

# In place of libFuzzer's program of a target: {crashes} is Python for when it finds something.
PROGRAM = """#!{python}
import pathlib, signal, sys, time
prefix = next(word.split("=", 1)[1] for word in sys.argv if word.startswith("-artifact_prefix="))
def crash(*_):
    pathlib.Path(prefix + "crash-0123").write_bytes(b"x")
    print("the stack", flush=True)
    sys.exit(77)
signal.signal(signal.SIGINT, {on_interrupt})
pathlib.Path(prefix + "runs").touch()
while True:
    if pathlib.Path(prefix + "go").exists():
        crash()
    time.sleep(0.01)
"""

# Uses 0.6 s of CPU time, however long it may run, as a target does beside other programs.
SLOWED = """#!{python}
import pathlib, sys, time
prefix = next(word.split("=", 1)[1] for word in sys.argv if word.startswith("-artifact_prefix="))
with pathlib.Path(prefix + "starts").open("a") as starts:
    starts.write(next(word for word in sys.argv if word.startswith("-max_total_time=")) + "\\n")
while time.process_time() < 0.6:
    pass
"""

# Works until it is stopped as libFuzzer's programs are.
BUSY = """#!{python}
import pathlib, signal, sys
prefix = next(word.split("=", 1)[1] for word in sys.argv if word.startswith("-artifact_prefix="))
with pathlib.Path(prefix + "starts").open("a") as starts:
    starts.write("x")
signal.signal(signal.SIGUSR1, lambda *_: (print("stat::number_of_executed_units: 70"), sys.exit(0)))
while True:
    pass
"""
QUIET = "lambda *_: sys.exit(72)"


class Runs(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.build, self.out = pathlib.Path(folder.name, "build"), pathlib.Path(folder.name, "out")
        (self.build / "bin").mkdir(parents=True)
        for target, on_interrupt in (("image", QUIET), ("chip", "crash"), ("gdb", QUIET)):
            program = self.build / "bin" / f"h8s_fuzz_{target}"
            program.write_text(PROGRAM.format(python=sys.executable, on_interrupt=on_interrupt))
            program.chmod(0o755)

    def start(self, names):
        run = subprocess.Popen([sys.executable, "-B", RUN, "600", "--only", ",".join(names), "--jobs", "3",
                                "--build", self.build, "--out", self.out], stdout=subprocess.PIPE, text=True)
        end = time.monotonic() + HANG_S
        while not all((self.out / f"{name}-runs").exists() for name in names) and time.monotonic() < end:
            time.sleep(0.01)
        return run

    def test_what_ends_with_the_interruption_is_found(self):
        run = self.start(["image", "chip", "gdb"])
        (self.out / "image-go").touch()
        time.sleep(0.05)  # it has ended, and run.py may not know yet
        run.send_signal(signal.SIGINT)
        text, _ = run.communicate(timeout=HANG_S)
        self.assertEqual(run.returncode, 1, text)
        self.assertIn("found something: ", text)
        for name in ("image", "chip"):
            self.assertRegex(text, rf"found something: .*\b{name}\b")
            self.assertTrue((self.out / f"{name}-crash-0123").exists())
            logs = list(self.out.glob(f"{name}-found-*.log"))
            self.assertEqual(len(logs), 1, logs)
            self.assertIn("the stack", logs[0].read_text())
        self.assertNotRegex(text, r"found something: .*\bgdb\b")

    def test_nothing_found(self):
        run = self.start(["gdb"])
        run.send_signal(signal.SIGTERM)
        text, _ = run.communicate(timeout=HANG_S)
        self.assertEqual(run.returncode, 130, text)

    def test_goes_on_until_its_cpu_time_is_used(self):
        text = self.run_gdb(SLOWED, "2")
        self.assertEqual(len((self.out / "gdb-starts").read_text().split()), 2)
        self.assertRegex(text, r"(?m)^\[ 0/1\] gdb .*goes on$")
        self.assertRegex(text, r"(?m)^\[ 1/1\] gdb .*nothing found$")

    def test_has_its_time_once_in_each_version(self):
        text = self.run_gdb(BUSY, "--each", "1")
        self.assertRegex(text, r"(?m)^\[ 1/1\] gdb .* 70 runs .*nothing found$")
        runs = self.out / "runs.jsonl"
        self.assertGreaterEqual(sum(json.loads(run)["cpu_s"] for run in runs.read_text().splitlines()), 1)
        self.assertIn("1 have had it", self.run_gdb(BUSY, "--each", "1"))
        self.assertEqual((self.out / "gdb-starts").read_text(), "x")
        self.assertRegex(self.run_gdb(BUSY, "--each", "1", "--status"), r"gdb +\w{8} CPU +[1-9].* 70 runs")
        # More time: the rest of it.
        self.assertRegex(self.run_gdb(BUSY, "--each", "3"), r"(?m)^\[ 1/1\] gdb .*CPU +[12] s .*g found$")
        self.assertEqual((self.out / "gdb-starts").read_text(), "xx")
        runs.write_text(re.sub(r'"version": "\w+"', '"version": "other"', runs.read_text()))
        self.assertIn("0 have had it", self.run_gdb(BUSY, "--each", "1"))
        self.assertEqual((self.out / "gdb-starts").read_text(), "xxx")

    def run_gdb(self, program, *words):
        (self.build / "bin/h8s_fuzz_gdb").write_text(program.format(python=sys.executable))
        run = subprocess.run([sys.executable, "-B", RUN, *words, "--only", "gdb", "--jobs", "1",
                              "--build", self.build, "--out", self.out],
                             stdout=subprocess.PIPE, text=True, timeout=HANG_S)
        self.assertEqual(run.returncode, 0, run.stdout)
        return run.stdout


class Versions(unittest.TestCase):
    def code(self, text):
        spec = importlib.util.spec_from_file_location("run", RUN)
        run = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(run)
        with tempfile.NamedTemporaryFile("w", suffix=".cpp") as file:
            file.write(text)
            file.flush()
            return run.code(pathlib.Path(file.name))

    def test_comments_and_messages_are_not_code(self):
        one = self.code('if (c == \'"\' && n > 1\'000) fail("not a \\"key\\"" + key); // a comment\n')
        other = self.code('if (c == \'"\' && n > 1\'000)\n  fail(\n "an unknown "\n "key " + key);\n')
        self.assertEqual(one, other)

    def test_other_texts_are_code(self):
        for text in ('key == "torque"', 'text == R"(two words)"', "n > 1'000", "c == 'x'",
                     'f("not a key", key)'):
            other = text.replace("torque", "speed").replace("two", "too").replace("000", "001")
            other = other.replace("'x'", "'y'").replace(", key", ", name")
            self.assertNotEqual(self.code(text), self.code(other), text)


if __name__ == "__main__":
    unittest.main()
