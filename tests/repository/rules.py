# Promises about the tree itself that no compiler checks.
# SPDX-License-Identifier: Apache-2.0
"""usage: rules.py ROOT"""

import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(sys.argv[1])
COMMENT = re.compile(r"^\s*(//|#|;|/\*|<!--|\*)")
faults = []


def fault(path, text):
    faults.append(f"{path}: {text}")


def files(*patterns):
    listed = subprocess.run(["git", "-C", ROOT, "ls-files", "-co", "--exclude-standard", *patterns],
                            capture_output=True, text=True)
    if listed.returncode == 0:
        return [ROOT / name for name in listed.stdout.split() if (ROOT / name).exists()]
    return [path for pattern in patterns for path in ROOT.rglob(pattern)
            if "build" not in path.relative_to(ROOT).parts]


def check_packages():
    lines = (ROOT / "tools/packages.txt").read_text().splitlines()
    installed = [line for line in lines if line and not line.startswith("#")]
    table = (ROOT / "docs/dependencies.md").read_text()
    explained = re.findall(r"^\| `([^`]+)` \|", table, re.M)
    for name in sorted(set(installed) ^ set(explained)):
        fault("tools/packages.txt, docs/dependencies.md", f"'{name}' is in only one of them")


def check_printed():
    """A whole file printed in a document is that file."""
    sources = {path.read_text() for path in files("*.cpp", "*.py", "*.h")}
    for path in files("docs/*.md", "docs/**/*.md", "README.md"):
        for block in re.findall(r"^```(?:cpp|python)\n(.*?)^```$", path.read_text(), re.M | re.S):
            if "SPDX-License-Identifier" in block and block not in sources:
                fault(path.relative_to(ROOT), "a file printed there differs from the one in the tree")


def check_sources():
    for path in files("*.c", "*.h", "*.cpp", "*.hpp", "*.S", "*.def", "*.py"):
        text = path.read_text()
        lines = text.splitlines()
        name = path.relative_to(ROOT)
        if not lines or not COMMENT.match(lines[0]):
            fault(name, "the first line does not say what the file is for")
        if not any(re.match(r"^\s*\S{1,4} SPDX-License-Identifier: Apache-2.0$", line)
                   for line in lines[:4]):
            fault(name, "no SPDX line of its own near the top")
        if len(lines) > 800:
            fault(name, f"{len(lines)} lines: split it")
        for number, line in enumerate(lines, 1):
            if len(line) > 110:
                fault(f"{name}:{number}", f"{len(line)} columns")


def check_directions():
    """vision and host never include the simulator; shared includes nothing of ours but shared, the
    emulator nothing but the readers of images, errors and saved states."""
    forbidden = {"vision": ("sim/", "host/", "tools/"), "host": ("sim/", "hil/", "tools/"),
                 "hil": ("sim/", "tools/"),
                 "shared": ("sim/", "host/", "vision/", "tools/"),
                 "sim/h8s": ("shared/base/files", "shared/base/types", "shared/base/time", "shared/board/",
                             "shared/faults/", "shared/flash/", "shared/protocol/", "shared/servo/",
                             "host/", "vision/", "tools/", "sim/mcu"),
                 "sim": ("tools/",)}
    for path in files("*.c", "*.h", "*.cpp", "*.hpp"):
        name = path.relative_to(ROOT).as_posix()
        for folder, others in forbidden.items():
            if not name.startswith(folder + "/"):
                continue
            for include in re.findall(r'^#include "([^"]+)"', path.read_text(), re.M):
                if include.startswith(others):
                    fault(name, f"must not include {include}")


# Folder -> its sub-folders and the sub-folders that each may include besides itself: a lower one knows
# nothing of those above it. `tests` are the files named *_test.cpp and *_testing.*, wherever they are, and
# oracle*, which only they use: a test runs its subject in the assembled whole, and nothing else may
# include what is made for tests.
LAYERS = {
    "sim/h8s": {
        "cpu": (), "translate": ("cpu",),
        "chip": ("cpu", "translate"), "flat": ("cpu", "translate"),
        "netlist": ("cpu", "chip"), "debug": ("cpu", "chip"),
        "fuzz": ("cpu", "chip", "flat", "netlist", "debug"), "example": ("chip",), "testdata": (),
        "tests": ("cpu", "translate", "chip", "flat", "netlist", "debug", "fuzz", "testdata"),
    },
}
TEST_FILE = re.compile(r"(_test\.cpp|_testing\.\w+|/oracle\w*\.(cpp|h))$")


def layer_of(folder, name):
    inside = name.removeprefix(folder + "/")
    return "tests" if TEST_FILE.search(name) else inside.split("/")[0] if "/" in inside else ""


def check_layers():
    for path in files("*.c", "*.h", "*.cpp", "*.hpp"):
        name = path.relative_to(ROOT).as_posix()
        for folder, allowed in LAYERS.items():
            if not name.startswith(folder + "/"):
                continue
            layer = layer_of(folder, name)
            if layer not in allowed:
                fault(name, f"is in no sub-folder of {folder} that rules.py knows")
                continue
            for include in re.findall(r'^#include "([^"]+)"', path.read_text(), re.M):
                if include.startswith(folder + "/") and \
                        layer_of(folder, include) not in (layer, *allowed[layer]):
                    fault(name, f"must not include {include}")


# Inside a part: which folders (with what is in them) the sources of a folder may include, besides their own.
FOLDERS = {
    "vision/image": (),
    "vision/calibration": ("vision/image",),
    "vision/color": ("vision/image", "vision/calibration"),
    "vision/depth": ("vision/image", "vision/calibration"),
    "vision/flow": ("vision/image", "vision/calibration", "vision/depth"),
    "vision/planes": ("vision/image", "vision/calibration", "vision/depth"),
    "vision/pipeline": ("vision/image", "vision/calibration", "vision/color", "vision/depth",
                        "vision/flow", "vision/planes"),
    "host/link": (),
    "host/robot": ("host/link",),
    "host/camera": ("host/link", "host/robot"),
    "host/flash": ("host/link", "host/robot"),
    "host/motion": ("host/link", "host/robot"),
    "host/map": (),
    "host/behavior": ("host/link", "host/robot", "host/camera", "host/motion"),
    "hil/report": (),
    "hil/bench": ("hil/report",),
    "hil/conformance": ("hil/report",),
    "hil/fuzz": ("hil/report",),
}


def check_folders():
    """The folders of a part are layers: no include outside of FOLDERS, tests included."""
    for path in files("*.c", "*.h", "*.cpp", "*.hpp", "*.def"):
        name = path.relative_to(ROOT).as_posix()
        for folder, allowed in FOLDERS.items():
            if not name.startswith(folder + "/"):
                continue
            for include in re.findall(r'^#include "([^"]+)"', path.read_text(), re.M):
                other = "/".join(include.split("/")[:2])
                if other != folder and other not in allowed and other.split("/")[0] == name.split("/")[0]:
                    fault(name, f"must not include {include}: {folder} is not a layer above {other}")


# Foreign libraries that only one folder of ours calls: it bounds what hostile files may do and turns their
# errors into ours. Tests call that folder too.
OWNERS = [(re.compile(pattern, re.M), owner, library) for pattern, owner, library in (
    (r'^\s*#\s*include\s*[<"](libpng\d*/)?png(lib)?(conf)?\.h[>"]', "shared/picture", "libpng"),
    (r'^\s*#\s*include\s*[<"](jpeglib|jerror|turbojpeg)\.h[>"]', "shared/picture", "libjpeg"),
    (r"\bcairo_surface_write_to_png(?:_stream)?\b", "shared/picture", "Cairo's PNG writer"),
)]


def check_owners():
    for path in files("*.c", "*.h", "*.cpp", "*.hpp"):
        name = path.relative_to(ROOT).as_posix()
        text = path.read_text()
        for pattern, owner, library in OWNERS:
            if not name.startswith(owner + "/") and pattern.search(text):
                fault(name, f"uses {library}; call the functions of {owner}")


def check_links():
    for path in files("*.md"):
        for target in re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", path.read_text()):
            if not (path.parent / target).exists():
                fault(path.relative_to(ROOT), f"links to '{target}', which is not there")


def check_temporary_names():
    """Programs make temporary files in one place, under names that nobody has taken (mkdtemp, O_EXCL)."""
    guessable = re.compile(r"\b(temp_directory_path|tmpnam|tempnam|mktemp|tmpfile)\b")
    for path in files("*.c", "*.h", "*.cpp", "*.hpp"):
        name = path.relative_to(ROOT).as_posix()
        if name == "shared/base/files.hpp" or name.startswith("tests/") or "test" in path.name:
            continue
        if guessable.search(path.read_text()):
            fault(name, "makes a temporary name of its own; shared/base/files.hpp has the one function")


# Words that code and docs do not use, each with the term to use instead (docs/glossary.md). Only those that
# are wrong everywhere: "ask", "sound" or "figure" have proper uses, so they are left to the reviewer.
WORDS = [(re.compile(pattern), term) for pattern, term in (
    (r"\b_?[Tt]old(?![a-z])|(?<=[a-z])Told(?![a-z])", "reported, returned"),
    (r"\b\w*[Uu]nsound\b", "invalid or faulty"),
    (r"\bTrouble\b", "Diagnostic"),
    (r"\b[Bb]eats?\b", "control cycle"),
    (r"\b[Hh]urried\b", "tx_throttled"),
    (r"\b[Cc]areful\b", "constrained"),
    (r"\bMotorFigures\b", "MotorParams"),
    (r"\bkFigures\b", "kParams, kMeasurements"),
    (r"\bEyeMotion\b", "EgoMotion"),
    (r"\bFlowSight\b", "FlowSample"),
    (r"\bexchanged_eyes\b", "swapped_cameras"),
    (r"\bwriter_rest\b", "writer_second_stage"),
    (r"\bAlbum\b", "Snapshots"),
    (r"\bRig\b", "session backend"),
)]


def check_words():
    for path in files("*.h", "*.hpp", "*.c", "*.cpp", "*.S", "*.py", "*.md"):
        name = path.relative_to(ROOT)
        if name.as_posix() == "tests/repository/rules.py":
            continue
        for number, line in enumerate(path.read_text().splitlines(), 1):
            for pattern, term in WORDS:
                for found in pattern.finditer(line):
                    fault(f"{name}:{number}", f"'{found[0]}' is not a term of ours: {term}")


check_packages()
check_printed()
check_sources()
check_directions()
check_layers()
check_folders()
check_owners()
check_links()
check_temporary_names()
check_words()
print("\n".join(faults) if faults else "the tree keeps its rules")
sys.exit(1 if faults else 0)
