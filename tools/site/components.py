# The components of the installed package and their public headers, read from the calls of kaz_library as
# tools/cmake/KazInstall.cmake reads them. A test compares them with CMake's own list.
# SPDX-License-Identifier: Apache-2.0
import re

TABLE = "docs/reference/libraries.md"
ROOMS = ("shared", "vision", "sim", "host", "hil", "tools")
CALL = re.compile(r"^[ \t]*kaz_library\(\s*(\w+)([^()]*(?:\([^()]*\)[^()]*)*)\)", re.M)


def without_comments(text):
    return re.sub(r"#[^\n]*", "", text)


def component_of_folder(root, folder):
    """The KAZ_COMPONENT that a folder's CMakeLists.txt, or that of a folder above it, sets."""
    while folder != root:
        file = folder / "CMakeLists.txt"
        found = re.search(r"^set\(KAZ_COMPONENT (\w+)\)", file.read_text(),
                          re.M) if file.exists() else None
        if found:
            return found[1]
        folder = folder.parent
    return None


def variable(folder, name):
    """The words that set(NAME ...) and list(APPEND NAME ...) of a folder's CMake files give."""
    words = []
    for file in sorted([*folder.glob("*.cmake"), *folder.glob("CMakeLists.txt")]):
        text = without_comments(file.read_text())
        for found in re.finditer(rf"(?:set\({name}|list\(APPEND {name})\s([^()]*)\)", text):
            words += found[1].split()
    return words


def header_folders(root):
    """{folder: component} of the installed headers; 'base': folders that all include and no library has."""
    folders = {}
    for room in ROOMS:
        for file in sorted((root / room).rglob("CMakeLists.txt")):
            for call in CALL.finditer(without_comments(file.read_text())):
                words = call[2].split()
                component = words[words.index("COMPONENT") + 1] if "COMPONENT" in words else \
                    component_of_folder(root, file.parent)
                if not component:
                    continue
                sources = re.search(r"\bSOURCES\b(.*?)(?:\bPUBLIC\b|\bPRIVATE\b|$)", call[2], re.S)
                for word in sources[1].split() if sources else ():
                    reference = re.fullmatch(r"\$\{(\w+)\}", word)
                    for source in variable(file.parent, reference[1]) if reference else [word]:
                        folder = (file.parent / source).parent
                        if folder.is_dir():
                            folders.setdefault(folder.resolve().relative_to(root).as_posix(), component)
    install = without_comments((root / "tools/cmake/KazInstall.cmake").read_text())
    for folder in re.search(r"^set\(folders ([^)]*)\)", install, re.M)[1].split():
        below = [component for other, component in folders.items() if other.startswith(folder + "/")]
        folders.setdefault(folder, below[0] if below else "base")
    return folders


def public_headers(root):
    """{component: [path of a header]}, in the order of the components' table in TABLE."""
    table = re.findall(r"^\| `(\w+)` \|", (root / TABLE).read_text(), re.M)
    headers = {"base": [], **{name: [] for name in table}}
    for folder, component in sorted(header_folders(root).items()):
        found = sorted([*(root / folder).glob("*.h"), *(root / folder).glob("*.hpp")])
        headers.setdefault(component, [])
        headers[component] += [
            path.relative_to(root).as_posix() for path in found if not path.name.endswith("_testing.h")
        ]
    return headers
