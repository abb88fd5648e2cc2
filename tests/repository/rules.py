# Promises about the tree itself that no compiler checks.
# SPDX-License-Identifier: Apache-2.0
"""usage: rules.py ROOT"""

import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(sys.argv[1])
SPDX = "SPDX-License-Identifier"
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
            if SPDX in block and block not in sources:
                fault(path.relative_to(ROOT), "a file printed there differs from the one in the tree")


def check_sources():
    for path in files("*.c", "*.h", "*.cpp", "*.hpp", "*.S", "*.def", "*.py"):
        text = path.read_text()
        lines = text.splitlines()
        name = path.relative_to(ROOT)
        if not lines or not COMMENT.match(lines[0]):
            fault(name, "the first line does not say what the file is for")
        if not any(re.match(rf"^\s*\S{{1,4}} {SPDX}: Apache-2\.0$", line) for line in lines[:4]):
            fault(name, "no SPDX line of its own near the top")
        if len(lines) > 800:
            fault(name, f"{len(lines)} lines: split it")
        for number, line in enumerate(lines, 1):
            if len(line) > 110:
                fault(f"{name}:{number}", f"{len(line)} columns")


# The lists of cases in hil/conformance are the only functions that may be longer.
LONG_FUNCTION, LISTS_OF_CASES = 100, re.compile(r"hil/conformance/cases_\w+\.cpp$")
# No line begins a function so: comments, macros, labels, braces, and what only encloses functions.
NO_FUNCTION = re.compile(r'//|/?\*|#|[{})]|.*:$|namespace\b|extern "C"')


def check_functions():
    """A function ends at a line with only a brace, which has the indentation of the function's first line."""
    for path in files("*.c", "*.h", "*.cpp", "*.hpp"):
        name = path.relative_to(ROOT).as_posix()
        if LISTS_OF_CASES.match(name):
            continue
        begins = {}  # indentation -> the last line that may begin a function
        for number, line in enumerate(path.read_text().splitlines(), 1):
            text = line.lstrip()
            indentation = len(line) - len(text)
            length = number - begins.get(indentation, number) + 1
            if text == "}" and length > LONG_FUNCTION:
                fault(f"{name}:{begins[indentation]}", f"a function of {length} lines: split it")
            elif text and not NO_FUNCTION.match(text):
                begins[indentation] = number


# Who may include whom: folder -> its parts, lowest first, each with those of them that it may include besides
# itself. "" is the root; "." are the files directly in the folder. A part allows only parts listed before it,
# so there are no circles. Where "tests" is a part, it is the tests, their helpers and benchmarks (TEST_FILE),
# wherever they are in the folder: a test runs its subject in the assembled whole. Elsewhere tests obey the
# rule of their folder.
LAYERS = {
    "": {
        "shared": (), "vision": ("shared",), "sim": ("shared", "vision"), "host": ("shared", "vision"),
        "hil": ("shared", "vision", "host"), "firmware": ("shared", "sim"),
        "examples": ("shared", "vision", "host"), "tools": ("shared", "vision", "sim", "host", "hil"),
        "python": ("shared", "vision", "sim", "host", "hil", "tools"),
        "tests": ("shared", "vision", "sim", "host", "hil", "tools"),
    },
    "shared": {
        "base": (), "board": ("base",), "dynamixel": ("base",), "faults": ("base", "board"),
        "feetech": ("base",), "flash": ("base",), "image": ("base",),
        "servo_bus": ("base", "dynamixel", "feetech"),
        "servo_model": ("base",), "picture": ("base",), "plot": ("base",), "protocol": ("base", "board"),
        "servo": ("base", "board", "protocol"),
    },
    "vision": {
        "image": (), "calibration": ("image",), "color": ("image", "calibration"),
        "depth": ("image", "calibration"), "flow": ("image", "calibration", "depth"),
        "planes": ("image", "calibration", "depth"),
        "pipeline": ("image", "calibration", "color", "depth", "flow", "planes"),
        "benchmark": ("image", "calibration", "color", "depth", "flow", "planes"),
    },
    "sim": {
        "h8s": (), "mcu": ("h8s",), "body": (), "render": ("body",), "board": ("mcu", "body"),
        "bus": ("body",),
        "runtime": ("h8s", "mcu", "body", "render", "board", "bus"), "stand": ("body", "runtime"),
    },
    "sim/h8s": {
        "cpu": (), "translate": ("cpu",), "chip": ("cpu", "translate"), "flat": ("cpu", "translate"),
        "netlist": ("cpu", "chip"), "debug": ("cpu", "chip"),
        "fuzz": ("cpu", "chip", "flat", "netlist", "debug"), "example": ("chip",), "testdata": (),
        "tests": ("cpu", "translate", "chip", "flat", "netlist", "debug", "fuzz", "testdata"),
    },
    "sim/h8s/testdata": {"flat": (), ".": ()},
    "sim/body": {
        "description": (), "motor": ("description",), "contact": ("description",),
        "world": ("description", "motor", "contact"), "ode": ("description", "motor", "contact", "world"),
        "reduced": ("description", "motor", "contact", "world"),
        ".": ("description", "world", "ode", "reduced"),
        "tests": (".", "description", "motor", "contact", "world", "ode", "reduced"),
    },
    "sim/render": {
        ".": (), "model": (".",), "gl": (".", "model"), "raster": (".", "model"), "sensor": (".",),
        "tests": (".", "model", "gl", "raster", "sensor"),
    },
    "sim/runtime": {
        ".": (), "formats": (".",), "eyes": (".", "formats"), "simulation": (".", "formats", "eyes"),
        "serving": (".", "formats", "eyes", "simulation"),
        "tests": (".", "formats", "eyes", "simulation", "serving"),
    },
    "host": {
        "link": (), "robot": ("link",), "camera": ("link", "robot"), "flash": ("link", "robot"),
        "motion": ("link", "robot"), "calibration": ("robot", "motion"), "map": (), "plan": ("map",),
        "behavior": ("link", "robot", "camera", "motion", "map", "plan"), "bus": ("link", "robot"),
    },
    "hil": {"report": (), "bench": ("report",), "conformance": ("report",), "bus": ("report", "conformance"),
            "fuzz": ("report",), "servo": ()},
    "hil/bench": {".": (), "motor": (".",), "report": (".",), "tests": (".", "motor", "report")},
    "python": {"src": (), "kaz": (), "benchmark": ("kaz",), "tests": ("src",), ".": ()},
    "examples": {"behavior": (), "h8s": (), "python": ()},
    "tools": {
        "trials": (),
        "drawing": (),
        "lockstep": (),
        "viewer": (),
        "base": ("trials",),
        "kept": ("base",),
        "vision": ("drawing", "base"),
        "run": ("drawing", "lockstep", "base", "kept", "vision"),
        "board": ("lockstep", "base", "kept"),
        "bridge": ("base",),
        "bus": ("base", "run"),
        "calibrate": ("base", "kept", "run"),
        "compare": ("lockstep", "base", "run"),
        "doctor": ("base",),
        "monitor": ("base", "kept", "run"),
        "flash": ("base", "kept", "monitor"),
        "mcu": ("base",),
        "sim": ("drawing", "base", "run"),
        "bench": ("drawing", "lockstep", "base", "kept", "run"),
        "replay": ("lockstep", "base", "vision", "run"),
        "eval": ("trials", "drawing", "lockstep", "base", "vision", "run"),
        "film": ("drawing", "lockstep", "base", "run", "replay"),
        "vision_run": ("drawing", "base", "kept", "vision", "run", "replay"),
        "fuzz": ("lockstep", "viewer", "base", "kept", "vision", "run", "compare", "replay", "eval",
                 "vision_run"),
        "benchmark": (),
        "repo": (),
    },
    "tools/fuzz": {".": (), "flash_writer": (".",), "inputs": (".",), "vision": (".",)},
    "tools/benchmark": {"common": (), "mujoco": ("common",), "body": ("mujoco",), ".": ("body",)},
    "tests": {"integration": (), "studies": (), "system": ("studies",), "repository": (), "real_time": ()},
    "tests/integration": {name: () for name in (
        ".", "bench", "conformance", "damage", "random_programs", "servo_conformance", "vision",
        "vision_flow")},
    "tests/studies": {"common": ()} | {name: ("common",) for name in (
        "dynamics_table", "figure7", "gait", "joints", "servo", "step_length", "vision_table", "walking")} |
        {"balance": ("common", "walking"), "contact": ("balance", "common"),
         "map_table": ("common", "vision_table")},
    "tests/system": {
        "campaign": (), "catching": (), "guest": (), "planted": (), "v4l2": (), "virtual_robot": (),
        "flash": (),
        "command_line": ("flash",), "recording_reader": ("command_line",),
    },
    "tests/system/command_line": {".": (), "plugins": ()},
}
# The folder of a new verb needs no entry. `cli` and the files that parse the options of a verb are above all
# folders of verbs.
VERBS = {found[2]: found[1] for found in re.finditer(
    r"^KAZ_VERB\((\w+), (\w+)\)", (ROOT / "tools/cli/verbs.def").read_text(), re.M)}
for folder in VERBS.keys() - {"cli"}:
    LAYERS["tools"].setdefault(folder, ("drawing", "lockstep", "base", "kept", "vision", "run", "board"))
LAYERS["tools"]["cli"] = ("drawing", "viewer", "vision", "base", "film", *sorted(VERBS.keys() - {"cli"}))
VERB_FILE = re.compile(r"tools/\w+/verb_\w+\.cpp")
# The emulator can be used alone: of other parts it includes only these.
ALONE = {"sim/h8s": ("shared/base/archive.hpp", "shared/base/browser_guard.hpp", "shared/base/descriptor.hpp",
                    "shared/base/files.hpp", "shared/base/result.hpp", "shared/image/image.h")}
# A judge shares no code with behaviors: of host it includes only what they report through.
JUDGE, JUDGE_MAY = "tools/eval/judge", tuple(
    f"host/behavior/{name}.h" for name in ("behavior", "options", "sink"))
TEST_FILE = re.compile(r"(_test\.cpp|_testing\.\w+|_benchmark\.cpp)$")


def part_of(folder, name):
    if folder == "tools" and VERB_FILE.fullmatch(name):
        return "cli"
    if TEST_FILE.search(name) and "tests" in LAYERS.get(folder, ()) and folder:
        return "tests"
    inside = name[len(folder) + 1:] if folder else name
    return inside.split("/")[0] if "/" in inside else "."


def check_layers():
    for folder, parts in LAYERS.items():
        seen = set()
        for part, allowed in parts.items():
            for other in set(allowed) - seen:
                fault(f"LAYERS, '{folder}'", f"{part} allows {other}, which is not listed before it")
            seen.add(part)
    unlisted = {}  # folder without an entry -> its parts
    for path in files("*.c", "*.h", "*.cpp", "*.hpp", "*.def", "*.S"):
        name = path.relative_to(ROOT).as_posix()
        includes = re.findall(r'^\s*#\s*include "([^"]+)"', path.read_text(), re.M)
        steps = name.split("/")
        for folder in ("/".join(steps[:depth]) for depth in range(len(steps))):
            part = part_of(folder, name)
            if folder not in LAYERS:
                unlisted.setdefault(folder, set()).add(part)
                continue
            if part not in LAYERS[folder]:
                fault(name, f"'{part}' is no part of '{folder}' in LAYERS of tests/repository/rules.py")
                continue
            for include in includes:
                inside = include.startswith(folder + "/") if folder else include.split("/")[0] in LAYERS[""]
                other = part_of(folder, include)
                if inside and other not in (part, *LAYERS[folder][part]):
                    fault(name, f"must not include {include}: in '{folder}', {part} is not above {other}")
        for include in includes if name.startswith(JUDGE) else ():
            if include.startswith("host/") and include not in JUDGE_MAY:
                fault(name, f"must not include {include}: a judge has bounds and formulas of its own")
        for folder, others in ALONE.items():
            for include in includes if name.startswith(folder + "/") else ():
                if "/" in include and not include.startswith((folder + "/", *others)):
                    fault(name, f"must not include {include}: {folder} is usable alone")
    for folder, parts in unlisted.items():
        if len(parts) > 1:
            fault(folder, f"has the parts {', '.join(sorted(parts))}, but no entry in LAYERS of "
                          "tests/repository/rules.py")


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


def check_json():
    """Texts from outside are parsed in one place, which limits their depth with the parser's own grammar."""
    parser = re.compile(r"json::(?:parse|accept|sax_parse)\(|>> *json\b", re.I)
    for path in files("*.h", "*.hpp", "*.cpp"):
        name = path.relative_to(ROOT).as_posix()
        if name.startswith("tests/") or TEST_FILE.search(name) or name == "shared/base/bounded_json.hpp":
            continue
        if parser.search(path.read_text()):
            fault(name, "parses JSON itself; shared/base/bounded_json.hpp has the one function")


# A register's address (FE00..FFFF, 16 or 24 bits), and a mask that is more than a cut to 8, 16 or 24 bits.
ADDRESS = re.compile(r"\b0x(?:ff)?f[ef][0-9a-f]{2}u?\b", re.I)
MASK = re.compile(r"[&|]=? ?~?\(?(?:0x[0-9a-f]+|(?<=>> \d & )[2-9]\d*)u?\b", re.I)
CUT = re.compile(r"(?:0xff|0xffff|0xffffff|0xff00|0xff0000)u?$", re.I)


def check_registers():
    """The emulated chip names its registers and their bits: sim/h8s/chip/registers.def."""
    for path in files("sim/h8s/chip/*.cpp", "sim/h8s/chip/*.h"):
        name = path.relative_to(ROOT).as_posix()
        if TEST_FILE.search(name):
            continue
        for number, line in enumerate(path.read_text().splitlines(), 1):
            for found in [*ADDRESS.finditer(line), *MASK.finditer(line)]:
                if not CUT.search(found[0]):
                    fault(f"{name}:{number}", f"'{found[0]}': use a name of sim/h8s/chip/registers.def")


def headings(text):
    """The anchors of a page, as GitHub makes them: lower case, without punctuation, numbered if repeated."""
    anchors = set(re.findall(r'<a (?:id|name)="([^"]+)"', text))
    counts = {}
    prose = re.sub(r"^```.*?^```", "", text, flags=re.M | re.S)
    for title in re.findall(r"^#{1,6} +(.+?)[ #]*$", prose, re.M):
        title = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", title)
        anchor = re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-")
        number = counts.get(anchor, 0)
        counts[anchor] = number + 1
        anchors.add(f"{anchor}-{number}" if number else anchor)
    return anchors


def check_links():
    """Each link leads to a file that is there and a heading in it; each page is reached by a link.
    Each path that a source names is there."""
    texts = {path.resolve(): path.read_text() for path in files("*.md")}
    linked = set()
    for path, text in texts.items():
        name = path.relative_to(ROOT.resolve())
        for target, anchor in re.findall(r"\]\(([^)#:\s]*)(?:#([^)\s]*))?\)", text):
            other = (path.parent / target).resolve() if target else path
            if not other.exists():
                fault(name, f"links to '{target}', which is not there")
            elif anchor and other in texts and anchor not in headings(texts[other]):
                fault(name, f"links to '{target}#{anchor}', but there is no such heading")
            if other != path:
                linked.add(other)
    roots = "|".join(["docs", "examples", *LAYERS[""]])
    named = re.compile(rf"(?<![\w/.$}}-])((?:{roots})/[\w./-]+\.(?:md|h|hpp|c|cpp|py))\b(?!\.\w)")
    for path in files("*.c", "*.h", "*.cpp", "*.hpp", "*.def", "*.S", "*.py"):
        for target in named.findall(path.read_text()):
            if not (ROOT / target).exists() and not (ROOT / f"{target}.in").exists():
                fault(path.relative_to(ROOT), f"names '{target}', which is not there")
    for path in texts:
        name = path.relative_to(ROOT.resolve())
        if name.as_posix().startswith("docs/") and path not in linked:
            fault(name, "no page links to it; begin at docs/README.md")


def check_temporary_names():
    """Programs make temporary files in one place, under names that nobody has taken (mkdtemp, O_EXCL)."""
    guessable = re.compile(r"\b(temp_directory_path|tmpnam|tempnam|mktemp|tmpfile)\b")
    for path in files("*.c", "*.h", "*.cpp", "*.hpp"):
        name = path.relative_to(ROOT).as_posix()
        if name == "shared/base/files.hpp" or name.startswith("tests/") or "test" in path.name:
            continue
        if guessable.search(path.read_text()):
            fault(name, "makes a temporary name of its own; shared/base/files.hpp has the one function")


def check_clang():
    """clang 14 builds the fuzz targets, and rejects what returns a std::ranges::subrange of libstdc++ 12."""
    rejected = re.compile(r"std::ranges::(stable_partition|partition|remove_if|remove|unique|rotate)\(")
    for path in files("*.h", "*.cpp", "*.hpp"):
        if found := rejected.search(path.read_text()):
            fault(path.relative_to(ROOT).as_posix(),
                  f"{found[0]}: clang 14 does not compile it; use the one without ranges")


# Words that code and docs do not use, each with the term to use instead (docs/glossary.md). Only those that
# are wrong everywhere: "ask", "sound" or "figure" have proper uses in prose, so there the reviewer judges.
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


# Parts of identifiers (snake_case, CamelCase) that are the dialect's wherever code, not prose, has them.
PARTS = {"ask": "query, request", "asks": "queries", "asked": "requested", "asking": "querying",
         "tell": "report", "tells": "reports", "told": "reported", "telling": "reporting"}
PART = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+")
PROSE = {".py": r'"""(?:.|\n)*?"""|#[^\n]*|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\'',
         "": r'//[^\n]*|/\*(?:.|\n)*?\*/|R"\((?:.|\n)*?\)"|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])+\''}


def check_words():
    for path in files("*.h", "*.hpp", "*.c", "*.cpp", "*.S", "*.py", "*.md"):
        name = path.relative_to(ROOT)
        if name.as_posix() == "tests/repository/rules.py":
            continue
        for number, line in enumerate(path.read_text().splitlines(), 1):
            for pattern, term in WORDS:
                for found in pattern.finditer(line):
                    fault(f"{name}:{number}", f"'{found[0]}' is not a term of ours: {term}")


def check_film():
    """The README's film exists, and loads fast."""
    film, most = "docs/pictures/catch.webp", 3_000_000
    if f"]({film})" not in (ROOT / "README.md").read_text():
        fault("README.md", f"shows no {film}")
    if not (ROOT / film).is_file():
        fault(film, "is missing: ./tools/dev pictures makes it")
    elif (size := (ROOT / film).stat().st_size) > most:
        fault(film, f"has {size} bytes, more than {most}: use a larger --pace")


def check_identifiers():
    for path in files("*.h", "*.hpp", "*.c", "*.cpp", "*.def", "*.py"):
        code = re.sub(PROSE.get(path.suffix, PROSE[""]), " ", path.read_text())
        for identifier in sorted(set(re.findall(r"[A-Za-z_]\w*", code))):
            for part in PART.findall(identifier):
                if part.lower() in PARTS:
                    fault(path.relative_to(ROOT), f"'{identifier}': not '{part}' but {PARTS[part.lower()]}")


check_packages()
check_printed()
check_sources()
check_functions()
check_layers()
check_owners()
check_json()
check_registers()
check_links()
check_temporary_names()
check_clang()
check_words()
check_film()
check_identifiers()
print("\n".join(faults) if faults else "the tree keeps its rules")
sys.exit(1 if faults else 0)
