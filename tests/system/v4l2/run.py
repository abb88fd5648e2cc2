# Runs a test program against the modules of a Debian kernel, in a virtual machine.
# SPDX-License-Identifier: Apache-2.0
"""QEMU without KVM, a kernel unpacked from its Debian package (nothing of it is installed), and an
archive in memory with the program and its libraries. Exit status: 0 passed, 1 failed, 77 something is
missing (it says what)."""

import argparse
import lzma
import pathlib
import re
import shutil
import stat
import struct
import subprocess
import sys
import tarfile
import time

# Two cameras, one that gives its pictures in several planes, one node that only takes pictures.
VIVID = ("n_devs=4 node_types=0x1,0x1,0x1,0x100 num_inputs=1,1,1,1 input_types=0,0,0,0 "
         "num_outputs=1,1,1,1 output_types=1,1,1,1 multiplanar=1,1,2,1 vid_cap_nr=0,1,2,-1 "
         "vid_out_nr=-1,-1,-1,3")
MODULE = "vivid"
SECONDS = 300  # for everything; it takes 20 to 60


def skip(text):
    print(f"SKIPPED: {text}; `./tools/dev camera-test` gets it")
    sys.exit(77)


def fetch(kernels):
    """Downloads and unpacks the kernel that Debian has at present, if it is not there yet."""
    depends = subprocess.run(["apt-cache", "depends", "linux-image-amd64"], text=True,
                             capture_output=True, check=True).stdout
    found = re.search(r"Depends: (linux-image-\S+)", depends)
    if not found:
        sys.exit("apt knows no linux-image-amd64: run apt-get update as root")
    package = found.group(1)
    uris = subprocess.run(["apt-get", "download", "--print-uris", package], text=True,
                          capture_output=True, check=True).stdout
    name = uris.split()[1].removesuffix(".deb")
    folder = kernels / name
    if folder.exists():
        return
    print(f"kernel: downloading {name} (about 70 MB, once)", flush=True)
    part = kernels / "part"
    shutil.rmtree(part, ignore_errors=True)
    (part / "modules").mkdir(parents=True)
    # As root apt would warn that its own user cannot write here.
    subprocess.run(["apt-get", "download", "-q", "-o", "APT::Sandbox::User=root", package], cwd=part,
                   check=True)
    unpack(next(part.glob("*.deb")), part)
    part.rename(folder)


def unpack(package, folder):
    """The kernel itself and the modules of media devices."""
    stream = subprocess.Popen(["dpkg-deb", "--fsys-tarfile", package], stdout=subprocess.PIPE)
    with tarfile.open(fileobj=stream.stdout, mode="r|") as archive:
        for member in archive:
            path = pathlib.PurePosixPath(member.name)
            if path.name.startswith("vmlinuz-"):
                data = archive.extractfile(member).read()
                (folder / "vmlinux").write_bytes(unpack_kernel(data))
            elif path.suffix == ".ko" and "kernel/drivers/media/" in member.name:
                (folder / "modules" / path.name).write_bytes(archive.extractfile(member).read())
    if stream.wait() != 0:
        sys.exit(f"{package} cannot be unpacked")
    package.unlink()


def unpack_kernel(image):
    """The ELF file in a bzImage: unpacking it here, once, saves seconds of each start. Fields of the
    header: Documentation/x86/boot.rst of the kernel. A word with the size follows the xz stream."""
    setup_sectors = image[0x1F1] or 4
    offset, length = struct.unpack_from("<II", image, 0x248)
    start = (setup_sectors + 1) * 512 + offset
    return lzma.LZMADecompressor().decompress(image[start:start + length])


def load_order(modules, name):
    """Files of a module and what it needs, needed ones first."""
    files = {path.stem.replace("-", "_"): path for path in modules.glob("*.ko")}
    order = []

    def add(one):
        path = files[one.replace("-", "_")]
        needed = re.search(rb"\0depends=([^\0]*)\0", path.read_bytes()).group(1).decode()
        for other in filter(None, needed.split(",")):
            add(other)
        if path not in order:
            order.append(path)

    add(name)
    return order


def libraries(program):
    """Shared libraries and loader, at the paths where the program looks for them."""
    text = subprocess.run(["ldd", program], text=True, capture_output=True, check=True).stdout
    return sorted(set(re.findall(r"(/\S+) \(0x", text)))


def archive(entries):
    """The newc format of cpio: entries of (path, mode, content, device)."""
    blob = bytearray()
    for number, (path, mode, content, device) in enumerate([*entries, ("TRAILER!!!", 0, b"", 0)], 1):
        name = path.encode() + b"\0"
        fields = (number, mode, 0, 0, 1, 0, len(content), 0, 0, device >> 8, device & 255, len(name), 0)
        blob += b"070701" + b"".join(b"%08X" % field for field in fields) + name
        blob += b"\0" * (-len(blob) % 4) + content
        blob += b"\0" * (-len(blob) % 4)
    return bytes(blob)


def initial_files(init, test, modules):
    files = {"init": init.read_bytes(), "test": test.read_bytes()}
    order = load_order(modules, MODULE)
    for path in order:
        files[f"modules/{path.name}"] = path.read_bytes()
    lines = [path.name + (" " + VIVID if path.stem == MODULE else "") for path in order]
    files["modules/list"] = "".join(line + "\n" for line in lines).encode()
    for library in libraries(test):
        files[library.lstrip("/")] = pathlib.Path(library).read_bytes()
    folders = {"dev"}
    for path in files:
        folders.update(str(parent) for parent in pathlib.PurePosixPath(path).parents if str(parent) != ".")
    entries = [(folder, stat.S_IFDIR | 0o755, b"", 0) for folder in sorted(folders)]
    entries.append(("dev/console", stat.S_IFCHR | 0o600, b"", 5 << 8 | 1))
    entries += [(path, stat.S_IFREG | 0o755, content, 0) for path, content in sorted(files.items())]
    return archive(entries)


def boot(kernel, initrd):
    """What the virtual machine prints until it switches itself off."""
    command = ["qemu-system-x86_64", "-accel", "tcg", "-machine", "q35", "-cpu", "max", "-m", "384",
               "-smp", "1", "-nodefaults", "-no-user-config", "-display", "none", "-no-reboot",
               "-serial", "stdio", "-kernel", kernel, "-initrd", initrd, "-append",
               "console=ttyS0 quiet panic=-1 nokaslr mitigations=off random.trust_cpu=on "
               "cryptomgr.notests"]
    try:
        ran = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, timeout=SECONDS)
        out, errors = ran.stdout, ran.stderr
    except subprocess.TimeoutExpired as late:
        out, errors = late.stdout or b"", b"not done after %d s" % SECONDS
    return out.decode(errors="replace").replace("\r", ""), errors.decode(errors="replace")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    for name in ("--init", "--test", "--kernels", "--out"):
        parser.add_argument(name, type=pathlib.Path, required=True)
    parser.add_argument("--fetch", action="store_true", help="get a kernel if there is none")
    arguments = parser.parse_args()
    if not shutil.which("qemu-system-x86_64"):
        skip("qemu-system-x86_64 is missing")
    if arguments.fetch:
        fetch(arguments.kernels)
    kernels = sorted(arguments.kernels.glob("linux-image-*"), key=lambda path: path.stat().st_mtime)
    if not kernels:
        skip("there is no kernel in build/kernels")
    arguments.out.mkdir(parents=True, exist_ok=True)
    initrd = arguments.out / "initrd.cpio"
    initrd.write_bytes(initial_files(arguments.init, arguments.test, kernels[-1] / "modules"))
    print(f"kernel: {kernels[-1].name}", flush=True)
    start = time.monotonic()
    printed, errors = boot(kernels[-1] / "vmlinux", initrd)
    (arguments.out / "console.txt").write_text(printed)
    passed = re.findall(r"^\[       OK \] (\S+) \((\d+) ms\)", printed, re.M)
    for name, milliseconds in passed:
        print(f"passed {name} ({int(milliseconds) / 1000:.1f} s)")
    for name in re.findall(r"^\[  FAILED  \] (\S+) \(\d+ ms\)", printed, re.M):
        print(f"FAILED {name}")
    good = "EXIT:0\n" in printed and passed
    if not good:
        print(printed[-20000:], errors, sep="\n")
    print(f"{len(passed)} cases passed in {time.monotonic() - start:.0f} s, "
          f"{'all is well' if good else 'not all is well'}; console: {arguments.out}/console.txt")
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
