# Tests of `./tools/dev release` with a small repository whose program is /bin/true.
# SPDX-License-Identifier: Apache-2.0
"""usage: release_test.py ROOT SCRATCH

The same commit gives the same bytes in another folder, with another umask and other settings of git.
Changes, a missing part, a full disk and an interruption leave nothing that looks complete."""

import os
import pathlib
import resource
import shutil
import signal
import subprocess
import sys
import time

ROOT, SCRATCH = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
RELEASE = ROOT / "tools/repo/release.sh"
CMAKE = """cmake_minimum_required(VERSION 3.25)
project(kaz VERSION 7.8.9 LANGUAGES NONE)
install(PROGRAMS /bin/true DESTINATION bin RENAME kaz)
install(PROGRAMS /bin/true DESTINATION lib/kaz RENAME ompl_planner.so)
install(PROGRAMS /bin/true DESTINATION lib/kaz RENAME world_reader.so)
install(DIRECTORY data/ DESTINATION share/kaz USE_SOURCE_PERMISSIONS)
"""
FILES = {
    "CMakeLists.txt": CMAKE,
    "tools/packages.txt": "# [build] x\ncmake\n\n# [run] y\n",
    "CHANGELOG.md": "# Changelog\n\n## [Unreleased]\n\n- a robot that dances\n\n"
                    "## [0.1.0] - 2020-01-01\n\n- old\n",
    "data/firmware/kaz.mot": "S0\n",
    "data/firmware/kaz.coff": "coff\n",
    "data/firmware/writer.bin": "writer\n",
    "data/view/index.html": "<!doctype html>\n",
    "data/noise": "x" * 100_000,
    ".gitignore": "/build/\n/out/\n",
}
PARTS = ("source.tar.gz", "kaz.mot", "kaz.coff", "writer.bin", "changes.md")
faults = []


def expect(holds, text):
    if not holds:
        faults.append(text)


def git(folder, *words):
    date = {"GIT_AUTHOR_DATE": "2021-02-03T04:05:06Z", "GIT_COMMITTER_DATE": "2021-02-03T04:05:06Z"}
    subprocess.run(["git", "-C", folder, "-c", "user.name=a", "-c", "user.email=a@b", *words],
                   env={**os.environ, **date}, check=True, stdout=subprocess.DEVNULL)


def release(folder, out="out/release", **settings):
    return subprocess.run([RELEASE, "build", out], cwd=folder, capture_output=True, text=True,
                          **settings)


def repository(folder):
    for name, text in FILES.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)
    git(folder, "init", "-q")
    git(folder, "add", "-A")
    git(folder, "commit", "-qm", "all")


def build(folder):
    subprocess.run(["cmake", "-S", folder, "-B", folder / "build"], check=True, stdout=subprocess.DEVNULL)


def contents(folder):
    return {path.name: path.read_bytes() for path in sorted((folder / "out/release").iterdir())}


def check_contents(folder, files):
    name = "kaz-7.8.9-" + subprocess.run(["git", "-C", folder, "rev-parse", "--short=12", "HEAD"], text=True,
                                         capture_output=True).stdout.strip()
    binary = [one for one in files if one.endswith(".tar.gz") and "source" not in one]
    wanted = [*(f"{name}-{part}" for part in PARTS), *binary, f"{name}.spdx", "SHA256SUMS"]
    expect(sorted(files) == sorted(wanted), f"files: {sorted(files)}")
    summed = subprocess.run(["sha256sum", "--strict", "-c", "SHA256SUMS"], cwd=folder / "out/release",
                            capture_output=True, text=True)
    expect(summed.returncode == 0 and summed.stdout.count(": OK") == len(files) - 1, f"sums: {summed.stdout}")
    expect(files[f"{name}-changes.md"] == b"- a robot that dances\n", "changes are not the section")
    expect(b"FileName: ./CMakeLists.txt" in files[f"{name}.spdx"], "the SPDX file lists no source")
    listing = subprocess.run(["tar", "--utc", "-tvzf", folder / "out/release" / binary[0]],
                             capture_output=True, text=True).stdout.splitlines()
    for line in listing:
        fields = line.split(None, 5)
        mode = "-rwxr-xr-x" if line.endswith(("/bin/kaz", ".so")) else "-rw-r--r--"
        mode = "drwxr-xr-x" if line[0] == "d" else mode
        expect(fields[0] == mode and fields[1] == "root/root", line)
        expect(fields[3:5] == ["2021-02-03", "04:05"], line)
    source = folder / "out/release" / f"{name}-source.tar.gz"
    subprocess.run(["tar", "-xzf", source, "-C", SCRATCH], check=True)
    for one, text in FILES.items():
        expect((SCRATCH / name / one).read_text() == text, f"the source archive has another {one}")


def check_refusals(folder):
    before = contents(folder)

    def refused(what, done, *words):
        text = done.stdout + done.stderr
        complete = all(word in text for word in words)
        expect(done.returncode != 0 and complete, f"{what}: {done.returncode}, {text}")
        names = [path.name for path in (folder / "out").iterdir()]
        expect(names == ["release"] and contents(folder) == before, f"{what}: output changed: {names}")

    (folder / "data/noise").write_text("changed\n")
    (folder / "new").write_text("new\n")
    refused("a changed tree", release(folder), "data/noise", "new", "commit, stash or remove")
    (folder / "new").unlink()
    git(folder, "checkout", "-q", "data/noise")
    refused("a folder of the user's", release(folder, "data"), "data exists and is not a release")
    expect((folder / "data/noise").exists(), "a folder of the user's was deleted")
    limit = lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))  # noqa: E731
    refused("a full disk", release(folder, preexec_fn=limit))
    git(folder, "mv", "data/view/index.html", "data/page")
    git(folder, "commit", "-qm", "x")
    refused("a build without the page", release(folder), "share/kaz/view/index.html")
    git(folder, "reset", "-q", "--hard", "HEAD~1")
    git(folder, "tag", "v7.8.9")
    refused("a tag without a section", release(folder), "[7.8.9]")
    git(folder, "tag", "-d", "v7.8.9")
    for number in (signal.SIGINT, signal.SIGTERM):
        child = subprocess.Popen([RELEASE, "build", "out/release"], cwd=folder, stdout=subprocess.DEVNULL,
                                 stderr=subprocess.DEVNULL, start_new_session=True)
        while child.poll() is None and not (folder / "out/release.partial").exists():
            time.sleep(0.001)
        os.killpg(child.pid, number)
        refused(f"interrupted by {number.name}", subprocess.CompletedProcess([], child.wait(), "", ""))


def check_tag(folder):
    """With a tag of the version, the name is the version."""
    text = FILES["CHANGELOG.md"].replace("## [Unreleased]", "## [Unreleased]\n\n## [7.8.9] - 2021-02-03")
    (folder / "CHANGELOG.md").write_text(text)
    git(folder, "commit", "-qam", "7.8.9")
    git(folder, "tag", "v7.8.9")
    done = release(folder)
    expect(done.returncode == 0 and "kaz-7.8.9-changes.md" in contents(folder), f"a tag: {done.stderr}")


def main():
    shutil.rmtree(SCRATCH, ignore_errors=True)
    here, there = SCRATCH / "here", SCRATCH / "there, with a blank"
    here.mkdir(parents=True)
    repository(here)
    build(here)
    done = release(here)
    if done.returncode != 0:
        sys.exit(f"release: {done.stderr}")
    subprocess.run(["git", "clone", "-q", here, there], check=True)
    home = SCRATCH / "home"
    home.mkdir()
    (home / ".gitconfig").write_text("[tar]\n umask = 0077\n[core]\n autocrlf = true\n eol = crlf\n")
    build(there)
    other = {"HOME": str(home), "TZ": "Asia/Tokyo", "GZIP": "-1"}
    done = release(there, umask=0o077, env={**os.environ, **other})
    expect(done.returncode == 0, f"release in another folder: {done.stderr}")
    files = contents(here)
    if not faults:
        for name, content in contents(there).items():
            expect(files.get(name) == content, f"{name} has other bytes in another folder")
    check_contents(here, files)
    check_refusals(here)
    check_tag(here)
    print("\n".join(faults) or "equal bytes twice; refusals and interruptions leave nothing half-written")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
