# Builds the documentation's site: stages the tree's Markdown pages and the API pages, runs Sphinx over them
# with warnings as errors, and puts the result in place when it is whole.
# SPDX-License-Identifier: Apache-2.0
"""usage: build.py [--out FOLDER] [--work FOLDER] [--jobs N] [--packages]

Writes the site to FOLDER (default: out/site of the tree; its first page is index.html). The work folder
(default: build/site) speeds up the next build. Does nothing if no input has changed. Exit status: 0 the site
is complete; 1 a page has an error, or a program is missing: see the last line."""

import argparse
import contextlib
import fcntl
import hashlib
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time

import api
import pages

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
NORMALIZE = pathlib.Path("/usr/share/javascript/normalize.css/normalize.css")
PACKAGES = "python3-sphinx python3-myst-parser furo"


def say(text):
    print(f"site: {text}", flush=True)


def site_version():
    """The version in project(kaz VERSION ...) of CMakeLists.txt."""
    found = re.search(r"^project\(kaz VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text(), re.M)
    if not found:
        raise pages.SiteError(
            "CMakeLists.txt has no line 'project(kaz VERSION ...': the site takes its version from there")
    return found[1]


def staged():
    """Path below the source folder -> bytes, of everything that Sphinx reads."""
    stage = pages.Stage(ROOT, api.documents(ROOT))
    navigation = api.add_pages(stage)
    stage.add_pages("\n" + navigation)
    return stage.files


def sphinx_version():
    script = ("import sphinx, myst_parser, furo; "
              "print(sphinx.__version__, myst_parser.__version__, furo.__version__)")
    done = subprocess.run([PYTHON, "-c", script], capture_output=True, text=True)
    if done.returncode:
        raise pages.SiteError(
            f"Sphinx, its Markdown parser or its theme is missing ({done.stderr.strip().splitlines()[-1]}): "
            f"apt-get install --no-install-recommends {PACKAGES}")
    return done.stdout.strip()


# Debian's packages belong to Debian's Python, which need not be the first on the PATH.
PYTHON = "/usr/bin/python3" if os.path.exists("/usr/bin/python3") else sys.executable


def digest(files, version):
    """Of all that the site is made of."""
    total = hashlib.sha256(version.encode())
    own = {
        f"tools/{path.name}": path.read_bytes()
        for path in sorted([*HERE.glob("*.py"), *HERE.glob("static/*")])
    }
    for name, data in sorted({**files, **own}.items()):
        total.update(f"{name} {len(data)}\n".encode())
        total.update(data)
    return total.hexdigest()


def write_source(folder, files):
    """Makes the source folder equal to `files`; what has not changed keeps its time: Sphinx skips it."""
    for path in folder.rglob("*"):
        if path.is_file() and path.relative_to(folder).as_posix() not in files:
            path.unlink()
            forget(folder.parent)  # Sphinx would leave its page in the site
    for name, data in files.items():
        path = folder / name
        if path.is_file() and path.read_bytes() == data:
            continue
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(data)


def run_sphinx(work, jobs, version):
    environment = dict(os.environ,
                       KAZ_SITE_VERSION=version,
                       KAZ_SITE_STATIC=str(HERE / "static"),
                       LC_ALL="C.UTF-8",
                       PYTHONDONTWRITEBYTECODE="1",
                       PYTHONHASHSEED="0")
    # -a: pages that have not changed are not read again, but written: links into changed ones are checked.
    command = [
        PYTHON, "-m", "sphinx", "-a", "-W", "--keep-going", "-j",
        str(jobs), "-b", "html", "-c",
        str(HERE), "-d",
        str(work / "doctrees"),
        str(work / "source"),
        str(work / "html")
    ]
    begin = time.monotonic()
    with tempfile.TemporaryFile("w+") as warnings:
        process = subprocess.Popen(command,
                                   env=environment,
                                   stdout=subprocess.PIPE,
                                   stderr=warnings,
                                   start_new_session=True)
        try:
            show_progress(process.stdout)
            process.wait()
        except BaseException:  # Ctrl-C: what is half done does not stay to be taken for whole
            os.killpg(process.pid, signal.SIGKILL)  # and its workers
            process.wait()
            forget(work)
            raise
        warnings.seek(0)
        # Paths as they are in the tree, so that a page's line can be found.
        sys.stderr.write(warnings.read().replace(str(work / "source") + "/", ""))
    if process.returncode:
        # Sphinx would keep what it has read and be silent about it the next time.
        forget(work)
        raise pages.SiteError(
            "Sphinx failed (see above). Line numbers refer to the staged pages in "
            f"{work / 'source'}, which have no comment lines")
    say(f"Sphinx took {time.monotonic() - begin:.0f} s")


def show_progress(output):
    """A line for each fifth of what Sphinx reads and writes."""
    shown = None
    rest = b""
    while chunk := os.read(output.fileno(), 65536):
        *lines, rest = re.split(rb"[\r\n]+", rest + chunk)
        for line in lines:
            found = re.search(rb"(reading|writing)[^\[]*\[ *(\d+)%\]", line)
            now = (found[1].decode(), int(found[2]) // 20 * 20) if found else shown
            if now != shown:
                say(f"{now[0]}, {now[1]} %")
            shown = now


def mend_theme(html):
    """Debian's theme is made for a web server: its script is a module, which browsers do not load from
    file://, and its style imports another one by an absolute path; it has dark colours only for who presses
    the button. And Sphinx's search reads each page that it found for an excerpt, which browsers refuse there.
    Here all of it works in any browser from anywhere, and dark is what the system's settings say."""
    scripts, styles = html / "_static/scripts", html / "_static/styles"
    script, style = (scripts / "furo.js").read_text(), (styles / "furo.css").read_text()
    module = 'import Gumshoe from "./gumshoe-patched.js";\n'
    if module in script:
        (scripts / "furo.js").write_text((scripts / "gumshoe-patched.js").read_text() +
                                         script.replace(module, ""))
    style = style.replace("@import url(/javascript/normalize.css/", "@import url(")
    dark = re.search(r'body\[data-theme="dark"\] (\{[^}]*--color-background-primary[^}]*\})', style)
    if "prefers-color-scheme" not in style:
        if not dark:
            raise pages.SiteError(
                f"the theme's style {styles / 'furo.css'} has no dark colors as in version 2022.12.07"
            )
        style += (
            '\n@media not print { @media (prefers-color-scheme: dark) { body:not([data-theme="light"]) '
            f"{dark[1]} }} }}\n")
    (styles / "furo.css").write_text(style)
    options = html / "_static/documentation_options.js"
    excerpts = 'if (location.protocol === "file:") DOCUMENTATION_OPTIONS.SHOW_SEARCH_SUMMARY = false;\n'
    if excerpts not in options.read_text():
        options.write_text(options.read_text().rstrip() + "\n" + excerpts)
    shutil.copyfile(NORMALIZE, styles / "normalize.css")


def forget(work):
    for folder in ("doctrees", "html"):
        shutil.rmtree(work / folder, ignore_errors=True)


def replace(out, html):
    """Puts a copy of `html` at `out`: under another name first, then renamed."""
    new, old = (out.parent / f".{out.name}.{suffix}" for suffix in ("new", "old"))
    out.parent.mkdir(parents=True, exist_ok=True)
    for folder in (new, old):
        shutil.rmtree(folder, ignore_errors=True)
    try:
        shutil.copytree(html, new, ignore=shutil.ignore_patterns(".buildinfo", "objects.inv"))
    except BaseException:
        shutil.rmtree(new, ignore_errors=True)
        raise
    if out.exists():
        out.rename(old)
    new.rename(out)
    shutil.rmtree(old, ignore_errors=True)


@contextlib.contextmanager
def alone(work):
    """One build at a time in a work folder."""
    work.mkdir(parents=True, exist_ok=True)
    with (work / "lock").open("w") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            say(f"waiting for another build in {work}")
            fcntl.flock(lock, fcntl.LOCK_EX)
        yield


def build(out, work, jobs):
    if out.exists() and not (out / "searchindex.js").exists() and any(out.iterdir()):
        raise pages.SiteError(f"{out} exists and is not a site, and would be replaced; give another --out")
    say("pages and public headers")
    files = staged()
    version = site_version()
    now = digest(files, f"{version} {sphinx_version()}")
    stamp = work / "digest"
    if out.exists() and stamp.exists() and stamp.read_text() == f"{now} {out}":
        say(f"nothing has changed: {out / 'index.html'}")
        return
    stamp.unlink(missing_ok=True)
    count = sum(name.endswith(".md") for name in files)
    say(f"Sphinx over {count} pages: half a minute, more on a busy machine")
    settings = work / "settings"
    own = version + hashlib.sha256((HERE / "conf.py").read_bytes()).hexdigest()
    if not settings.exists() or settings.read_text() != own:
        forget(work)
    write_source(work / "source", files)
    run_sphinx(work, jobs, version)
    settings.write_text(own)
    mend_theme(work / "html")
    replace(out, work / "html")
    stamp.write_text(f"{now} {out}")
    say(f"first page: {out / 'index.html'}")


def positive(text):
    number = int(text)
    if number < 1:
        raise ValueError
    return number


def main():
    parser = argparse.ArgumentParser(usage=__doc__.split("\n", 1)[0].removeprefix("usage: "),
                                     description=__doc__.split("\n", 2)[2],
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "out/site", help="folder of the site")
    parser.add_argument("--work",
                        type=pathlib.Path,
                        default=ROOT / "build/site",
                        help="folder of files for the next build")
    parser.add_argument("--jobs", type=positive, default=os.cpu_count(), help="number of parallel processes")
    parser.add_argument("--packages",
                        action="store_true",
                        help="print the required Debian packages and exit")
    options = parser.parse_args()
    if options.packages:
        print(PACKAGES)
        return
    try:
        with alone(options.work.resolve()):
            build(options.out.resolve(), options.work.resolve(), options.jobs)
    except pages.SiteError as error:
        sys.exit(f"site: {error}")
    except shutil.Error as error:  # of many files: the first says what it is
        sys.exit(f"site: cannot write the site: {error.args[0][0][2]}")
    except OSError as error:
        sys.exit(f"site: cannot write the site: {error}")
    except KeyboardInterrupt:
        sys.exit(130)


main()
