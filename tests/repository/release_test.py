# What `./tools/dev release` makes, in small: of a repository of some files, "built" by copying /bin/true.
# SPDX-License-Identifier: Apache-2.0
"""usage: release_test.py ROOT SCRATCH

The same commit gives the same bytes, in another folder, with another umask, user settings of git, locale and
time zone; a tree with changes is refused, and named; a full disk, a part that was not built and an
interruption leave nothing that looks whole. The archives are read by tar, not by Python."""

import json
import os
import pathlib
import random
import re
import resource
import shutil
import signal
import stat
import subprocess
import sys
import time

ROOT, SCRATCH = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
RELEASE = ROOT / "tools/release/release.py"
COMMITTED = "2021-02-03T04:05:06Z"
CMAKE = """cmake_minimum_required(VERSION 3.25)
project(kaz VERSION 7.8.9 LANGUAGES NONE)
add_custom_command(OUTPUT ${PROJECT_BINARY_DIR}/bin/kaz
  COMMAND ${CMAKE_COMMAND} -E copy /bin/true ${PROJECT_BINARY_DIR}/bin/kaz)
add_custom_command(OUTPUT ${PROJECT_BINARY_DIR}/lib/kaz/ompl_planner.so
  COMMAND ${CMAKE_COMMAND} -E copy /bin/true ${PROJECT_BINARY_DIR}/lib/kaz/ompl_planner.so)
add_custom_target(all_of_it ALL
  DEPENDS ${PROJECT_BINARY_DIR}/bin/kaz ${PROJECT_BINARY_DIR}/lib/kaz/ompl_planner.so)
install(PROGRAMS ${PROJECT_BINARY_DIR}/bin/kaz TYPE BIN)
install(FILES ${PROJECT_BINARY_DIR}/lib/kaz/ompl_planner.so DESTINATION lib/kaz)
install(DIRECTORY data/ DESTINATION share/kaz USE_SOURCE_PERMISSIONS)
"""
LOCK = """{"packages": {"": {}, "node_modules/tool": {"version": "1.0.0", "dev": true, "license": "MIT",
  "integrity": "sha512-%s=="}}}
""" % (
    "A" * 86
)
# As ctest 3.25 writes it.
RESULTS = """<?xml version="1.0" encoding="UTF-8"?>
<testsuite name="Linux-c++" tests="3" failures="0" disabled="0" skipped="1">
  <testcase name="body.Falls" classname="body.Falls" time="0.1" status="run"><system-out/></testcase>
  <testcase name="v4l2" classname="v4l2" time="0.1" status="notrun">
    <skipped message="SKIP_RETURN_CODE=77"/></testcase>
  <testcase name="body.Stands" classname="body.Stands" time="0.1" status="run"><system-out/></testcase>
</testsuite>
"""
FILES = {
    "CMakeLists.txt": CMAKE,
    "tools/packages.txt": "# [build] x\ncmake\n",
    "tools/view/page/package-lock.json": LOCK,
    "CHANGELOG.md": "# Changelog\n\n## [Unreleased]\n\n- a robot that dances\n\n"
    "## [0.1.0] - 2020-01-01\n\n- old\n",
    "data/firmware/kaz.mot": "S0\n",
    "data/firmware/kaz.coff": "coff\n",
    "data/firmware/writer.bin": "writer\n",
    "data/view/index.html": "<!doctype html>\n",
    "data/empty": "",
    "data/a/b": "between\n",
    "data/a.b": "beside\n",
    "data/noise": random.Random(1).randbytes(20_000).hex(),
    ".gitignore": "/build/\n/out/\n",
}
faults = []


def run(*command, **settings):
    return subprocess.run([str(word) for word in command], capture_output=True, text=True, **settings)


def output(*command, **settings):
    done = run(*command, **settings)
    if done.returncode != 0:
        sys.exit(f"{command}: {done.stderr}{done.stdout}")
    return done.stdout


def expect(holds, text):
    if not holds:
        faults.append(text)


def repository(folder):
    environment = {**os.environ, "GIT_AUTHOR_DATE": COMMITTED, "GIT_COMMITTER_DATE": COMMITTED}
    for name, text in FILES.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)
    os.symlink("firmware/kaz.mot", folder / "data/newest")
    output("git", "init", "-q", folder)
    output("git", "-C", folder, "add", "-A")
    output(
        "git",
        "-C",
        folder,
        "-c",
        "user.name=a",
        "-c",
        "user.email=a@b",
        "commit",
        "-qm",
        "all",
        env=environment,
    )


def build(folder):
    output("cmake", "-G", "Ninja", "-S", folder, "-B", folder / "build")
    output("cmake", "--build", folder / "build")


def make_words(folder):
    options = ["--build", folder / "build", "--out", folder / "out/release"]
    return [sys.executable, "-B", RELEASE, "make", folder, *options]


def make(folder, *more, **settings):
    return run(*make_words(folder), *more, **settings)


def left(folder):
    return sorted(path.name for path in (folder / "out").glob("*")) if (folder / "out").exists() else []


def contents(folder):
    return {path.name: path.read_bytes() for path in sorted((folder / "out/release").iterdir())}


def check_equal(here, there):
    """Twice, as different as two machines of the same Debian can be."""
    results = SCRATCH / "results"
    results.mkdir()
    (results / "run-1.xml").write_text(RESULTS)
    done = make(here, "--tests", "passed", "--results", results, cwd="/")
    if done.returncode != 0:
        sys.exit(f"make: {done.stderr}")
    shutil.copytree(here, there, symlinks=True)
    shutil.rmtree(there / "out")
    shutil.rmtree(there / "build")
    for path in there.rglob("*"):
        if not path.is_symlink() and ".git" not in path.parts:
            path.chmod(path.stat().st_mode & ~0o077)
            os.utime(path, (1, 1))
    home = SCRATCH / "home"
    home.mkdir()
    (home / ".gitconfig").write_text(
        "[tar]\n umask = 0077\n[core]\n autocrlf = true\n eol = crlf\n fileMode = false\n"
    )
    environment = {
        **os.environ,
        "HOME": str(home),
        "TZ": "Asia/Tokyo",
        "LC_ALL": "C.UTF-8",
        "GZIP": "-1",
        "SOURCE_DATE_EPOCH": "5",
    }
    previous = os.umask(0o077)
    build(there)
    done = make(there, "--tests", "passed", "--results", results, cwd=there, env=environment)
    os.umask(previous)
    if done.returncode != 0:
        sys.exit(f"make, the second time: {done.stderr}")
    first, second = contents(here), contents(there)
    expect(sorted(first) == sorted(second), f"other files: {sorted(first)}, {sorted(second)}")
    for name in first:
        expect(first[name] == second.get(name), f"{name} has other bytes in another folder")
    return first


def check_contents(folder, files):
    commit = output("git", "-C", folder, "rev-parse", "HEAD")[:12]
    name = f"kaz-7.8.9-{commit}"
    binary = [one for one in files if re.fullmatch(rf"{name}-debian\d+-\w+\.tar\.gz", one)]
    expect(
        sorted(files)
        == sorted(
            [
                f"{name}-source.tar.gz",
                *binary,
                f"{name}-kaz.mot",
                f"{name}-kaz.coff",
                f"{name}-writer.bin",
                f"{name}.spdx.json",
                f"{name}-changes.md",
                f"{name}-release.json",
                "SHA256SUMS",
            ]
        ),
        f"files: {sorted(files)}",
    )
    release = folder / "out/release"
    done = run("sha256sum", "--strict", "-c", "SHA256SUMS", cwd=release)
    expect(done.returncode == 0 and done.stdout.count(": OK") == len(files) - 1, f"SHA256SUMS: {done.stdout}")
    expect(
        (release / f"{name}-changes.md").read_text() == "- a robot that dances\n",
        "changes are not the section",
    )
    facts = json.loads((release / f"{name}-release.json").read_text())
    expect(
        facts["tests"] == {"result": "passed", "passed": 2, "skipped": ["v4l2"]}
        and facts["commit"][:12] == commit,
        f"release.json: {facts}",
    )
    listing = output(
        "tar", "--utc", "-tvzf", release / binary[0], env={**os.environ, "TZ": "UTC0"}
    ).splitlines()
    for line in listing:
        fields = line.split(None, 5)
        expect(
            fields[1] == "root/root" and " ".join(fields[3:5]) == "2021-02-03 04:05", f"owner or time: {line}"
        )
        mode = {"d": "drwxr-xr-x", "l": "lrwxrwxrwx"}.get(
            line[0], "-rwxr-xr-x" if "/bin/" in line else "-rw-r--r--"
        )
        expect(fields[0] == mode, f"mode: {line}")
    names = [line.split(None, 5)[5].split(" -> ")[0].rstrip("/") for line in listing]
    expect(names == sorted(names) and len(set(names)) == len(names), "the binary archive is not sorted")
    expect(f"{name}/share/kaz/empty" in names and f"{name}/bin/kaz" in names, f"lacks files: {names}")
    unpacked = SCRATCH / "unpacked"
    unpacked.mkdir()
    output("tar", "-xzf", release / f"{name}-source.tar.gz", "-C", unpacked)
    for one, text in FILES.items():
        expect((unpacked / name / one).read_text() == text, f"the source archive has another {one}")
        expect(
            stat.S_IMODE((unpacked / name / one).stat().st_mode) & 0o644 == 0o644,
            f"mode of {one} in the sources",
        )
    output("tar", "-xzf", release / binary[0], "-C", unpacked)
    expect(run(unpacked / name / "bin/kaz").returncode == 0, "the program of the binary archive does not run")


def check_refusals(folder):
    before = contents(folder)

    def refused(what, done, *words):
        text = done.stdout + done.stderr
        expect(
            done.returncode not in (0, None) and all(word in text for word in words),
            f"{what}: ended with {done.returncode}, and printed: {text}",
        )
        expect("Traceback" not in text, f"{what}: a traceback")
        expect(left(folder) == ["release"] and contents(folder) == before, f"{what}: leaves {left(folder)}")

    (folder / "data/a.b").write_text("changed\n")
    (folder / "new file").write_text("new\n")
    refused("a dirty tree", make(folder), "data/a.b", "new file", "commit, stash or remove")
    refused("a dirty tree, checked", run(sys.executable, "-B", RELEASE, "check", folder), "data/a.b")
    (folder / "new file").unlink()
    output("git", "-C", folder, "checkout", "-q", "data/a.b")
    refused(
        "a full disk",
        make(folder, preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))),
        "File too large",
    )
    page = folder / "data/view/index.html"
    output("git", "-C", folder, "mv", page, folder / "data/page")
    environment = {**os.environ, "GIT_AUTHOR_DATE": COMMITTED, "GIT_COMMITTER_DATE": COMMITTED}
    commit = ("git", "-C", folder, "-c", "user.name=a", "-c", "user.email=a@b", "commit", "-q", "-m", "x")
    output(*commit, env=environment)
    refused("a build without the page", make(folder), "share/kaz/view/index.html", "npm")
    output("git", "-C", folder, "reset", "-q", "--hard", "HEAD~1")
    for target in ("/etc/passwd", "../../../elsewhere"):
        os.symlink(target, folder / "data/outside")
        output("git", "-C", folder, "add", "-A")
        output(*commit, env=environment)
        refused("a link that leads out of it", make(folder), "outside", target)
        output("git", "-C", folder, "reset", "-q", "--hard", "HEAD~1")
    output("git", "-C", folder, "tag", "v7.8.9")
    refused("a tag without a section of its own", make(folder), "[7.8.9]")
    output("git", "-C", folder, "tag", "-d", "v7.8.9")
    refused("a tree that has gone on", make(folder, "--name", "7.8.9-0123"), "7.8.9-0123", "begin again")
    refused("no repository", run(sys.executable, "-B", RELEASE, "check", "/"), "a release is made in a clone")
    # Interrupted while it works: the first sign of work is the folder beside.
    for number in (signal.SIGINT, signal.SIGTERM):
        child = subprocess.Popen(
            make_words(folder),
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
        )
        while child.poll() is None and "release.partial" not in left(folder):
            time.sleep(0.001)
        child.send_signal(number)
        printed = child.communicate()
        done = subprocess.CompletedProcess([], child.returncode, *printed)
        refused(f"interrupted by {number.name}", done, "interrupted")


def check_tag(folder):
    """A tag of the version: the name is the version alone."""
    text = FILES["CHANGELOG.md"].replace("## [Unreleased]", "## [Unreleased]\n\n## [7.8.9] - 2021-02-03")
    (folder / "CHANGELOG.md").write_text(text)
    output("git", "-C", folder, "-c", "user.name=a", "-c", "user.email=a@b", "commit", "-qam", "7.8.9")
    output("git", "-C", folder, "tag", "v7.8.9")
    done = make(folder)
    expect(done.returncode == 0, f"make with a tag: {done.stderr}")
    release = folder / "out/release"
    expect(
        (release / "kaz-7.8.9-source.tar.gz").exists(), "a tagged release is not named by its version alone"
    )
    facts = json.loads((release / "kaz-7.8.9-release.json").read_text())
    expect(facts["tests"] == {"result": "not run"} and facts["tag"] == "v7.8.9", f"release.json: {facts}")


def main():
    shutil.rmtree(SCRATCH, ignore_errors=True)
    here = SCRATCH / "here"
    here.mkdir(parents=True)
    repository(here)
    build(here)
    files = check_equal(here, SCRATCH / "there, with a blank")
    check_contents(here, files)
    check_refusals(here)
    check_tag(here)
    print(
        "\n".join(faults)
        if faults
        else "equal bytes twice; refusals and interruptions leave nothing half-written"
    )
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
