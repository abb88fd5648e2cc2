# Behaviors, vision and hil get nothing of the simulator's, and do not query whether there is one.
# SPDX-License-Identifier: Apache-2.0
"""usage: independent.py ROOT

By include: nothing that host, vision, hil or shared reach, through whatever header, is in sim or tools.
By word: their code names no simulator but in the places below, each with its reason. A place that has gone
has to go from the list too.
By name: in tools, where both sides meet, those places that take the simulation out of a run's backend.
"""

import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(sys.argv[1])
BELOW = ("host", "vision", "hil", "shared")
NOT_BELOW = ("sim/", "tools/", "tests/")
TESTS = re.compile(r"(_test\.cpp|_testing\.\w+|_benchmark\.cpp)$|^vision/benchmark/|/testdata/")

# Words of the simulator's, in identifiers and in texts; comments are free. `std::holds_alternative` has none.
WORD = re.compile(
    r"simulat\w*|(?<![A-Za-z])sim(?![A-Za-z])|emulat\w*|lockstep|ground.truth|(?<![A-Za-z])truth|--mcu"
    r"|(?<![A-Za-z:])native|virtual_?(?:board|robot)|pseudo\w*|control_socket|\.ctl\b", re.I)
SENTENCE = "an error's sentence for a user of `kaz sim`; nothing depends on it"
STANDS_IN = "stands in for the lines DTR and RTS, reset and mode pins, which no pty has"
FAULTS = "the vocabulary of injected faults; no behavior includes it"
PACE = "when results come: after declared latencies, as of recorded pictures, or as soon as they are there"
# The file -> the words that it may have, and why.
PLACES = {
    "hil/bench/tick_bench.cpp": (
        {"simulated"},
        "a sentence: where the caller states that board and bench have one clock, there is no error of it"),
    "host/camera/camera_stream.cpp": ({"simulator", "sim"}, SENTENCE),
    "host/camera/published_camera.cpp": ({"simulator", "sim"}, SENTENCE),
    "host/flash/board_reset.cpp": ({"control_socket"}, STANDS_IN),
    "host/link/serial_port.cpp": (
        {"sim", ".ctl", "pseudo_terminal"},
        "sentences about paths that are no port; and a pty is no UART: exclusive mode would outlive its "
        "user, and there is no latency to set"),
    "host/link/serial_port.h": ({"pseudo_terminal"}, "a pty has no latency to set, whoever else has it"),
    "host/link/tty_link.cpp": (
        {"pseudo_terminal", "pseudo", "simulator"},
        "sentences: that a pty has no lines DTR and RTS, and what was closed"),
    "host/robot/control_socket.cpp": ({"control_socket", "sim", ".ctl"}, STANDS_IN),
    "host/robot/control_socket.h": ({"control_socket"}, STANDS_IN),
    "host/robot/kept_board.cpp": (
        {"sim", "--mcu", "native"},
        "a sentence: how long a board whose identity states no image keeps its calibration"),
    "host/robot/measure_link.cpp": ({"pseudo_terminal", "simulator"}, "a sentence: what makes a pty slow"),
    "shared/faults/faults.cpp": ({"only_simulated", "simulation"}, FAULTS),
    "shared/faults/faults.def": ({"simulation"}, FAULTS),
    "shared/faults/faults.h": ({"simulation", "only_simulated"}, FAULTS),
    "vision/pipeline/pipeline.cpp": ({"lockstep"}, PACE),
    "vision/pipeline/pipeline.h": ({"lockstep"}, PACE),
}

# In tools: who takes the simulation out of a backend, how often, and for what. Behaviors see none of it.
TAKERS = {
    "tools/run/run_end.cpp": (1, "pictures from outside, the result's facts"),
    "tools/run/run_eyes.cpp": (1, "pictures from outside"),
    "tools/run/run_recorder.cpp": (2, "ground truth for the score"),
    "tools/run/run_robot.cpp": (1, "the judges' view"),
    "tools/run/run_stack.cpp": (1, "the pose at the start, for its picture"),
    "tools/calibrate/calibrate_joints.cpp": (1, "stores the board's memory after the last request"),
    "tools/run/backend.cpp": (2, "defines it"),
    "tools/run/backend.h": (1, "declares it"),
    "tools/replay/replay_host.cpp": (1, "defines it: none"),
}
faults = []


def files(*folders):
    listed = subprocess.run(["git", "-C", ROOT, "ls-files", "-co", "--exclude-standard", *folders],
                            capture_output=True, text=True)
    names = listed.stdout.split() if listed.returncode == 0 else [
        path.relative_to(ROOT).as_posix() for folder in folders for path in (ROOT / folder).rglob("*.*")]
    return [name for name in names if re.search(r"\.(c|h|cpp|hpp|def)$", name) and not TESTS.search(name)
            and (ROOT / name).exists()]


def code(name):
    """The file without its comments."""
    return re.sub(r'//[^\n]*|/\*(?:.|\n)*?\*/|("(?:\\.|[^"\\\n])*")', lambda found: found[1] or " ",
                  (ROOT / name).read_text())


def includes(name):
    return re.findall(r'^\s*#\s*include "([^"]+)"', (ROOT / name).read_text(), re.M)


def check_includes():
    for name in files(*BELOW):
        reached, left = {name: None}, [name]
        while left:
            one = left.pop()
            for include in includes(one):
                if include in reached:
                    continue
                reached[include] = one
                if include.startswith(NOT_BELOW):
                    faults.append(f"{name}: reaches {include}, by {one}")
                elif (ROOT / include).exists():
                    left.append(include)


def check_words():
    left = {name: set(words) for name, (words, _) in PLACES.items()}
    for name in files(*BELOW):
        allowed = PLACES.get(name, (set(), ""))[0]
        for number, line in enumerate(code(name).splitlines(), 1):
            # Whole identifiers, so that a place lists `only_simulated` and not a piece of it.
            for found in WORD.finditer(line):
                before, after = line[:found.start()], line[found.end():]
                word = re.search(r"\w*$", before)[0] + found[0] + re.match(r"\w*", after)[0]
                known = {other for other in allowed if other in (word, found[0])}
                left.get(name, set()).difference_update(known)
                if not known and not any(other in word for other in allowed):
                    faults.append(f"{name}:{number}: '{word}': host, vision and hil do not query whether "
                                  "there is a simulator; a place that may name it is in "
                                  "tests/repository/independent.py, with its reason")
    for name, words in left.items():
        for word in sorted(words):
            faults.append(f"tests/repository/independent.py: {name} no longer has '{word}'")


def check_takers():
    # Libraries that offer the simulation.
    below = ("tools/lockstep/", "tools/viewer/", "tools/fuzz/", "tools/benchmark/", "tools/trials/")
    for name in files("tools"):
        if name.startswith(below):
            continue
        count = len(re.findall(r"\bsimulation\(\)", code(name)))
        allowed = TAKERS.get(name, (0, ""))[0]
        if count != allowed:
            faults.append(f"{name}: takes the simulation out of a run's backend in {count} places, and "
                          f"tests/repository/independent.py has {allowed}: whatever is taken must not reach "
                          "behaviors or vision")
    for name in TAKERS:
        if not (ROOT / name).exists():
            faults.append(f"tests/repository/independent.py: there is no {name}")
    # One function assembles the context of a behavior; the context must not contain the simulation.
    begin = code("tools/run/run.cpp").split("behavior::Context context{", 1)
    if len(begin) != 2:
        faults.append("tools/run/run.cpp: `behavior::Context context{` is not found, where a behavior gets "
                      "what it has")
    elif re.search(r"simulation|world|\bsim::", begin[1].split("outcome_of(plan, context", 1)[0]):
        faults.append("tools/run/run.cpp: a behavior's context has something of the simulation")


check_includes()
check_words()
check_takers()
print("\n".join(faults) if faults else "host, vision and hil know no simulator")
sys.exit(1 if faults else 0)
