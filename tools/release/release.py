# What `./tools/dev release` leaves in out/release: archives, firmware, bill of materials, changes, checksums.
# SPDX-License-Identifier: Apache-2.0
"""usage: release.py check ROOT
       release.py make ROOT --build BUILD --out OUT [--name NAME] [--tests TEXT]
                       [--results FOLDER]

check: is this a commit that can be released? Prints its name: the version, where a tag v<version> is at the
commit, else version and commit. make: writes the files beside OUT and renames them to OUT when all are there.
NAME is what check printed before the build: a tree that has gone on since is refused. FOLDER has run-*.xml of
ctest (JUnit's form): how many tests passed, and which were skipped for want of something on this machine."""

import argparse
import json
import pathlib
import platform
import re
import shutil
import signal
import subprocess
import sys
import time
from xml.etree import ElementTree

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
from archives import Refused, archive_commit, archive_folder, sums  # noqa: E402

# What an installation lacks silently if a package was missing when it was built, and that package.
PARTS = {
    "bin/kaz": "nothing: the build has no program",
    "share/kaz/firmware/kaz.mot": "gcc-h8300-hms and binutils-h8300-hms",
    "share/kaz/firmware/kaz.coff": "gcc-h8300-hms and binutils-h8300-hms",
    "share/kaz/firmware/writer.bin": "gcc-h8300-hms and binutils-h8300-hms",
    "share/kaz/view/index.html": "npm, and the network once",
    "lib/kaz/ompl_planner.so": "libompl-dev",
}
FIRMWARE = ("kaz.mot", "kaz.coff", "writer.bin")


def git(root, *arguments):
    done = subprocess.run(["git", "-C", str(root), *arguments], capture_output=True, text=True)
    if done.returncode != 0:
        raise Refused(
            f"git {arguments[0]} in {root}: {done.stderr.strip() or 'failed'}; a release is made in a clone"
        )
    return done.stdout


def version_of(root):
    found = re.search(r"^project\(kaz VERSION ([0-9.]+)", (root / "CMakeLists.txt").read_text(), re.M)
    if not found:
        raise Refused(f"{root}/CMakeLists.txt: no project(kaz VERSION ...)")
    return found[1]


def section_of(root, title):
    """The text below '## [title]' of CHANGELOG.md, or nothing."""
    text = (root / "CHANGELOG.md").read_text()
    found = re.search(rf"^## \[{re.escape(title)}\][^\n]*\n(.*?)(?=^## |\Z)", text, re.M | re.S)
    return found[1].strip() if found else ""


class Commit:
    """The commit in a clean tree."""

    def __init__(self, root):
        self.root = root
        dirty = git(root, "status", "--porcelain", "--untracked-files=normal")
        if dirty:
            lines = dirty.splitlines()
            more = [f"  and {len(lines) - 20} more"] if len(lines) > 20 else []
            raise Refused(
                "\n".join(
                    [
                        f"{root} has changes that are in no commit; commit, stash or remove them:",
                        *(f"  {line}" for line in lines[:20]),
                        *more,
                    ]
                )
            )
        self.id = git(root, "rev-parse", "HEAD").strip()
        self.seconds = int(git(root, "log", "-1", "--format=%ct").strip())
        self.version = version_of(root)
        self.tag = (
            f"v{self.version}"
            if f"v{self.version}" in git(root, "tag", "--points-at", "HEAD").split()
            else None
        )
        self.name = self.version if self.tag else f"{self.version}-{self.id[:12]}"
        title = self.version if self.tag else "Unreleased"
        self.changes = section_of(root, title)
        if self.tag and not self.changes:
            raise Refused(
                f"CHANGELOG.md has no section [{title}] for the tag {self.tag}: rename [Unreleased]"
            )


def system_name():
    """As debian12-amd64: whose libraries the program needs."""
    facts = dict(
        re.findall(r'^(ID|VERSION_ID)="?([^"\n]*)"?$', pathlib.Path("/etc/os-release").read_text(), re.M)
    )
    machine = {"x86_64": "amd64", "aarch64": "arm64"}.get(platform.machine(), platform.machine())
    return f"{facts.get('ID', 'linux')}{facts.get('VERSION_ID', '')}-{machine}"


def install(build, prefix):
    done = subprocess.run(
        ["cmake", "--install", str(build), "--prefix", str(prefix)], capture_output=True, text=True
    )
    if done.returncode != 0:
        raise Refused(
            f"cmake --install {build} ended with {done.returncode}; ./tools/dev build first, and is the "
            f"disk full?\n{done.stderr.strip()}"
        )
    for part, package in PARTS.items():
        if not (prefix / part).is_file():
            raise Refused(f"{build} was built without {part}; a release has it. It needs {package}")


def bill_of_materials(commit, build, installed, target):
    command = [
        sys.executable,
        "-B",
        str(HERE.parent / "gen/sbom.py"),
        str(commit.root),
        "--installed",
        str(installed),
        "--build",
        str(build),
        "--name",
        commit.name,
        "--time",
        str(commit.seconds),
        "--out",
        str(target),
        "--notices",
        str(installed / "share/doc/kaz/third-party"),
    ]
    if subprocess.run(command).returncode != 0:
        raise Refused("there is no bill of materials (above)")


def test_facts(text, folder):
    """What release.json says of the tests: TEXT, and what ctest's files in `folder` have."""
    facts = {"result": text}
    passed, skipped = 0, []
    files = sorted(folder.glob("run-*.xml")) if folder else []
    for path in files:
        for case in ElementTree.parse(path).iter("testcase"):
            if case.find("skipped") is not None:
                skipped.append(case.get("name"))
            elif case.get("status") == "run":
                passed += 1
    return facts | ({"passed": passed, "skipped": sorted(skipped)} if files else {})


def make(commit, build, partial, tests):
    say = lambda text: print(f"== release: {text}", flush=True)  # noqa: E731
    name = f"kaz-{commit.name}"
    partial.mkdir(parents=True)
    say("source archive")
    archive_commit(commit.root, commit.id, partial / f"{name}-source.tar.gz", name)
    say("installing")
    installed = partial / "installed"
    install(build, installed)
    for image in FIRMWARE:
        shutil.copyfile(installed / "share/kaz/firmware" / image, partial / f"{name}-{image}")
    say("bill of materials")
    bill_of_materials(commit, build, installed, partial / f"{name}.spdx.json")
    say("binary archive")
    archive_folder(installed, partial / f"{name}-{system_name()}.tar.gz", name, commit.seconds)
    shutil.rmtree(installed)
    (partial / f"{name}-changes.md").write_text(commit.changes + "\n")
    facts = {
        "name": commit.name,
        "version": commit.version,
        "tag": commit.tag,
        "commit": commit.id,
        "committed": time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime(commit.seconds)),
        "tests": tests,
    }
    (partial / f"{name}-release.json").write_text(json.dumps(facts, indent=2) + "\n")
    (partial / "SHA256SUMS").write_text(sums(partial))


def interrupted(*_):
    raise KeyboardInterrupt


def main():
    parser = argparse.ArgumentParser(usage=__doc__.removeprefix("usage: "))
    parser.add_argument("verb", choices=("check", "make"))
    parser.add_argument("root", type=pathlib.Path)
    parser.add_argument("--build", type=pathlib.Path)
    parser.add_argument("--out", type=pathlib.Path)
    parser.add_argument("--name")
    parser.add_argument("--tests", default="not run")
    parser.add_argument("--results", type=pathlib.Path)
    given = parser.parse_args()
    if given.verb == "make" and not (given.build and given.out):
        parser.error("make needs --build and --out")
    signal.signal(signal.SIGTERM, interrupted)
    try:
        commit = Commit(given.root.resolve())
        if given.verb == "check":
            print(commit.name)
            return 0
        if given.name not in (None, commit.name):
            raise Refused(
                f"{commit.root} is at {commit.name} by now, and {given.name} was built; begin again"
            )
        out = given.out.absolute()
        partial, old = out.with_name(out.name + ".partial"), out.with_name(out.name + ".old")
        shutil.rmtree(partial, ignore_errors=True)  # of a run that was killed
        try:
            make(commit, given.build.resolve(), partial, test_facts(given.tests, given.results))
            shutil.rmtree(old, ignore_errors=True)
            if out.exists():
                out.rename(old)
            partial.rename(out)
            shutil.rmtree(old, ignore_errors=True)
        finally:
            shutil.rmtree(partial, ignore_errors=True)
    except (Refused, OSError) as error:
        print(f"release: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("release: interrupted; nothing is left of it", file=sys.stderr)
        return 130
    print(f"== release: {commit.name} in {given.out}; tests: {given.tests}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
