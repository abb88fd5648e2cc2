# The papers of the house agree with the code: changelog, versions, security, citation, CI.
# SPDX-License-Identifier: Apache-2.0
"""usage: papers.py ROOT     (needs python3-yaml: run by /usr/bin/python3)"""

import datetime
import os
import pathlib
import re
import sys

ROOT = pathlib.Path(sys.argv[1])
faults = []


def fault(path, text):
    faults.append(f"{path}: {text}")


def read(name):
    return (ROOT / name).read_text()


def version():
    return re.search(r"^project\(kaz VERSION ([0-9]+\.[0-9]+\.[0-9]+)", read("CMakeLists.txt"), re.M)[1]


KINDS = {"Added", "Changed", "Deprecated", "Removed", "Fixed", "Security"}


def check_changelog():
    """Keep a Changelog 1.1.0: [Unreleased] first, then versions with dates, newest first; its kinds."""
    name, text = "CHANGELOG.md", read("CHANGELOG.md")
    titles = re.findall(r"^## (.*)$", text, re.M)
    if not titles or titles[0] != "[Unreleased]":
        fault(name, "the first section is not ## [Unreleased]")
    numbers = []
    for title in titles[1:]:
        found = re.fullmatch(r"\[(\d+)\.(\d+)\.(\d+)\] - (\d{4}-\d{2}-\d{2})(?: \[YANKED\])?", title)
        if not found:
            fault(name, f"'## {title}' is not ## [MAJOR.MINOR.PATCH] - YYYY-MM-DD")
            continue
        try:
            datetime.date.fromisoformat(found[4])
        except ValueError:
            fault(name, f"'## {title}': there is no such day")
        numbers.append(tuple(int(part) for part in found.groups()[:3]))
    if numbers != sorted(numbers, reverse=True) or len(set(numbers)) != len(numbers):
        fault(name, "versions are not in falling order, each once")
    now = tuple(int(part) for part in version().split("."))
    if numbers and numbers[0] > now:
        fault(name, f"its newest version is later than {version()} of CMakeLists.txt")
    for kind in re.findall(r"^### (.*)$", text, re.M):
        if kind not in KINDS:
            fault(name, f"'### {kind}' is none of {', '.join(sorted(KINDS))}")
    if len(text.splitlines()) > 150 * (1 + len(numbers)):
        fault(name, "longer than 150 lines a version: it is for users, git log has the rest")


def check_versioning():
    """Each message and constant that the page quotes is in the sources."""
    name = "docs/reference/versioning.md"
    code = []
    for folder in ("shared", "sim", "host", "hil", "tools", "firmware"):
        for path in sorted((ROOT / folder).rglob("*")):
            if (
                path.suffix in (".c", ".h", ".cpp", ".hpp", ".cmake", ".txt", ".in")
                and path.is_file()
                and not path.name.endswith("_test.cpp")
            ):
                text = path.read_text(errors="replace")
                # A string that goes on in the next line is one.
                code.append(re.sub(r'"\s*\n\s*"', "", text).replace('\\"', '"'))
    sources = "\n".join(code)
    # Code that is no message: paths and commands, which other tests check.
    quoted = [
        one
        for one in re.findall(r"`([^`\n]+)`", read(name))
        if " " in one and not re.match(r"kaz |find_package|kaz-", one)
    ]
    constants = re.findall(
        r"`(K[A-Z]+_[A-Z_]+|k[A-Z]\w+|SameMinorVersion|kaz_kept_board|kaz-poses-1)`", read(name)
    )
    if len(quoted) < 15 or len(constants) < 6:
        fault(
            name,
            f"only {len(quoted)} messages and {len(constants)} constants are quoted; was the page rewritten?",
        )
    for one in sorted({*quoted, *constants}):
        if one.removeprefix(": ") not in sources:
            fault(name, f"quotes `{one}`, which is in no source")


def check_package_files():
    """The packages say what the page says."""
    for name in ("tools/repo/cmake/KazInstall.cmake", "tools/repo/cmake/KazPlugin.cmake"):
        rules = re.findall(r"COMPATIBILITY (\w+)", read(name))
        if rules != ["SameMinorVersion"]:
            fault(name, f"compatibility is {rules}, and docs/reference/versioning.md says SameMinorVersion")
    if "@PROJECT_VERSION@" not in read("tools/repo/cmake/kaz.pc.in"):
        fault("tools/repo/cmake/kaz.pc.in", "the version is not the project's")


def check_security():
    text = read("SECURITY.md")
    if re.search(r"[\w.+-]+@[\w-]+\.\w+", text):
        fault(
            "SECURITY.md",
            "has an address for mail; reports go through GitHub's private vulnerability reporting",
        )
    if "private vulnerability reporting" not in text:
        fault("SECURITY.md", "does not say how to report")


TYPES = {
    "art",
    "article",
    "book",
    "conference-paper",
    "generic",
    "report",
    "software",
    "thesis",
}  # of those of CFF


def check_citation(yaml):
    """The schema of CFF 1.2.0, for the keys that are used."""
    name, cff = "CITATION.cff", yaml.safe_load(read("CITATION.cff"))
    known = {
        "cff-version",
        "message",
        "type",
        "title",
        "version",
        "license",
        "authors",
        "keywords",
        "references",
        "date-released",
        "repository-code",
        "url",
        "doi",
        "abstract",
    }
    for key in ("cff-version", "message", "title", "authors"):
        if not cff.get(key):
            fault(name, f"lacks {key}")
    for key in set(cff) - known:
        fault(name, f"has '{key}', which this test does not know of CFF 1.2.0")
    if cff.get("cff-version") != "1.2.0":
        fault(name, "cff-version is not 1.2.0")
    if str(cff.get("version")) != version():
        fault(name, f"version {cff.get('version')}, and CMakeLists.txt has {version()}")
    if cff.get("type") != "software" or cff.get("license") != "Apache-2.0":
        fault(name, "type or license")
    for where, entry in [
        ("", cff),
        *((f"reference {n}: ", one) for n, one in enumerate(cff.get("references", []))),
    ]:
        if where and (entry.get("type") not in TYPES or not entry.get("title")):
            fault(name, f"{where}type or title")
        if where and not entry.get("doi") and "DOI" not in entry.get("notes", ""):
            fault(name, f"{where}has neither a doi nor notes that say what is not known")
        if where and not isinstance(entry.get("year"), int):
            fault(name, f"{where}year is no number")
        for author in entry.get("authors") or [{}]:
            if not (author.get("name") or author.get("family-names")):
                fault(name, f"{where}an author without a name")
    titles = [" ".join(one.get("title", "").split()) for one in cff.get("references", [])]
    if not any(title in " ".join(read("README.md").split()) for title in titles):
        fault(name, "the paper's title is not that of README.md")


def check_ci(yaml):
    """Steps are there, run what exists, and none may fail unseen."""
    name = ".github/workflows/ci.yml"
    text = read(name)
    flow = yaml.safe_load(text)
    triggers = flow.get("on", flow.get(True))  # YAML 1.1 takes `on` for true
    if not {"push", "pull_request"} <= set(triggers or {}):
        fault(name, "does not run on push and pull_request")
    if flow.get("permissions") != {"contents": "read"}:
        fault(name, "may do more than read")
    for word in ("continue-on-error", "|| true", "|| :", "set +e", "; true"):
        if word in text:
            fault(name, f"'{word}' hides a failure")
    for job_name, job in flow["jobs"].items():
        if not re.fullmatch(r"debian:12@sha256:[0-9a-f]{64}", str(job.get("container"))):
            fault(name, f"{job_name}: runs in {job.get('container')}, not in a debian:12 named by its digest")
        runs = [step["run"] for step in job["steps"] if "run" in step]
        if ".ci/run" not in runs:
            fault(name, f"{job_name}: does not run .ci/run as it stands")
        for step in job["steps"]:
            # A tag can be moved; the version is a comment for people.
            if "uses" in step and not re.search(
                    r"^ *-? *uses: actions/[a-z-]+@[0-9a-f]{40} # v\d+\.\d+\.\d+$",
                    next(line for line in text.splitlines() if step["uses"] in line)):
                fault(name, f"{job_name}: {step['uses']} is no action of GitHub's own, named by its hash "
                            "and version")
            if "if" in step and step["if"] != "failure()":
                fault(name, f"{job_name}: a step runs only if {step['if']}")
            if ".ci/run" in step.get("run", "") and set(step) - {"name", "run"}:
                fault(name, f"{job_name}: .ci/run stands under {sorted(set(step) - {'name', 'run'})}")
        for run in runs:
            for path in re.findall(r"(?:^|\s)(\.{1,2}/?[\w./-]*/[\w./-]+)", run):
                if not os.access(ROOT / path, os.X_OK):
                    fault(name, f"{job_name}: runs {path}, which is no program here")
    for path in re.findall(r"(?:^|\s)(\./[\w./-]+)", read(".ci/run")):
        if not os.access(ROOT / path, os.X_OK):
            fault(".ci/run", f"runs {path}, which is no program here")
    verbs = re.findall(r"^  ([a-z-]+)\) ", read("tools/dev"), re.M)
    for verb in re.findall(r"\./tools/dev ([a-z-]+)", read(".ci/run")):
        if verb not in verbs:
            fault(".ci/run", f"runs ./tools/dev {verb}, and there is no such verb")


def main():
    try:
        import yaml
    except ImportError:
        print("python3-yaml is missing: apt-get install python3-yaml, or ./tools/dev setup")
        return 1
    check_changelog()
    check_versioning()
    check_package_files()
    check_security()
    check_citation(yaml)
    check_ci(yaml)
    print(
        "\n".join(faults) if faults else "changelog, versions, security, citation and CI agree with the code"
    )
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
