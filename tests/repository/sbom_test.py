# The bill of materials (tools/gen/sbom.py): valid SPDX 2.3, complete by ldd, equal when made twice.
# SPDX-License-Identifier: Apache-2.0
"""usage: sbom_test.py ROOT BUILD SCRATCH

Installs BUILD and has the bill made twice, from other folders, with other locale, umask and time zone. Shares
no code with the generator: what has to be in it is taken from ldd, nm and the lock file. Then damages the
bill in each way that these checks are for, and each damage has to be found."""

import base64
import copy
import functools
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys

ROOT, BUILD, SCRATCH = (pathlib.Path(name).resolve() for name in sys.argv[1:4])
NAME, SECONDS = "0.0.0-test", 1_700_000_000
CREATED = "2023-11-14T22:13:20Z"
RELATIONS = {
    "DESCRIBES",
    "CONTAINS",
    "DYNAMIC_LINK",
    "STATIC_LINK",
    "RUNTIME_DEPENDENCY_OF",
    "BUILD_DEPENDENCY_OF",
    "TEST_DEPENDENCY_OF",
}
SIZES = {"SHA1": 40, "SHA256": 64, "SHA512": 128}
IDENTIFIER = re.compile(r"SPDXRef-[A-Za-z0-9.-]+")


def known_licences():
    """SPDX's list, as Debian's package `reuse` has it."""
    folder = pathlib.Path("/usr/lib/python3/dist-packages/reuse/resources")
    licences = json.loads((folder / "licenses.json").read_text())["licenses"]
    exceptions = json.loads((folder / "exceptions.json").read_text())["exceptions"]
    return {one["licenseId"] for one in licences}, {one["licenseExceptionId"] for one in exceptions}


def expression_fault(text, licences, exceptions):
    if text in ("NOASSERTION", "NONE"):
        return None
    for part in re.split(r" (?:AND|OR) ", text):
        names = part.split(" WITH ")
        if names[0] not in licences or len(names) > 2 or any(name not in exceptions for name in names[1:]):
            return f"'{part}' of '{text}' is no licence of SPDX's list"
    return None


def form_faults(bill):
    """What SPDX 2.3's JSON schema and chapters 6 to 11 require of the fields that are used."""
    faults, licences = [], known_licences()

    def need(where, holds, text):
        if not holds:
            faults.append(f"{where}: {text}")

    need("document", bill.get("spdxVersion") == "SPDX-2.3", "spdxVersion")
    need("document", bill.get("dataLicense") == "CC0-1.0", "dataLicense")
    need("document", bill.get("SPDXID") == "SPDXRef-DOCUMENT", "SPDXID")
    need("document", bool(bill.get("name")), "name")
    need("document", re.fullmatch(r"https://[^\s#]+", bill.get("documentNamespace", "")), "documentNamespace")
    info = bill.get("creationInfo", {})
    need("creationInfo", info.get("created") == CREATED, "created is not the time that was given")
    need(
        "creationInfo",
        info.get("creators")
        and all(re.match(r"(Tool|Organization|Person): \S", one) for one in info["creators"]),
        "creators",
    )
    known = {"SPDXRef-DOCUMENT"}
    for kind in ("packages", "files"):
        for one in bill.get(kind, []):
            where = one.get("SPDXID", "?")
            need(where, IDENTIFIER.fullmatch(where), "no identifier of SPDX")
            need(where, where not in known, "twice")
            known.add(where)
            for key in ("licenseConcluded", "licenseDeclared"):
                fault = expression_fault(one.get(key, "NOASSERTION"), *licences)
                need(where, not fault, f"{key}: {fault}")
            need(where, one.get("copyrightText"), "copyrightText")
            for sum_ in one.get("checksums", []):
                need(
                    where,
                    re.fullmatch(rf"[0-9a-f]{{{SIZES.get(sum_['algorithm'], 0)}}}", sum_["checksumValue"]),
                    "checksum",
                )
    for one in bill.get("packages", []):
        where = one["SPDXID"]
        need(where, one.get("name") and one.get("versionInfo"), "name or version")
        location = one.get("downloadLocation", "")
        need(where, location == "NOASSERTION" or re.match(r"https://\S+$", location), "downloadLocation")
        need(where, one.get("filesAnalyzed") is False, "filesAnalyzed: no file of it was")
        for reference in one.get("externalRefs", []):
            need(
                where,
                reference.get("referenceCategory") == "PACKAGE-MANAGER"
                and reference.get("referenceType") == "purl"
                and re.fullmatch(
                    r"pkg:(deb/debian|npm)/[^\s@?:]+@[^\s@?:]+(\?arch=\w+)?",
                    reference.get("referenceLocator", ""),
                ),
                f"purl {reference}",
            )
    for one in bill.get("files", []):
        need(one["SPDXID"], one.get("fileName", "").startswith("./"), "fileName is not relative")
        need(one["SPDXID"], "SHA1" in [sum_["algorithm"] for sum_ in one.get("checksums", [])], "no SHA1")
    named = set()
    for one in bill.get("relationships", []):
        ends = (one.get("spdxElementId"), one.get("relatedSpdxElement"))
        need(ends, one.get("relationshipType") in RELATIONS, f"relationship {one.get('relationshipType')}")
        need(ends, set(ends) <= known, "an end of a relationship is in no list")
        named |= set(ends)
    for lonely in sorted(known - named):
        faults.append(f"{lonely}: in no relationship")
    return faults


def output(*command):
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


@functools.lru_cache(None)
def owner(path):
    """Debian's package of a file, by its list of files."""
    real = os.path.realpath(path)
    for name in (path, real, real.removeprefix("/usr"), "/usr" + real):
        done = subprocess.run(["dpkg", "-S", name], capture_output=True, text=True)
        if done.returncode == 0:
            return done.stdout.split(":")[0].split(",")[0]
    sys.exit(f"{path} belongs to no package")


def built(installed):
    """What ldd, nm, dpkg and sha256sum have of the installation."""
    elf = [path for path in installed.rglob("*") if path.is_file() and path.read_bytes()[:4] == b"\x7fELF"]
    direct, loaded = set(), set()
    for path in elf:
        needed = re.findall(r"NEEDED +(\S+)", output("objdump", "-p", path))
        at = dict(re.findall(r"^\s*(\S+) => (/\S+)", output("ldd", path), re.M))
        direct |= {owner(at[name]) for name in needed if not name.startswith("ld-linux")}
        loaded |= {owner(library) for library in at.values()}
    symbols = output("nm", "-C", installed / "bin/kaz")
    # What leaves its names in the program although no library of it is linked.
    within = {
        package
        for name, package in (
            ("Eigen::", "libeigen3-dev"),
            ("CLI::App::", "libcli11-dev"),
            ("nlohmann::", "nlohmann-json3-dev"),
            ("asmjit::", "libasmjit-dev"),
            ("boost::beast::", "libboost1.74-dev"),
        )
        if name in symbols
    }
    digests = {
        path.relative_to(installed).as_posix(): output("sha256sum", path)[:64]
        for path in [*elf, *installed.rglob("*.a"), installed / "share/kaz/firmware/kaz.mot"]
    }
    versions = {
        name: output("dpkg-query", "-W", "-f", "${Version}\n", name).split()[0] for name in direct | loaded
    }
    return {"direct": direct, "loaded": loaded, "within": within, "digests": digests, "versions": versions}


def content_faults(bill, facts):
    """Is all there that ldd, the symbols and the lock file have, and nothing linked that is not?"""
    faults = []
    names = {one["SPDXID"]: one["name"] for one in bill["packages"]}
    related = {}
    for one in bill["relationships"]:
        for end in (one["spdxElementId"], one["relatedSpdxElement"]):
            if end in names and names[end] != "kaz":
                related.setdefault(one["relationshipType"], set()).add(names[end])
    direct, loaded = facts["direct"], facts["loaded"]
    linked = related.get("DYNAMIC_LINK", set())
    if len(direct) < 10:
        faults.append(f"the program links {sorted(direct)} alone; was all of it built?")
    if len(facts["within"]) < 3:
        faults.append(f"of {sorted(facts['within'])} alone are there names in the program; is it stripped?")
    for name in sorted(direct - linked):
        faults.append(f"{name} is linked (NEEDED), and the bill does not have it so")
    for name in sorted(linked - direct):
        faults.append(f"{name} is not linked, and the bill has it so")
    for name in sorted(loaded - direct - related.get("RUNTIME_DEPENDENCY_OF", set())):
        faults.append(f"{name} is loaded (ldd), and the bill does not have it so")
    for name in sorted(facts["within"] - related.get("STATIC_LINK", set())):
        faults.append(f"{name} is compiled in (nm), and the bill does not have it so")
    listed = {one["fileName"]: one for one in bill["files"]}
    for name, digest in facts["digests"].items():
        entry = listed.get(f"./{name}")
        if not entry or digest not in [sum_["checksumValue"] for sum_ in entry["checksums"]]:
            faults.append(f"{name}: not in the bill with its SHA-256")
    versions = {one["name"]: one["versionInfo"] for one in bill["packages"]}
    for name, version in sorted(facts["versions"].items()):
        if versions.get(name) != version:
            faults.append(f"{name} has version {version}, in the bill {versions.get(name)}")
    unknown = [
        one["name"]
        for one in bill["packages"]
        if one["name"] in direct | facts["within"] and one["licenseDeclared"] == "NOASSERTION"
    ]
    if unknown:
        faults.append(
            f"in the program, without a licence in the bill: {', '.join(unknown)}; see WORDED in sbom.py"
        )
    for line in (ROOT / "tools/packages.txt").read_text().splitlines():
        if line and line[0] != "#" and line not in versions and line not in ("npm", "nodejs"):
            faults.append(f"{line} of tools/packages.txt is not in the bill")
    lock = json.loads((ROOT / "tools/view/page/package-lock.json").read_text())["packages"]
    for key, entry in lock.items():
        if not key:
            continue
        name = key.split("node_modules/")[-1]
        digest = base64.b64decode(entry["integrity"].split("-")[1]).hex()
        found = [
            one
            for one in bill["packages"]
            if one["name"] == name
            and one["versionInfo"] == entry["version"]
            and one["checksums"][0]["checksumValue"] == digest
            and one["licenseDeclared"] == entry["license"]
        ]
        if len(found) != 1:
            faults.append(f"{name} {entry['version']} of the lock file is not in the bill")
        if not entry.get("dev") and name not in related.get("CONTAINS", set()):
            faults.append(f"{name} is bundled into the page, and the bill does not have it so")
    return faults


def generate(installed, target, folder, **settings):
    umask = settings.pop("umask")
    command = [
        sys.executable,
        "-B",
        ROOT / "tools/gen/sbom.py",
        ROOT,
        "--build",
        BUILD,
        "--installed",
        installed,
        "--name",
        NAME,
        "--time",
        str(SECONDS),
        "--out",
        target,
        "--notices",
        SCRATCH / "notices",
    ]
    done = subprocess.run(
        command,
        cwd=folder,
        env={**os.environ, **settings},
        text=True,
        stderr=subprocess.PIPE,
        preexec_fn=lambda: os.umask(umask),
    )
    if done.returncode != 0:
        sys.exit(f"sbom.py ended with {done.returncode}: {done.stderr}")


def damaged(bill):
    """(what was done, a bill with that fault)"""

    def one(what, change):
        result = copy.deepcopy(bill)
        change(result)
        return what, result

    def drop(name):
        def change(result):
            ref = next(item["SPDXID"] for item in result["packages"] if item["name"] == name)
            result["packages"] = [item for item in result["packages"] if item["SPDXID"] != ref]
            result["relationships"] = [
                item
                for item in result["relationships"]
                if ref not in (item["spdxElementId"], item["relatedSpdxElement"])
            ]

        return change

    def first(result, name):
        return next(item for item in result["packages"] if item["name"] == name)

    yield one("a linked library is missing", drop("libode8"))
    yield one("a library loaded by another is missing", drop("libpixman-1-0"))
    yield one("headers that are compiled in are missing", drop("libeigen3-dev"))
    yield one("a package of the page is missing", drop("three"))
    yield one("a package of packages.txt is missing", drop("tmux"))
    yield one("another version", lambda result: first(result, "zlib1g").update(versionInfo="1.0"))
    yield one("a licence that is none", lambda result: first(result, "three").update(licenseDeclared="Expat"))
    yield one("no licence", lambda result: first(result, "libode8").update(licenseDeclared="NOASSERTION"))
    yield one(
        "an end that is nowhere",
        lambda result: result["relationships"].append(
            {
                "spdxElementId": "SPDXRef-Kaz",
                "relationshipType": "CONTAINS",
                "relatedSpdxElement": "SPDXRef-x",
            }
        ),
    )
    yield one("an id with a space", lambda result: first(result, "zlib1g").update(SPDXID="SPDXRef-zlib 1"))
    yield one(
        "another program", lambda result: result["files"][0]["checksums"][1].update(checksumValue="0" * 64)
    )
    yield one("another time", lambda result: result["creationInfo"].update(created="2024-01-01T00:00:00Z"))
    yield one(
        "linked, and is not",
        lambda result: result["relationships"].append(
            {
                "spdxElementId": "SPDXRef-Kaz",
                "relationshipType": "DYNAMIC_LINK",
                "relatedSpdxElement": "SPDXRef-deb-tmux",
            }
        ),
    )


def main():
    shutil.rmtree(SCRATCH, ignore_errors=True)
    installed = SCRATCH / "installed"
    subprocess.run(
        ["cmake", "--install", BUILD, "--prefix", installed], check=True, stdout=subprocess.DEVNULL
    )
    if not (installed / "share/kaz/view/index.html").exists() or not (installed / "lib/kaz").exists():
        print("skipped: built without the page of --view or OMPL, and a release has both")
        return 77
    first, second = SCRATCH / "first.json", SCRATCH / "second.json"
    generate(installed, first, "/", LC_ALL="C", TZ="Asia/Tokyo", umask=0o022)
    generate(installed, second, SCRATCH, LC_ALL="C.UTF-8", TZ="America/Lima", umask=0o077)
    faults = [] if first.read_bytes() == second.read_bytes() else ["made twice, the bill differs"]
    bill, facts = json.loads(first.read_text()), built(installed)
    faults += form_faults(bill) + content_faults(bill, facts)
    for what, other in damaged(bill):
        if not form_faults(other) and not content_faults(other, facts):
            faults.append(f"this check does not see: {what}")
    for name in ("libeigen3-dev/copyright", "libcli11-dev/copyright", "npm-three/LICENSE"):
        if not (SCRATCH / "notices" / name).is_file():
            faults.append(f"the licence {name} is not among the notices of the binary archive")
    print(
        "\n".join(faults) if faults else f"{len(bill['packages'])} packages, as ldd, dpkg and npm have them"
    )
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
