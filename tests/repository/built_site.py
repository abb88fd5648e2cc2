# Builds the documentation's site and judges it: links, reachability, text, search, the API pages beside what
# ctags finds in the headers, and the page in a browser.
# SPDX-License-Identifier: Apache-2.0
"""usage: built_site.py ROOT WORK [FOLDERS]

ROOT: the tree. WORK: where the site is built. FOLDERS: CMake's list of the installed headers' folders, of
which each has to be in the API pages."""

import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

import site_check as check

ROOT, WORK = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
SITE = WORK / "site"
SKIPPED = 77  # SKIP_RETURN_CODE in CMakeLists.txt
faults = []


def built():
    """Runs the build; a second run must find nothing to do."""
    command = [sys.executable, "-B", ROOT / "tools/site/build.py", "--out", SITE, "--work", WORK / "work"]
    for wanted in ("first page", "nothing has changed"):
        done = subprocess.run([str(part) for part in command],
                              stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT,
                              text=True)
        print(done.stdout, flush=True)
        if done.returncode:
            sys.exit("the site does not build (above)")
    if wanted not in done.stdout:
        faults.append("build.py: a second run builds again")


def place_of(page):
    """Where a page of the tree is in the site."""
    if page in ("README.md", "docs/README.md"):
        return {"README.md": "index.html", "docs/README.md": "all-pages.html"}[page]
    path = page.removeprefix("docs/").removesuffix(".md") + ".html"
    return path if "/" in path else path.lower()


def judge_pages(pages):
    sources = ["README.md", "CONTRIBUTING.md", "sim/h8s/README.md"]
    sources += [path.relative_to(ROOT).as_posix() for path in (ROOT / "docs").rglob("*.md")]
    terms = check.search_index(SITE)
    navigation = {check.place("index.html", link)[0] for link in pages["index.html"].navigation}
    for source in sources:
        name = place_of(source)
        if name not in pages:
            faults.append(f"{source}: not in the site")
            continue
        if name not in navigation | {"index.html"}:
            faults.append(f"{source}: not in the navigation of the first page")
        faults.extend(check.text_faults(name, pages[name], (ROOT / source).read_text()))
        faults.extend(check.search_faults(name, pages[name], terms.get(name.removesuffix(".html"),
                                                                       set())))
    lost = set(pages) - check.reached(pages) - {"search.html", "404.html"}
    faults.extend(f"{name}: no way leads there from the first page" for name in sorted(lost))
    print(f"{len(sources)} pages of the tree, {len(pages)} of the site")


def public_headers():
    """Headers that are installed, by CMake's list of folders, or without it by the pages that are there."""
    if len(sys.argv) < 4:
        return [
            path.relative_to(SITE / "api/include").as_posix().removesuffix(".html")
            for path in (SITE / "api/include").rglob("*.html")
        ]
    listed = pathlib.Path(sys.argv[3]).read_text().split()
    found = [
        path for folder in listed for path in sorted((ROOT / folder).iterdir())
        if path.suffix in (".h", ".hpp")
    ]
    return [path.relative_to(ROOT).as_posix() for path in found if not path.name.endswith("_testing.h")]


def declared(headers):
    """{header: names} of public classes, functions, constants and types, as ctags reads the headers."""
    done = subprocess.run([
        "ctags-universal", "--output-format=json", "--languages=C++", "--langmap=C++:+.h",
        "--kinds-C++=dgestucfpvxm", "--fields=+aK", "-f", "-", *headers
    ],
                          cwd=ROOT,
                          stdout=subprocess.PIPE,
                          check=True,
                          text=True)
    tags = [json.loads(line) for line in done.stdout.splitlines()]
    closed = {
        f"{tag.get('scope', '')}::{tag['name']}" for tag in tags
        if tag.get("access") in ("private", "protected")
    }
    names = {header: set() for header in headers}
    for tag in tags:
        scope = tag.get("scope", "")
        steps = scope.split("::")
        inside = {"::".join(steps[:depth + 1]) for depth in range(len(steps))}
        name = tag["name"]
        hidden = (tag.get("access", "public") != "public" or tag.get("scopeKind") == "function" or
                  inside & closed or re.match(r"/\^\s*friend\b", tag.get("pattern", "")) or
                  re.search(r"detail|__anon", f"{scope} {name}") or
                  re.fullmatch(r"KAZ_\w+_(H|HPP)", name))
        if not hidden and re.fullmatch(r"\w+", name):
            names[tag["path"]].add(name)
    return names


def judge_api(pages):
    headers = [
        header for header in public_headers()
        if "Internal" not in (ROOT / header).read_text().split("\n", 1)[0]
    ]
    count = 0
    listed = declared(headers)
    for header, names in listed.items():
        page = pages.get(f"api/include/{header}.html")
        if page is None:
            faults.append(f"{header}: is installed, and has no page")
            continue
        words = set(re.findall(r"\w+", page.text))
        count += len(names)
        faults.extend(f"{header}: '{name}' is public, and not on its page"
                      for name in sorted(names - words))
    print(f"{len(headers)} headers, {count} names that ctags finds")
    if count < 5 * len(headers):
        faults.append("ctags found too few names to judge the API pages by")


def browser(chromium, address, window="1280,900"):
    """The document after its scripts have run, and what they wrote to the console."""
    with tempfile.TemporaryDirectory() as scratch:
        done = subprocess.run([
            chromium, "--headless", "--no-sandbox", "--disable-gpu", "--enable-logging=stderr",
            f"--user-data-dir={scratch}", f"--window-size={window}", "--virtual-time-budget=20000",
            "--dump-dom", address
        ],
                              capture_output=True,
                              text=True,
                              timeout=1200)
    return done.stdout, [
        line for line in done.stderr.splitlines() if "CONSOLE" in line and "mode." not in line
    ]


def judge_browser(chromium):
    """Scripts run from file:// without an error, and the search finds what a page has."""
    document, errors = browser(chromium, (SITE / "index.html").as_uri())
    faults.extend(f"index.html in a browser: {line}" for line in errors)
    if 'class="no-js"' in document:
        faults.append("index.html in a browser: the theme's script has not run")
    for query, wanted in (("odometry", "explanation/motion.html"),
                          ("set_targets", "api/include/host/robot/robot.h.html")):
        document, errors = browser(chromium, (SITE / "search.html").as_uri() + f"?q={query}")
        faults.extend(f"search.html in a browser: {line}" for line in errors)
        if wanted not in document.replace("./", ""):
            faults.append(f"search.html?q={query} in a browser: {wanted} is not among the results")


def main():
    probe = subprocess.run(["/usr/bin/python3", "-c", "import sphinx, myst_parser, furo"],
                           capture_output=True)
    if probe.returncode or not shutil.which("ctags-universal"):
        print("skipped: needs what tools/site/build.py --packages prints, and universal-ctags; "
              "./tools/dev setup installs them")
        sys.exit(SKIPPED)
    built()
    pages = check.read_site(SITE)
    judge_pages(pages)
    judge_api(pages)
    faults.extend(check.link_faults(SITE, pages))
    faults.extend(check.outside_faults(SITE, pages))
    faults.extend(check.path_faults(SITE, str(ROOT), str(WORK)))
    chromium = shutil.which("chromium")
    if chromium:
        judge_browser(chromium)
    else:
        print("no chromium: not looked at in a browser")
    print("\n".join(faults[:60] + ([f"and {len(faults) - 60} more"] if len(faults) > 60 else []))
          or "the site is whole")
    sys.exit(1 if faults else 0)


main()
