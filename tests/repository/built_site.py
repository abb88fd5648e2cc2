# Builds the documentation site, checks the API pages, and opens pages in a browser. The build fails on a
# broken link, and on a page that docs/README.md does not list.
# SPDX-License-Identifier: Apache-2.0
"""usage: built_site.py ROOT WORK FOLDERS

FOLDERS: CMake's list of the installed headers' folders; each of their headers needs an API page."""

import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

ROOT, WORK = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
SITE = WORK / "site"
LOADS = re.compile(r'<(?:script|link|img|iframe)\b[^>]*\b(?:src|href)="((?:https?:)?//[^"]*)"')


def visit(address):
    """The document after its scripts have run, and the errors on the console."""
    with tempfile.TemporaryDirectory() as scratch:
        done = subprocess.run(["chromium", "--headless", "--no-sandbox", "--disable-gpu",
                               "--enable-logging=stderr", f"--user-data-dir={scratch}",
                               "--virtual-time-budget=20000", "--dump-dom", address],
                              capture_output=True, text=True)
    return done.stdout, [line for line in done.stderr.splitlines() if "CONSOLE" in line]


def main():
    WORK.mkdir(parents=True, exist_ok=True)
    subprocess.run([ROOT / "tools/repo/site/build.sh", SITE], check=True)
    faults = []
    listed = (SITE / "api/files.html").read_text()
    headers = [path for folder in pathlib.Path(sys.argv[3]).read_text().split()
               for path in sorted((ROOT / folder).iterdir())
               if path.suffix in (".h", ".hpp") and not path.name.endswith("_testing.h")]
    faults += [f"{path}: no API page" for path in headers if f">{path.name}<" not in listed]
    if len(headers) < 100:
        faults.append(f"only {len(headers)} installed headers were found")
    for path in SITE.rglob("*.html"):
        text = path.read_text()
        faults += [f"{path.name}: loads {found} from another host" for found in LOADS.findall(text)]
        if str(ROOT) in text:
            faults.append(f"{path.name}: names the folder of the tree")
    if shutil.which("chromium"):
        for page, wanted in (("index.html", "Two commands"),
                             ("api/classkaz_1_1host_1_1Robot.html", "set_targets"),
                             ("search.html?q=odometry", "docs/explanation/motion.html")):
            document, errors = visit(f"{SITE.as_uri()}/{page}")
            faults += [f"{page} in a browser: {line}" for line in errors]
            if wanted not in document:
                faults.append(f"{page} in a browser: '{wanted}' is missing")
    print("\n".join(faults[:60]) or f"the site is complete: {len(headers)} installed headers have API pages")
    sys.exit(1 if faults else 0)


main()
