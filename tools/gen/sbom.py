# The bill of materials of a release, SPDX 2.3 as JSON: Kaz, Debian's packages, npm's packages.
# SPDX-License-Identifier: Apache-2.0
"""Everything is read from what was built, on the machine that built it:

  linked           NEEDED of the installed programs, and what ldd finds below these
  compiled in      headers that ninja's log has for their objects, and static libraries, of packages that have
                   no library among those
  loaded by name   dlopen("lib...") in the sources
  build, tests     tools/packages.txt, by its sections
  npm              tools/view/page/package-lock.json: what is bundled into the page, and what only builds it
  versions         dpkg; licences: /usr/share/doc/PACKAGE/copyright

The same build gives the same bytes: no clock, no random numbers; the time is that of the commit. The licence
of a package is what its copyright file declares for all files (licenseDeclared); where that is in no words
that map to SPDX, it is NOASSERTION and the words are the comment. Nobody has concluded more
(licenseConcluded)."""

import argparse
import base64
import hashlib
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import time

# Short names of Debian's copyright files that are not SPDX's own.
SHORT = {
    "expat": "MIT",
    "mit": "MIT",
    "bsd-2-clause": "BSD-2-Clause",
    "bsd-3-clause": "BSD-3-Clause",
    "apache-2.0": "Apache-2.0",
    "apache-2": "Apache-2.0",
    "zlib": "Zlib",
    "zlib/libpng": "Zlib",
    "mpl-2": "MPL-2.0",
    "mpl-2.0": "MPL-2.0",
    "mpl-1.1": "MPL-1.1",
    "bsl-1.0": "BSL-1.0",
    "boost": "BSL-1.0",
    "cc0-1.0": "CC0-1.0",
    "cc0": "CC0-1.0",
    "isc": "ISC",
    "ftl": "FTL",
    "artistic-2.0": "Artistic-2.0",
    "gpl-2": "GPL-2.0-only",
    "gpl-2.0": "GPL-2.0-only",
    "gpl-2+": "GPL-2.0-or-later",
    "gpl-2.0+": "GPL-2.0-or-later",
    "gpl-3": "GPL-3.0-only",
    "gpl-3+": "GPL-3.0-or-later",
    "gpl-3.0": "GPL-3.0-only",
    "gpl-3.0+": "GPL-3.0-or-later",
    "lgpl-2": "LGPL-2.0-only",
    "lgpl-2+": "LGPL-2.0-or-later",
    "lgpl-2.0+": "LGPL-2.0-or-later",
    "lgpl-2.1": "LGPL-2.1-only",
    "lgpl-2.1+": "LGPL-2.1-or-later",
    "lgpl-3": "LGPL-3.0-only",
    "lgpl-3+": "LGPL-3.0-or-later",
    "bitstream-vera": "Bitstream-Vera",
    "libpng": "Libpng",
}
# Source packages whose copyright file has no such short name for all files: licence, and words that it must
# have. If it has not, the licence is NOASSERTION.
WORDED = {
    "cairo": ("LGPL-2.1-only OR MPL-1.1", "Mozilla Public License Version 1.1"),
    "gcc-12": ("GPL-3.0-or-later WITH GCC-exception-3.1", "GCC RUNTIME LIBRARY EXCEPTION"),
    "glibc": ("LGPL-2.1-or-later", "GNU Lesser General Public License"),
    "libjpeg-turbo": ("IJG AND BSD-3-Clause AND Zlib", "Independent JPEG Group"),
    "ncurses": (
        "X11-distribute-modifications-variant",
        "the name(s) of the above copyright holders shall not be used in advertising",
    ),
}
# Headers of these are interfaces of system and compiler, which a program need not name.
SYSTEM_HEADERS = {"linux", "glibc", "gcc-12", "gcc-defaults"}


class Refused(Exception):
    """One sentence: what, where, what to do."""


def run(*command, check=True):
    done = subprocess.run(
        [str(word) for word in command], capture_output=True, text=True, env={**os.environ, "LC_ALL": "C"}
    )
    if check and done.returncode != 0:
        raise Refused(f"{' '.join(str(word) for word in command[:4])} ...: {done.stderr.strip() or 'failed'}")
    return done.stdout


# --- Debian


def owners(paths):
    """Path -> package, by dpkg. Files of /usr/lib may be listed as of /lib."""
    wanted = {}
    for path in paths:
        for name in {str(path), os.path.realpath(path)}:
            wanted[name] = str(path)
            wanted[name[4:] if name.startswith("/usr/lib") else "/usr" + name] = str(path)
    found = {}
    names = sorted(wanted)
    for begin in range(0, len(names), 500):
        for line in run("dpkg-query", "-S", *names[begin : begin + 500], check=False).splitlines():
            packages, name = line.rsplit(": ", 1)
            if name in wanted and not line.startswith("diversion"):
                found[wanted[name]] = sorted(re.sub(r":\w+$", "", one) for one in packages.split(", "))[0]
    for path in paths:
        if str(path) not in found:
            raise Refused(
                f"{path} belongs to no Debian package; a release is built of Debian's packages alone"
            )
    return found


class Debian:
    """What dpkg has on the packages that it was queried for."""

    FORMAT = "\t".join(
        f"${{{field}}}"
        for field in (
            "db:Status-Status",
            "Version",
            "Architecture",
            "source:Package",
            "source:Version",
            "Homepage",
            "Package",
        )
    )

    def __init__(self):
        self.known = {}

    def get(self, name):
        if name not in self.known:
            lines = [
                line.split("\t")
                for line in run("dpkg-query", "-W", "-f", self.FORMAT + "\\n", name, check=False).splitlines()
            ]
            lines = [line for line in lines if line[0] == "installed"]
            if not lines:
                raise Refused(f"Debian's package {name} is not installed; ./tools/dev setup installs it")
            keys = ("version", "architecture", "source", "source_version", "homepage", "name")
            self.known[name] = dict(zip(keys, lines[0][1:]))
        return self.known[name]

    def installed(self, name):
        try:
            return bool(self.get(name))
        except Refused:
            return False


def expression(text):
    """SPDX's form of a licence of Debian's, or nothing."""
    words = []
    for word in re.split(r"(\s+(?:or|and|OR|AND)\s+|,\s*(?:or|and)?\s*)", text.strip()):
        if re.fullmatch(r"\s+(or|and)\s+", word, re.I):
            words.append(word.strip().upper())
        elif word.strip(", ") in ("or", "and", ""):
            return None  # the comma of "A or B, and C" groups; brackets would be a guess
        elif word.lower() in SHORT:
            words.append(SHORT[word.lower()])
        else:
            return None
    if "OR" in words and "AND" in words:
        return None
    return " ".join(words)


def licence(package):
    """(expression or NOASSERTION, comment) of a Debian package."""
    path = pathlib.Path("/usr/share/doc", package["name"], "copyright")
    try:
        text = path.read_text(errors="replace")
    except OSError:
        return "NOASSERTION", f"{path} is not there"
    worded = WORDED.get(package["source"])
    if worded and re.sub(r"\s+", " ", worded[1]) in re.sub(r"\s*\n[\s*.]*|\s+", " ", text):
        return worded[0], f"by the words of {path}"
    names = sorted({name.strip() for name in re.findall(r"^License:[ \t]*(\S[^\n]*)$", text, re.M)})
    comment = f"{path}: {'; '.join(names)}" if names else f"{path} is no machine-readable copyright file"
    general = re.search(
        r"^Files:\s*\*\s*\n(?:(?!\n)(?!License:)[^\n]*\n)*?License:[ \t]*(\S[^\n]*)$", text, re.M
    )
    return (general and expression(general[1])) or "NOASSERTION", comment


# --- what was built


def is_elf(path):
    with path.open("rb") as file:
        return file.read(4) == b"\x7fELF"


def programs(installed):
    """Programs and modules of an installation, by their path in it."""
    return {
        path.relative_to(installed).as_posix(): path
        for path in sorted(installed.rglob("*"))
        if path.is_file() and not path.is_symlink() and is_elf(path)
    }


def linked(files):
    """(packages linked, packages that only these load): by NEEDED, and by ldd."""
    direct, all_paths = set(), set()
    for path in files.values():
        needed = set(re.findall(r"\(NEEDED\)\s+Shared library: \[([^\]]+)\]", run("readelf", "-d", path)))
        resolved = {}
        for line in run("ldd", path).splitlines():
            if found := re.match(r"\s*(\S+)(?: => (\S+))? \(0x", line):
                resolved[os.path.basename(found[1])] = found[2] or found[1]
        for name in sorted(needed):
            if not resolved.get(name, "").startswith("/"):
                raise Refused(f"{path} needs {name}, which is not found; build it on this machine")
            direct.add(resolved[name])
        all_paths |= {name for name in resolved.values() if name.startswith("/")}
    by_path = owners(sorted(all_paths))
    names = {by_path[path] for path in direct}
    return names, set(by_path.values()) - names


def compiled_in(build, targets):
    """Packages of the headers that ninja's log has for objects of `targets`, and of static libraries."""
    inputs = set(run("ninja", "-C", build, "-t", "inputs", *targets).splitlines())
    used, counts = {path for path in inputs if re.match(r"/usr/.*\.a$", path)}, False
    for line in run("ninja", "-C", build, "-t", "deps").splitlines():
        if not line.startswith(" "):
            counts = line.split(": #deps")[0] in inputs
        elif counts and line.strip().startswith("/usr/"):
            used.add(os.path.normpath(line.strip()))
    return set(owners(sorted(used)).values()) if used else set()


def loaded_by_name(root):
    """Packages of the libraries that sources load by name."""
    names = set()
    for folder in ("shared", "vision", "sim", "host", "hil", "tools"):
        for path in (root / folder).rglob("*.cpp"):
            if not path.name.endswith("_test.cpp"):
                names |= set(re.findall(r'dlopen\(\s*"(lib[^"]+)"', path.read_text(errors="replace")))
    paths = {}
    for line in run("/sbin/ldconfig", "-p").splitlines():
        if found := re.match(r"\s*(\S+) \((.*)\) => (\S+)$", line):
            if found[1] in names and "libc6" in found[2]:
                paths.setdefault(found[1], found[3])
    for name in sorted(names - set(paths)):
        raise Refused(
            f"{name}, which the program loads by name, is not installed; ./tools/dev setup installs it"
        )
    return set(owners(sorted(paths.values())).values()) if paths else set()


def sections(root):
    """Section of tools/packages.txt -> its packages."""
    result, current = {}, None
    for line in (root / "tools/packages.txt").read_text().splitlines():
        if found := re.match(r"# \[(\w+)\]", line):
            current = result.setdefault(found[1], [])
        elif line and not line.startswith("#"):
            if current is None:
                raise Refused(f"tools/packages.txt: {line} stands before the first section, as # [build]")
            current.append(line)
    return result


# --- the document


def identifier(*parts):
    return "SPDXRef-" + re.sub(r"[^A-Za-z0-9.-]+", "-", "-".join(parts)).strip("-")


class Document:
    def __init__(self, name, seconds):
        self.packages, self.files, self.relations = {}, [], []
        self.name, self.created = name, time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime(seconds))
        self.kaz = "SPDXRef-Kaz"
        self.packages[self.kaz] = {
            "SPDXID": self.kaz,
            "name": "kaz",
            "versionInfo": name,
            "downloadLocation": "NOASSERTION",
            "filesAnalyzed": False,
            "licenseConcluded": "Apache-2.0",
            "licenseDeclared": "Apache-2.0",
            "copyrightText": "The Kaz authors",
            "primaryPackagePurpose": "APPLICATION",
        }
        self.relate("SPDXRef-DOCUMENT", "DESCRIBES", self.kaz)

    def relate(self, one, kind, other, comment=None):
        """Once for each pair and kind: the first comment stays."""
        relation = {"spdxElementId": one, "relationshipType": kind, "relatedSpdxElement": other}
        if not any(relation.items() <= known.items() for known in self.relations):
            self.relations.append(relation | ({"comment": comment} if comment else {}))

    def debian(self, package):
        ref = identifier("deb", package["name"])
        if ref in self.packages:
            return ref
        declared, comment = licence(package)
        homepage = package["homepage"] if re.match(r"https?://\S+$", package["homepage"]) else "NOASSERTION"
        self.packages[ref] = {
            "SPDXID": ref,
            "name": package["name"],
            "versionInfo": package["version"],
            "supplier": "Organization: Debian",
            "downloadLocation": "NOASSERTION",
            "filesAnalyzed": False,
            "homepage": homepage,
            "sourceInfo": f"source package {package['source']} {package['source_version']}",
            "licenseConcluded": "NOASSERTION",
            "licenseDeclared": declared,
            "licenseComments": comment,
            "copyrightText": "NOASSERTION",
            "externalRefs": [
                {
                    "referenceCategory": "PACKAGE-MANAGER",
                    "referenceType": "purl",
                    "referenceLocator": f"pkg:deb/debian/{quoted(package['name'])}"
                    f"@{quoted(package['version'])}"
                    f"?arch={package['architecture']}",
                }
            ],
        }
        return ref

    def npm(self, name, entry):
        ref = identifier("npm", name, entry["version"])
        algorithm, digest = entry["integrity"].split("-", 1)
        self.packages[ref] = {
            "SPDXID": ref,
            "name": name,
            "versionInfo": entry["version"],
            "supplier": "NOASSERTION",
            "downloadLocation": entry.get("resolved", "NOASSERTION"),
            "filesAnalyzed": False,
            "checksums": [{"algorithm": algorithm.upper(), "checksumValue": base64.b64decode(digest).hex()}],
            "licenseConcluded": "NOASSERTION",
            "licenseDeclared": entry.get("license", "NOASSERTION"),
            "copyrightText": "NOASSERTION",
            "externalRefs": [
                {
                    "referenceCategory": "PACKAGE-MANAGER",
                    "referenceType": "purl",
                    "referenceLocator": f"pkg:npm/{quoted(name)}@{quoted(entry['version'])}",
                }
            ],
        }
        return ref

    def file(self, name, path, kind):
        data = path.read_bytes()
        ref = identifier("file", name)
        self.files.append(
            {
                "SPDXID": ref,
                "fileName": f"./{name}",
                "fileTypes": [kind],
                "checksums": [
                    {"algorithm": "SHA1", "checksumValue": hashlib.sha1(data).hexdigest()},
                    {"algorithm": "SHA256", "checksumValue": hashlib.sha256(data).hexdigest()},
                ],
                "licenseConcluded": "NOASSERTION",
                "copyrightText": "NOASSERTION",
            }
        )
        self.relate(self.kaz, "CONTAINS", ref)

    def text(self):
        body = {
            "spdxVersion": "SPDX-2.3",
            "dataLicense": "CC0-1.0",
            "SPDXID": "SPDXRef-DOCUMENT",
            "name": f"kaz-{self.name}",
            "creationInfo": {"created": self.created, "creators": ["Tool: kaz-sbom"]},
            "packages": [self.packages[ref] for ref in sorted(self.packages)],
            "files": sorted(self.files, key=lambda one: one["SPDXID"]),
            "relationships": sorted(
                self.relations,
                key=lambda one: (one["spdxElementId"], one["relationshipType"], one["relatedSpdxElement"]),
            ),
        }
        digest = hashlib.sha256(json.dumps(body, sort_keys=True).encode()).hexdigest()
        body["documentNamespace"] = f"https://spdx.org/spdxdocs/kaz-{self.name}-{digest[:32]}"
        return json.dumps(body, indent=1, sort_keys=True) + "\n"


def quoted(text):
    """As a package URL has it."""
    return "".join(c if c.isalnum() or c in ".-_~/" else f"%{ord(c):02X}" for c in text)


def npm_packages(root):
    """(name, entry, bundled) of the page's lock file."""
    path = root / "tools/view/page/package-lock.json"
    for key, entry in sorted(json.loads(path.read_text())["packages"].items()):
        if key:
            if "integrity" not in entry:
                raise Refused(f"{path}: {key} has no integrity hash; write the file anew by npm install")
            yield key.rsplit("node_modules/", 1)[1], entry, not (entry.get("dev") or entry.get("devOptional"))


def bill(root, build, installed, document):
    """Fills the document; returns the notices of what is in the binary archive: name -> files."""
    dpkg, notices = Debian(), {}
    files = programs(installed)
    if "bin/kaz" not in files:
        raise Refused(f"{installed}/bin/kaz is not there; cmake --install puts it there")
    for name, path in files.items():
        document.file(name, path, "BINARY")
    for pattern, kind in (("share/kaz/firmware/*", "BINARY"), ("**/*.a", "ARCHIVE")):
        for path in sorted(installed.glob(pattern)):
            document.file(path.relative_to(installed).as_posix(), path, kind)
    direct, indirect = linked(files)
    named = loaded_by_name(root)
    for name in sorted(direct):
        document.relate(document.kaz, "DYNAMIC_LINK", document.debian(dpkg.get(name)))
    for name in sorted(indirect):
        document.relate(
            document.debian(dpkg.get(name)),
            "RUNTIME_DEPENDENCY_OF",
            document.kaz,
            "loaded by a library that Kaz links",
        )
    for name in sorted(named):
        document.relate(
            document.debian(dpkg.get(name)),
            "RUNTIME_DEPENDENCY_OF",
            document.kaz,
            "loaded by name; without it the program draws by its own rasteriser",
        )
    packages = sections(root)
    used = compiled_in(build, sorted(files))
    for name in sorted(used & set(packages.get("test", []))):
        raise Refused(f"tools/packages.txt: {name} stands under [test], and a header of it is in the program")
    have_library = {dpkg.get(name)["source"] for name in direct | named}
    for name in sorted(used):
        if dpkg.get(name)["source"] not in have_library | SYSTEM_HEADERS:
            document.relate(
                document.kaz,
                "STATIC_LINK",
                document.debian(dpkg.get(name)),
                "headers or a static library of it are compiled into the program",
            )
            notices[name] = [pathlib.Path("/usr/share/doc", name, "copyright")]
        else:
            document.relate(document.debian(dpkg.get(name)), "BUILD_DEPENDENCY_OF", document.kaz, "headers")
    for name in packages.get("run", []):
        document.relate(
            document.debian(dpkg.get(name)),
            "RUNTIME_DEPENDENCY_OF",
            document.kaz,
            "files of it are used while the program runs",
        )
    for section, kind in (("build", "BUILD_DEPENDENCY_OF"), ("test", "TEST_DEPENDENCY_OF")):
        for name in packages.get(section, []):
            if dpkg.installed(name):  # nodejs of other sources brings npm
                document.relate(document.debian(dpkg.get(name)), kind, document.kaz)
    for name, entry, bundled in npm_packages(root):
        ref = document.npm(name, entry)
        if bundled:
            document.relate(document.kaz, "CONTAINS", ref, "bundled into the page of --view")
            folder = build / "tools/view/page/npm/node_modules" / name
            texts = sorted(folder.glob("LICEN[CS]E*")) or [root / "LICENSES" / f"{entry.get('license')}.txt"]
            notices[f"npm-{name.replace('/', '-')}"] = [folder / "package.json", *texts]
        else:
            document.relate(ref, "BUILD_DEPENDENCY_OF", document.kaz, "builds the page of --view")
    return notices


def write_notices(notices, folder):
    for name, files in sorted(notices.items()):
        missing = [path for path in files if not path.is_file()]
        if missing:
            raise Refused(f"{missing[0]}, for the licence of {name} in the binary archive, is not there")
        (folder / name).mkdir(parents=True, exist_ok=True)
        for path in files:
            shutil.copyfile(path, folder / name / path.name)


def main():
    parser = argparse.ArgumentParser(description="writes the bill of materials of a release")
    parser.add_argument("root", type=pathlib.Path, help="the tree")
    parser.add_argument("--build", type=pathlib.Path, required=True, help="its build folder, of ninja")
    parser.add_argument(
        "--installed", type=pathlib.Path, required=True, help="what cmake --install made of it"
    )
    parser.add_argument("--name", required=True, help="version of the release")
    parser.add_argument("--time", type=int, required=True, help="of the commit, seconds since 1970")
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--notices", type=pathlib.Path, help="folder for licences of what is in the archive")
    given = parser.parse_args()
    try:
        document = Document(given.name, given.time)
        notices = bill(given.root, given.build.resolve(), given.installed.resolve(), document)
        if given.notices:
            write_notices(notices, given.notices)
        partial = given.out.with_name(given.out.name + ".partial")
        partial.write_text(document.text())
        partial.rename(given.out)
    except (Refused, OSError) as error:
        print(f"sbom: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
