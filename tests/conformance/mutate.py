# Plants small faults, one at a time, in copies of shared/ and firmware/, builds each mutant, and shows that
# the conformance suite turns red.
# SPDX-License-Identifier: Apache-2.0
"""A mutant is a file, a piece of code that stands there once, and what stands there instead."""

import argparse
import concurrent.futures
import json
import pathlib
import re
import shutil
import subprocess
import sys


def failed_cases(text):
    return re.findall(r"^failed +([^\s:]+)", text, re.M)


def command(arguments, **options):
    return subprocess.run(arguments, capture_output=True, text=True, errors="replace", **options)


class Mutants:
    def __init__(self, config, root, out):
        self.config = config
        self.root = root
        self.out = out
        self.healthy_failures = set()

    def plant(self, mutation, folder):
        """Copies the sources and makes the one change."""
        for name in ("shared", "firmware"):
            shutil.copytree(self.root / name, folder / name, dirs_exist_ok=True,
                            ignore=shutil.ignore_patterns("robot", "*.cpp"))
        path = folder / mutation["file"]
        text = path.read_text()
        if text.count(mutation["old"]) != 1:
            raise RuntimeError(f"{mutation['file']} holds '{mutation['old']}' "
                               f"{text.count(mutation['old'])} times, not once: adapt mutations.json")
        path.write_text(text.replace(mutation["old"], mutation["new"]))

    def build_native(self, folder):
        objects = []
        for source in self.config["sources"]:
            target = folder / (source.replace("/", "_") + ".o")
            built = command([self.config["cc"], "-std=c99", "-O1", "-w", f"-I{folder}",
                             f"-I{self.config['generated']}", "-c", str(folder / "shared" / source),
                             "-o", str(target)])
            if built.returncode:
                raise RuntimeError("does not compile: " + built.stderr.strip().splitlines()[0])
            objects.append(str(target))
        program = folder / "suite"
        linked = command([self.config["cxx"], "-o", str(program), self.config["runner"], *objects,
                          "-Wl,--start-group", *self.config["libraries"], "-Wl,--end-group"])
        if linked.returncode:
            raise RuntimeError("does not link: " + linked.stderr.strip().splitlines()[-1])
        return [str(program)]

    def build_h8(self, folder):
        """As the build makes the image, from the copy."""
        listed = command([self.config["ninja"], "-C", self.config["build"], "-t", "commands",
                          self.config["image"]])
        built_in = str(pathlib.Path(self.config["build"]) / "firmware")
        (folder / "out" / "kaz.objects").mkdir(parents=True, exist_ok=True)
        for line in listed.stdout.splitlines():
            if built_in not in line:
                continue
            line = line.replace(built_in, str(folder / "out"))
            for name in ("shared", "firmware"):
                line = line.replace(f"{self.root}/{name}", f"{folder}/{name}")
            line = line.replace(f"-I{self.root} ", f"-I{folder} ")
            made = command(line, shell=True, cwd=self.config["build"])
            if made.returncode:
                raise RuntimeError("does not build: " + (made.stdout + made.stderr).strip()[-300:])
        return [self.config["kaz"], "conformance", "--virtual", "h8", "--image",
                str(folder / "out" / "kaz.mot")]

    def kill(self, mutation):
        """(killed, what the suite said)"""
        folder = self.out / mutation["id"]
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        try:
            self.plant(mutation, folder)
            build = self.build_h8 if mutation.get("engine") == "h8" else self.build_native
            program = build(folder)
        except RuntimeError as wrong:
            return None, str(wrong)
        try:
            ran = command(program, timeout=300)
        except subprocess.TimeoutExpired:
            return True, "the suite does not end"
        finally:
            shutil.rmtree(folder, ignore_errors=True)
        failed = [name for name in failed_cases(ran.stdout) if name not in self.healthy_failures]
        if failed:
            return True, f"{len(failed)} cases, first {failed[0]}"
        if ran.returncode not in (0, 1) or "cases" not in ran.stdout:
            return True, ran.stderr.strip().splitlines()[-1] if ran.stderr.strip() else "ended early"
        return False, "every case passed"


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("config", type=pathlib.Path, help="mutants.config.json of the build")
    parser.add_argument("--only", default="", help="regular expression on ids")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--despite-failures", action="store_true",
                        help="the sound code may fail cases too; a mutant must fail others")
    options = parser.parse_args()
    config = json.loads(options.config.read_text())
    root = pathlib.Path(config["root"])
    mutations = json.loads((root / "tests/conformance/mutations.json").read_text())
    if len({one["id"] for one in mutations}) != len(mutations):
        sys.exit("mutations.json: an id stands twice")
    chosen = [one for one in mutations if re.search(options.only, one["id"])]
    if not chosen:
        sys.exit(f"--only {options.only}: no such mutation")
    mutants = Mutants(config, root, pathlib.Path(config["build"]) / "mutants")

    # What is not mutated must pass, or red means nothing.
    healthy = command([config["whole"]])
    mutants.healthy_failures.update(failed_cases(healthy.stdout))
    if healthy.returncode and not options.despite_failures:
        sys.exit("the suite fails without any mutation:\n" + healthy.stdout[-2000:])

    alive = 0
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        for mutation, (killed, text) in zip(chosen, pool.map(mutants.kill, chosen)):
            word = {True: "killed", False: "ALIVE", None: "WRONG"}[killed]
            print(f"{word:8} {mutation['id']:28} {text}", flush=True)
            alive += killed is not True
    print(f"{len(chosen) - alive} of {len(chosen)} mutants turn the suite red")
    sys.exit(1 if alive else 0)


main()
