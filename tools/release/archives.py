# Archives whose bytes depend on their contents alone: not on user, umask, clock, time zone, folder or order.
# SPDX-License-Identifier: Apache-2.0
"""Functions for release.py: tar.gz of a folder and of a commit, and SHA256SUMS."""

import contextlib
import gzip
import hashlib
import os
import pathlib
import stat
import subprocess
import tarfile


class Refused(Exception):
    """One sentence: what, where, what to do."""


@contextlib.contextmanager
def compressed(path):
    """A gzip file at `path` without name and time in its header."""
    with path.open("xb") as file, gzip.GzipFile(
        filename="", mode="wb", compresslevel=9, fileobj=file, mtime=0
    ) as out:
        yield out


def _entries(folder):
    """Paths below `folder`, sorted by the bytes of their names, a folder before what is in it."""
    found = [path for path in folder.rglob("*")]
    return sorted(found, key=lambda path: os.fsencode(path.relative_to(folder).as_posix()))


def _check_link(folder, path):
    """A link has to stay in the folder: elsewhere it leads to nothing, or to something else."""
    target = os.readlink(path)
    resolved = os.path.normpath(os.path.join(path.parent, target))
    if os.path.isabs(target) or os.path.commonpath([resolved, folder]) != str(folder):
        raise Refused(f"{path}: a link to {target}, outside of {folder}; install the file itself")


def _member(folder, path, prefix, seconds):
    info = tarfile.TarInfo(f"{prefix}/{path.relative_to(folder).as_posix()}")
    mode = path.lstat().st_mode
    info.mtime, info.uid, info.gid, info.uname, info.gname = seconds, 0, 0, "root", "root"
    info.mode = 0o644
    if stat.S_ISLNK(mode):
        _check_link(folder, path)
        info.type, info.linkname, info.mode = tarfile.SYMTYPE, os.readlink(path), 0o777
    elif stat.S_ISDIR(mode):
        info.type, info.mode = tarfile.DIRTYPE, 0o755
    elif stat.S_ISREG(mode):
        info.size = path.lstat().st_size
        if mode & stat.S_IXUSR:
            info.mode = 0o755
    else:
        raise Refused(f"{path}: neither file, folder nor link; remove it")
    return info


def archive_folder(folder, target, prefix, seconds):
    """`folder` as `prefix`/ in the tar.gz `target`: sorted, of root, at `seconds`, modes 644 and 755."""
    folder = pathlib.Path(folder).absolute()
    with compressed(target) as out, tarfile.open(fileobj=out, mode="w", format=tarfile.PAX_FORMAT) as tar:
        for path in _entries(folder):
            info = _member(folder, path, prefix, seconds)
            if info.isreg():
                with path.open("rb") as source:
                    tar.addfile(info, source)
            else:
                tar.addfile(info)


def archive_commit(root, commit, target, prefix):
    """The tree of `commit` as `prefix`/ in the tar.gz `target`, without the user's settings of git."""
    command = [
        "git",
        "-C",
        str(root),
        "-c",
        "tar.umask=0022",
        "-c",
        "core.autocrlf=false",
        "-c",
        "core.eol=lf",
        "-c",
        "core.attributesFile=/dev/null",
        "archive",
        "--format=tar",
        f"--prefix={prefix}/",
        commit,
    ]
    with compressed(target) as out:
        git = subprocess.Popen(command, stdout=subprocess.PIPE)
        try:
            while block := git.stdout.read(1 << 20):
                out.write(block)
        finally:
            git.stdout.close()
            status = git.wait()
    if status != 0:
        raise Refused(f"git archive of {commit} ended with {status} (above)")


def sums(folder):
    """Lines as of sha256sum for the files in `folder`, sorted."""
    lines = []
    for path in _entries(folder):
        digest = hashlib.sha256()
        with path.open("rb") as source:
            while block := source.read(1 << 20):
                digest.update(block)
        lines.append(f"{digest.hexdigest()}  {path.relative_to(folder).as_posix()}\n")
    return "".join(lines)
