# Every file that reads bytes from outside has a fuzz target, or a reason why not.
# SPDX-License-Identifier: Apache-2.0
"""usage: fuzzed.py ROOT

Checks tools/fuzz/targets.txt against the sources and against docs/results/fuzz-campaign.csv. A file reads
if one of these is true; comments and string literals do not count:

1. It includes a header of READING_HEADERS. A header of another project that is in neither list is an error.
2. It calls a function that the tree does not declare and whose name looks like reading (READING), unless the
   name is in HARMLESS. Functions of the C library count although the tree may declare the same name.
3. It uses an input stream (STREAMS).
4. It uses a name in a `bytes` line of targets.txt: our own functions and types that deliver raw bytes.
5. It belongs to the script of a browser page or to the Python package.

Such a file needs a line in targets.txt that names everything it reads by. So a second parser in a listed file
is an error too. Names of files and environment variables do not count as bytes from outside."""

import csv
import fnmatch
import functools
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(sys.argv[1])
FOLDERS = [path.name for path in ROOT.iterdir() if path.is_dir() and not path.name.startswith(".")
           and path.name not in ("build", "debian", "docs", "out", "tests")]
SUFFIXES = (".c", ".h", ".cpp", ".hpp", ".cc", ".cxx", ".hh", ".inl")
TESTS = re.compile(r"_(?:test|benchmark)\.(?:c|cpp|h)$|_testing\.|_example\.cpp$|/testdata/"
                   r"|^python/tests/|^tools/(?:benchmark|fuzz)/|^sim/h8s/(?:fuzz|example)/")
SCRIPTS = re.compile(r"/page/src/.*\.[jt]s$|^python/(?!benchmark/|setup\.py).*\.py$")

HARMLESS_HEADERS = """
  algorithm any array asm/termbits.h atomic benchmark/benchmark.h bit bitset cairo.h cctype cerrno
  charconv chrono climits clocale cmath complex concepts condition_variable csetjmp csignal cstdarg
  cstddef cstdint cstdio cstdlib cstring ctime cxxabi.h deque dlfcn.h elf.h fnmatch.h
  exception execinfo.h fcntl.h filesystem fstream functional future grp.h immintrin.h initializer_list
  iomanip iostream iterator limits limits.h list map memory mutex net/if.h net/if_arp.h netinet/in.h
  netinet/tcp.h new nlohmann/json.hpp nlohmann/json_fwd.hpp numbers numeric ode/ode.h openssl/evp.h
  openssl/sha.h optional ostream poll.h pthread.h queue random ranges set signal.h span sstream stddef.h
  stdexcept stdlib.h string string_view sys/epoll.h sys/eventfd.h sys/file.h sys/ioctl.h sys/prctl.h
  sys/resource.h sys/socket.h sys/stat.h sys/syscall.h sys/sysmacros.h sys/time.h sys/types.h sys/un.h
  sys/utsname.h sys/wait.h system_error termios.h thread time.h tl/expected.hpp tuple type_traits typeinfo
  unistd.h unordered_map unordered_set utility variant vector version xxhash.h CLI/* EGL/* Eigen/* GL/*
  asmjit/* libqhull_r/* mujoco/mjmodel.h ompl/* opencv2/calib3d.hpp opencv2/core.hpp opencv2/core/eigen.hpp
  opencv2/core/utility.hpp opencv2/imgproc.hpp opencv2/video/tracking.hpp pcl/features/*
  pcl/point_types.h pcl/segmentation/* kaz_interface.h kz_*.h board_params.h tools/base/version.h""".split()
READING_HEADERS = """
  arpa/inet.h boost/* curses.h dirent.h glob.h jerror.h jpeglib.h linux/* lz4frame.h mujoco/mujoco.h netdb.h
  png.h pybind11/* regex sdf/* sys/mman.h tinyxml2.h zlib.h zstd.h""".split()
READING = re.compile(
    r"(?<![Tt]h)[Rr]ead(?!y)|[Rr]e?cv|[Rr]eceiv|[Pp]ars|[Ss]can|[Ll]oad|[Dd]ecode|unpack|[Ii]mport|[Ii]nput"
    r"|getline|getdelim|getw?char|getw?cs?$|gets(?:_unlocked)?$|^getch$|^from_|^strto|^wcsto|^sto[ilfdu]"
    r"|^ato[ilf]|strptime|^accept$|inflate|uncompress|deserial|ioctl|mmap|shmat|splice|extract|xattr|syscall"
    r"|getrandom|popen")
C_LIBRARY = re.compile(
    r"p?readv?2?|f?read(?:_unlocked)?|recv\w*|ioctl|mmap|syscall|getline|getdelim|v?[fs]?w?scanf"
    r"|f?getw?[cs](?:_unlocked)?|getw?char|popen")
HARMLESS = re.compile(
    r"_mm\d*_\w+|kz_(?:un)?pack_\w+|\w+_|read_symlink|read_message_max|stop_requested|ReadBuffer|ReadPixels"
    r"|def_(?:property_)?readonly|setInput\w+|trigger_on_parse|jpeg_write_\w+|XXH\w+")
STREAMS = re.compile(
    r"\b(?:basic_)?w?(?:i?fstream|istream|iostream|i?stringstream|i?spanstream|filebuf|streambuf|stringbuf"
    r"|cin|istream_iterator|istreambuf_iterator|FileStorage|VideoCapture)\b")
NOT_CODE = re.compile(r"(?P<kept>\b\d(?:'?[\w.])*|#[ \t]*include[ \t]*[<\"][^>\"\n]+[>\"])|//[^\n]*|/\*.*?\*/"
                      r"|\bR\"([^()\\ ]*)\(.*?\)\2\"|\"(?:\\.|[^\"\\\n])*\"|'(?:\\.|[^'\\\n])+'", re.S)
INCLUDE = re.compile(r"#[ \t]*include[ \t]*[<\"]([^>\"\n]+)[>\"]")
ARGUMENTS = r"(?:<[^<>;{}()]*(?:<[^<>;{}()]*(?:<[^<>;{}()]*>[^<>;{}()]*)*>[^<>;{}()]*)*>)?"
CALLED = re.compile(rf"\s*{ARGUMENTS}\s*\(")
SCOPED = re.compile(rf"(?:(\w+){ARGUMENTS}\s*::\s*|(?<!\w)(::)\s*|(\.|->)\s*|)$")
KEYWORDS = "return else do co_return co_await co_yield throw case new delete sizeof and or not xor".split()
# clang-format puts no space between a type and its * or &, so `a * read(b)` is no declaration.
TYPE_BEFORE = re.compile(r"(\w+|[>\]])[>*&]*\s+(?:\w+(?:<\w+>)?::)*$")
DECLARED = re.compile(r"(\w+|[>\]])[>*&]*\s+(?:\w+(?:<\w+>)?::)*(\w+)\(|\b(auto) (\w+)(?: = \[|[,)])")
SCOPE = re.compile(r"\b(?:class|struct|namespace|union|enum)\s+(?:\w+::)*(\w+)\b(?!\s*=)")
faults = []


def sources():
    listed = subprocess.run(["git", "-C", ROOT, "ls-files", "-co", "--exclude-standard", *FOLDERS],
                            capture_output=True, text=True)
    names = listed.stdout.split() if listed.returncode == 0 else [
        path.relative_to(ROOT).as_posix() for folder in FOLDERS for path in (ROOT / folder).rglob("*")]
    return [name for name in names
            if (name.endswith(SUFFIXES) or SCRIPTS.search(name)) and not TESTS.search(name)
            and (ROOT / name).is_file()]


def matching(name, patterns):
    return next((pattern for pattern in patterns if fnmatch.fnmatchcase(name, pattern)), None)


class Tree:
    def __init__(self, names, raw):
        self.code = {name: NOT_CODE.sub(lambda found: found["kept"] or " ", (ROOT / name).read_text())
                     for name in names if not SCRIPTS.search(name)}
        self.raw = raw
        self.scopes, self.declared, aliases = set(), set(), set()
        for text in self.code.values():
            self.scopes.update(SCOPE.findall(text))
            aliases.update(re.findall(r"\busing\s+(\w+)\s*=\s*(?:typename\s+)?(?:::\s*)?(\w+)", text))
            for found in DECLARED.findall(text):
                self.declared.update(set(found[1::2]) if found[0] not in KEYWORDS else ())
        self.scopes -= {"nlohmann", "std"}  # they only reopen these namespaces
        self.scopes -= {name for name, meaning in aliases if meaning not in self.scopes}
        self.looks_like_reading = functools.cache(
            lambda name: name in raw or C_LIBRARY.fullmatch(name) or
            READING.search(name) and not HARMLESS.fullmatch(name))

    def headers(self, name):
        for header in INCLUDE.findall(self.code[name]):
            if pattern := matching(header, READING_HEADERS):
                yield f"<{pattern}>"
            elif not (matching(header, HARMLESS_HEADERS) or (ROOT / header).is_file() or
                      (ROOT / name).parent.joinpath(header).is_file()):
                faults.append(f"{name}: <{header}> is neither in HARMLESS_HEADERS nor in READING_HEADERS of "
                              "tests/repository/fuzzed.py")

    def reads_by(self, name):
        """All that the file reads by; empty if it does not read."""
        if name not in self.code:
            return {"script"}
        text = INCLUDE.sub(" ", self.code[name])
        by = set(self.headers(name)) | set(STREAMS.findall(text))
        words = [word for word in set(re.findall(r"\b[A-Za-z_]\w*", text)) if self.looks_like_reading(word)]
        for found in re.finditer(rf"\b(?:{'|'.join(words)})\b", text) if words else ():
            word, before = found[0], text[max(0, found.start() - 120):found.start()]
            scope, top, member = SCOPED.search(before).groups()
            if word in self.raw and word[0].isupper():
                if not re.match(r"&\s*\w+[^;{}()]*\)[^;{}]*;", text[found.end():]):
                    by.add(word)
                continue
            passed_on = C_LIBRARY.fullmatch(word) and (top or word not in self.declared)
            if not CALLED.match(text, found.end()) and not passed_on:
                continue
            if scope in KEYWORDS:
                scope = None
            declaration = TYPE_BEFORE.search(before)
            if not member and not top and declaration and declaration[1] not in KEYWORDS:
                continue
            if not scope and not member and C_LIBRARY.fullmatch(word):
                by.add("::read" if word == "read" else word)
            elif word in self.raw:
                by.add(word)
            elif not (scope in self.scopes or not scope and (word in self.declared or word in self.scopes)):
                by.add(word)
        return by


targets, reads, reasons, listed_by, raw = {}, {}, {}, {}, set()
for number, line in enumerate((ROOT / "tools/fuzz/targets.txt").read_text().splitlines(), 1):
    words = line.split()
    if not words or words[0].startswith("#"):
        continue
    if words[0] == "target" and len(words) in (4, 5):
        targets[words[1]] = words[2]
    elif words[0] == "bytes" and len(words) > 1:
        raw.update(words[1:])
    elif found := re.fullmatch(r"reads (\S+)((?: \w+)+)(?: \((.+)\))?", line):
        reads[found[1]], listed_by[found[1]] = found[2].split(), set((found[3] or "").split())
    elif found := re.fullmatch(r"none (\S+) \(([^)]+)\) ([\w/].*)", line):
        reasons[found[1]], listed_by[found[1]] = found[3], set(found[2].split())
    else:
        faults.append(f"tools/fuzz/targets.txt:{number}: this line is of no form")

product = sources()
tree = Tree(product, raw)
for name in product:
    by = tree.reads_by(name)
    line = name if name in reads or name in reasons else matching(name, reasons)
    if by and line is None:
        faults.append(f"{name}: reads by {' '.join(sorted(by))} and has no line in tools/fuzz/targets.txt")
    elif by != listed_by.get(line, set()) and (by or line == name):
        faults.append(f"{name}: reads by ({' '.join(sorted(by))}), but the line of {line} in "
                      f"tools/fuzz/targets.txt names ({' '.join(sorted(listed_by[line]))})")
for name in reads.keys() & reasons.keys():
    faults.append(f"tools/fuzz/targets.txt: {name} has both a target and a reason")
for name in [*reads, *reasons]:
    if not any(fnmatch.fnmatchcase(one, name) for one in product):
        faults.append(f"tools/fuzz/targets.txt: names {name}, which is not there")
for name, used in reads.items():
    for target in used:
        if target not in targets:
            faults.append(f"tools/fuzz/targets.txt: {name} names the target {target}, which is not there")
for target, folder in targets.items():
    seeds = list((ROOT / folder).glob("*")) if (ROOT / folder).is_dir() else []
    if not seeds:
        faults.append(f"tools/fuzz/targets.txt: target {target} has no seeds in {folder}")
    if not any(target in used for used in reads.values()):
        faults.append(f"tools/fuzz/targets.txt: target {target} drives no parser")

with (ROOT / "docs/results/fuzz-campaign.csv").open(newline="") as table:
    rows = {row["target"]: row["parsers"] for row in csv.DictReader(table)}
for target in targets:
    parsers = [name for name, used in reads.items() if target in used]
    if [parser.split()[0] for parser in rows.get(target, "").split("; ") if parser] != parsers:
        faults.append(f"docs/results/fuzz-campaign.csv: the row of {target} must name {', '.join(parsers)}; "
                      f"./tools/dev fuzz --table --only {target} writes it")

print("\n".join(faults) if faults else f"{len(reads)} parsers have {len(targets)} fuzz targets")
sys.exit(1 if faults else 0)
