# Findings are reported and kept, also when the run is interrupted at the same time; time is CPU time.
# SPDX-License-Identifier: Apache-2.0
import pathlib
import signal
import subprocess
import sys
import tempfile
import time
import unittest

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
        end = time.monotonic() + 30
        while not all((self.out / f"{name}-runs").exists() for name in names) and time.monotonic() < end:
            time.sleep(0.01)
        return run

    def test_what_ends_with_the_interruption_is_found(self):
        run = self.start(["image", "chip", "gdb"])
        (self.out / "image-go").touch()
        time.sleep(0.05)  # it has ended, and run.py may not know yet
        run.send_signal(signal.SIGINT)
        text, _ = run.communicate(timeout=30)
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
        text, _ = run.communicate(timeout=30)
        self.assertEqual(run.returncode, 130, text)

    def test_goes_on_until_its_cpu_time_is_used(self):
        (self.build / "bin/h8s_fuzz_gdb").write_text(SLOWED.format(python=sys.executable))
        run = subprocess.run([sys.executable, "-B", RUN, "2", "--only", "gdb", "--jobs", "1",
                              "--build", self.build, "--out", self.out],
                             stdout=subprocess.PIPE, text=True, timeout=60)
        self.assertEqual(run.returncode, 0, run.stdout)
        self.assertEqual((self.out / "gdb-starts").read_text().split(), ["-max_total_time=2"] * 2)
        self.assertRegex(run.stdout, r"(?m)^\[ 0/1\] gdb .*goes on$")
        self.assertRegex(run.stdout, r"(?m)^\[ 1/1\] gdb .*nothing found$")


if __name__ == "__main__":
    unittest.main()
