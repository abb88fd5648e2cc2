# Plants small faults, one at a time, in copies of shared/ and firmware/, builds each mutant, and shows that
# a check of the project fails on it.
# SPDX-License-Identifier: Apache-2.0
"""A mutation is a file, a piece of code that stands there once, and what stands there instead. It names the
judges that may kill it; they are tried in the order of their cost, and the first that fails ends the search.

A mutant of shared/ is the native engine with that fault, one of firmware/ a firmware image. Judges:
  joint_loop   joint_loop_trials: a faulty joint_loop.c against the image, a faulty joint_loop.S against the C
  unit         the unit tests of shared/
  firmware     the unit tests of firmware/ on the image
  compare      the image against the native engine, as kaz mcu compare
  conformance  the conformance suite on the engine that has the fault
A mutation with a reason under `equivalent` changes nothing that can be seen: every judge must pass on it."""

import argparse
import collections
import concurrent.futures
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import threading

JOINT_LOOP_TRIALS = 200_000
COMPARE_TICKS = 5_000
# Costs of a tick are no fault, and power cuts look at nothing that is mutated here.
FIRMWARE_TESTS = "-*WalkingLoad*:WorstTick.*:Flash.PowerLost*"
# By cost; that of a judge includes what has to be built for it alone.
NATIVE_JUDGES = ("joint_loop", "conformance", "unit")
IMAGE_JUDGES = ("joint_loop", "firmware", "compare", "conformance")


class CannotBeMade(Exception):
    pass


class Unhealthy(Exception):
    pass


def command(arguments, **options):
    return subprocess.run(arguments, capture_output=True, text=True, errors="replace", timeout=300, **options)


def failed_cases(text):
    return re.findall(r"^failed +([^\s:]+)", text, re.M)


def last_line(text):
    lines = text.strip().splitlines()
    return lines[-1] if lines else ""


class Mutants:
    def __init__(self, config, out, compare_ticks, despite_failures):
        self.config = config
        self.despite_failures = despite_failures
        self.lock = threading.Lock()
        self.passed = set()
        self.root = pathlib.Path(config["root"])
        self.build = pathlib.Path(config["build"])
        self.out = out
        self.compare_ticks = compare_ticks
        self.healthy_failures = {"native": set(), "h8": set()}
        self.image_steps = []
        self.suite_libraries = []

    # What is built.

    def plant(self, mutation, folder):
        """Copies the sources and makes the one change."""
        for name in ("shared", "firmware"):
            shutil.copytree(self.root / name, folder / name, dirs_exist_ok=True,
                            ignore=shutil.ignore_patterns("robot", "*.cpp"))
        path = folder / mutation["file"]
        text = path.read_text()
        if text.count(mutation["old"]) != 1:
            raise CannotBeMade(f"{mutation['file']} holds '{mutation['old']}' "
                               f"{text.count(mutation['old'])} times, not once: adapt mutations.json")
        path.write_text(text.replace(mutation["old"], mutation["new"]))

    def compile_native(self, folder, source, target, *options):
        made = command([self.config["cc"], "-std=c99", "-O1", "-w", *options, f"-I{folder}",
                        f"-I{self.config['generated']}", str(folder / source), "-o", str(target)])
        if made.returncode:
            raise CannotBeMade("does not compile: " + made.stderr.strip().splitlines()[0])

    def native_objects(self, mutation, folder):
        """Objects of what the fault changes; the rest comes from the libraries of the build."""
        name = mutation["file"].removeprefix("shared/")
        sources = [name] if name.endswith(".c") else self.config["sources"]
        objects = []
        for source in sources:
            target = folder / (source.replace("/", "_") + ".o")
            if not target.exists():
                self.compile_native(folder, f"shared/{source}", target, "-c")
            objects.append(str(target))
        return objects

    def link_native(self, mutation, folder, name, objects, libraries):
        program = folder / name
        linked = command([self.config["cxx"], "-o", str(program), *objects,
                          *self.native_objects(mutation, folder),
                          "-Wl,--start-group", *libraries, "-Wl,--end-group"])
        if linked.returncode:
            raise CannotBeMade("does not link: " + last_line(linked.stderr))
        return str(program)

    def read_suite_libraries(self):
        """What the build links the suite with: of a library that is compiled in groups of sources, all."""
        listed = command([self.config["ninja"], "-C", str(self.build), "-t", "commands",
                          os.path.relpath(self.config["whole"], self.build)])
        last = listed.stdout.strip().splitlines()[-1]
        arguments = last[last.index(" -o "):].split(" && ")[0].split()[2:]
        self.suite_libraries = [word if word.startswith(("-l", "/")) else str(self.build / word)
                                for word in arguments]

    def read_image_steps(self):
        """How the build makes the image, a command for each object and those for the whole."""
        listed = command([self.config["ninja"], "-C", str(self.build), "-t", "commands",
                          self.config["image"]])
        built_in = str(self.build / "firmware")
        self.image_steps = [line for line in listed.stdout.splitlines() if built_in in line]

    def build_image(self, mutation, folder):
        """As the build makes it, from the copy; objects that do not depend on the changed file are reused."""
        built_in, here = str(self.build / "firmware"), str(folder / "out")
        shutil.copytree(self.build / "firmware/kaz.objects", folder / "out/kaz.objects")
        changed = f"{self.root}/{mutation['file']}"
        for line in self.image_steps:
            compiled = re.search(r" -c \S+ -o (\S+\.o)\b", line)
            if compiled:
                dependencies = pathlib.Path(compiled[1] + ".d").read_text().split()
                if changed not in dependencies:
                    continue
            elif "kaz.coff" not in line:
                continue
            line = line.replace(built_in, here)
            for name in ("shared", "firmware"):
                line = line.replace(f"{self.root}/{name}", f"{folder}/{name}")
            line = line.replace(f"-I{self.root} ", f"-I{folder} ")
            # The report on sizes and stack is no part of the image.
            line = " && ".join(part for part in line.split(" && ") if "firmware_report.py" not in part)
            made = command(line, shell=True, cwd=self.build)
            if made.returncode:
                raise CannotBeMade("does not build: " + (made.stdout + made.stderr).strip()[-300:])
        return folder / "out/kaz"

    # Judges: None if all passed, else what failed.

    def conformance(self, mutation, folder, image):
        if image:
            side, program = "h8", [self.config["image_suite"], f"{image}.mot"]
        elif mutation:
            side, program = "native", [self.link_native(mutation, folder, "suite", [self.config["runner"]],
                                                        self.suite_libraries)]
        else:
            side, program = "native", [self.config["whole"]]
        ran = command(program)
        failed = [name for name in failed_cases(ran.stdout) if name not in self.healthy_failures[side]]
        if not mutation:
            self.healthy_failures[side].update(failed)
        if failed:
            return f"{len(failed)} cases, first {failed[0]}"
        if ran.returncode not in (0, 1) or "cases" not in ran.stdout:
            return last_line(ran.stderr) or "ended early"
        return None

    def unit(self, mutation, folder, _):
        program = self.config["unit"]
        if mutation:
            program = self.link_native(mutation, folder, "unit", self.config["unit_objects"],
                                       self.config["unit_libraries"])
        return self.google_test([program], self.root)

    def firmware(self, _, __, image):
        return self.google_test([self.config["firmware_test"], f"--gtest_filter={FIRMWARE_TESTS}"], self.root,
                                env={**os.environ, "KAZ_TEST_IMAGE": f"{image}.coff"})

    @staticmethod
    def google_test(program, folder, **options):
        ran = command([*program, "--gtest_brief=1"], cwd=folder, **options)
        failed = re.findall(r"^\[  FAILED  \] (\S+?),? \(", ran.stdout, re.M)
        if ran.returncode == 0:
            return None
        return f"{len(failed)} tests, first {failed[0]}" if failed else f"status {ran.returncode}"

    def joint_loop(self, mutation, folder, image):
        program = [self.config["joint_loop"], "--no-coverage", "--trials", str(JOINT_LOOP_TRIALS)]
        if image:
            program += ["--image", f"{image}.coff"]
        elif mutation:
            library = folder / "joint_loop.so"
            self.compile_native(folder, "shared/servo/joint_loop.c", library, "-shared", "-fPIC")
            program += ["--native", str(library)]
        ran = command(program)
        if ran.returncode == 0:
            return None
        if ran.returncode in (2, 3):
            raise CannotBeMade(last_line(ran.stderr))
        return ran.stdout.strip().splitlines()[0] if ran.stdout.strip() else f"status {ran.returncode}"

    def compare(self, _, __, image):
        ran = command([self.config["image_suite"], f"{image}.mot", "--compare", str(self.compare_ticks)])
        if ran.returncode == 0:
            return None
        if ran.returncode in (2, 3):
            raise CannotBeMade(last_line(ran.stderr))
        text = (ran.stdout + ran.stderr).strip().splitlines()
        field = re.search(r"^ +((?:output|state|pins)\.\S+)", ran.stdout, re.M)
        if field:
            return f"{text[0].rstrip(':')}, {field[1]}"
        return text[0] if text else f"status {ran.returncode}"

    # One mutant.

    def judges_of(self, mutation):
        named = mutation.get("judges", ["conformance"])
        order = IMAGE_JUDGES if mutation["file"].startswith("firmware/") else NATIVE_JUDGES
        unknown = [name for name in named if name not in order]
        if unknown:
            raise CannotBeMade(f"no judge {unknown[0]} for {mutation['file']}")
        return [name for name in order if name in named]

    def kill(self, mutation):
        """(word, judge, what it said)"""
        folder = self.out / mutation["id"]
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        try:
            judges = self.judges_of(mutation)
            self.plant(mutation, folder)
            image = self.build_image(mutation, folder) if mutation["file"].startswith("firmware/") else None
            for judge in judges:
                self.assure(judge, "h8" if image else "native")
                try:
                    said = getattr(self, judge)(mutation, folder, image)
                except subprocess.TimeoutExpired:
                    said = "does not end"
                if said is not None:
                    return "WRONG" if "equivalent" in mutation else "killed", judge, said
        except CannotBeMade as wrong:
            return "WRONG", "", str(wrong)
        finally:
            shutil.rmtree(folder, ignore_errors=True)
        if "equivalent" in mutation:
            return "same", "", mutation["equivalent"]
        return "ALIVE", "", "passed " + ", ".join(judges)

    def assure(self, judge, side):
        """What is not mutated must pass, or a failure means nothing. Once, before a judge's first mutant."""
        with self.lock:
            if (judge, side) in self.passed:
                return
            image = self.build / "firmware/kaz" if side == "h8" else None
            said = getattr(self, judge)(None, None, image)
            if said is not None and not (self.despite_failures and judge == "conformance"):
                raise Unhealthy(f"{judge} fails on {side} without any mutation: {said}")
            self.passed.add((judge, side))


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("config", type=pathlib.Path, help="mutants.config.json of the build")
    parser.add_argument("--only", default="", help="regular expression on ids")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--compare-ticks", type=int, default=COMPARE_TICKS)
    parser.add_argument("--despite-failures", action="store_true",
                        help="the healthy code may fail cases too; a mutant must fail others")
    options = parser.parse_args()
    config = json.loads(options.config.read_text())
    mutants = Mutants(config, pathlib.Path(config["build"]) / "mutants", options.compare_ticks,
                      options.despite_failures)
    mutations = json.loads((mutants.root / "tests/integration/conformance/mutations.json").read_text())
    if len({one["id"] for one in mutations}) != len(mutations):
        sys.exit("mutations.json: an id stands twice")
    chosen = [one for one in mutations if re.search(options.only, one["id"])]
    if not chosen:
        sys.exit(f"--only {options.only}: no such mutation")
    if any(one["file"].startswith("firmware/") for one in chosen):
        mutants.read_image_steps()
    if any(one["file"].startswith("shared/") for one in chosen):
        mutants.read_suite_libraries()

    counts = collections.Counter()
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        try:
            for mutation, (word, judge, text) in zip(chosen, pool.map(mutants.kill, chosen)):
                print(f"{word:7} {mutation['id']:28} {judge:12} {text}", flush=True)
                counts[word, judge] += 1
        except Unhealthy as wrong:
            pool.shutdown(cancel_futures=True)
            sys.exit(str(wrong))
    killed = sum(count for (word, _), count in counts.items() if word == "killed")
    same = counts["same", ""]
    by = ", ".join(f"{judge} {counts['killed', judge]}" for judge in ("conformance", "compare", "joint_loop",
                                                                       "unit", "firmware")
                   if counts["killed", judge])
    print(f"{killed} of {len(chosen)} mutants killed ({by}); "
          f"{same} argued equivalent, which no judge contradicts")
    sys.exit(0 if killed + same == len(chosen) else 1)


main()
