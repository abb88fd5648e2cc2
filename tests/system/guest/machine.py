# A virtual machine with a Debian kernel: its files, its devices, and commands that run in it.
# SPDX-License-Identifier: Apache-2.0
"""QEMU without KVM, a kernel unpacked from its Debian package (nothing of it is installed), and an archive in
memory with the first process and modules. Programs are those of this machine: its root is mounted there, read
only (9P), with one folder for results."""

import contextlib
import ctypes
import json
import lzma
import pathlib
import queue
import re
import shutil
import signal
import socket
import stat
import struct
import subprocess
import sys
import tarfile
import threading
import time

# Folders of the kernel package whose modules are kept.
FAMILIES = ("drivers/media/", "drivers/usb/", "drivers/net/can/", "net/can/", "drivers/virtio/", "net/9p/",
            "fs/9p/", "fs/netfs/", "fs/fscache/", "drivers/char/", "drivers/input/", "drivers/hid/",
            "crypto/", "lib/", "drivers/base/")
LOOPBACK = "v4l2loopback"
PATIENCE_S = 1500  # ends a hang, also of a busy machine


def die_with_parent():
    """In a new process: it ends when the one that started it does, however that ends (prctl(2))."""
    ctypes.CDLL(None).prctl(1, signal.SIGKILL)  # PR_SET_PDEATHSIG


class Missing(Exception):
    """What a test in the machine needs and is not there."""


class Crashed(RuntimeError):
    """QEMU 7.2 crashes in about one of ten unpluggings of its USB adapter: nothing of what is tested."""


def fetch(kernels):
    """Downloads and unpacks the kernel that Debian has at present, if it is not there yet, with the module
    that makes a video device out of a program's pictures, built for it."""
    depends = subprocess.run(["apt-cache", "depends", "linux-image-amd64"], text=True,
                             capture_output=True, check=True).stdout
    found = re.search(r"Depends: linux-image-(\S+)", depends)
    if not found:
        sys.exit("apt knows no linux-image-amd64: run apt-get update as root")
    version = found.group(1)
    package = f"linux-image-{version}"
    uris = subprocess.run(["apt-get", "download", "--print-uris", package], text=True,
                          capture_output=True, check=True).stdout
    folder = kernels / uris.split()[1].removesuffix(".deb")
    if (folder / "modules" / f"{LOOPBACK}.ko").exists():
        return
    print(f"kernel: downloading {folder.name} (85 MB with what modules are built with, once)", flush=True)
    part = kernels / "part"
    shutil.rmtree(part, ignore_errors=True)
    (part / "modules").mkdir(parents=True)
    kit = part / "kit"
    kit.mkdir()
    common = re.sub(r"-[^-]*$", "-common", version)
    series = ".".join(version.split(".")[:2])
    compiler = subprocess.run(["apt-cache", "depends", f"linux-headers-{version}"], text=True,
                              capture_output=True, check=True).stdout
    compilers = re.findall(r"Depends: (linux-compiler-\S+)", compiler)
    # As root apt would warn that its own user cannot write here.
    subprocess.run(["apt-get", "download", "-q", "-o", "APT::Sandbox::User=root", package,
                    f"linux-headers-{version}", f"linux-headers-{common}", f"linux-kbuild-{series}",
                    *compilers, "v4l2loopback-dkms"], cwd=kit, check=True)
    image = next(kit.glob("linux-image-*.deb"))
    unpack(image, part)
    image.unlink()
    build_loopback(kit, version, part / "modules")
    shutil.rmtree(kit)
    shutil.rmtree(folder, ignore_errors=True)
    part.rename(folder)


def unpack(package, folder):
    """The kernel itself and modules, without folders: their names differ."""
    stream = subprocess.Popen(["dpkg-deb", "--fsys-tarfile", package], stdout=subprocess.PIPE)
    with tarfile.open(fileobj=stream.stdout, mode="r|") as archive:
        for member in archive:
            path = pathlib.PurePosixPath(member.name)
            if path.name.startswith("vmlinuz-"):
                data = archive.extractfile(member).read()
                (folder / "vmlinux").write_bytes(unpack_kernel(data))
            elif path.suffix == ".ko" and member.name.partition("/kernel/")[2].startswith(FAMILIES):
                (folder / "modules" / path.name).write_bytes(archive.extractfile(member).read())
    if stream.wait() != 0:
        sys.exit(f"{package} cannot be unpacked")


def build_loopback(kit, version, modules):
    """With the headers where they were unpacked: their makefiles name /usr/src and /usr/lib, so those names
    are replaced there."""
    for package in kit.glob("*.deb"):
        subprocess.run(["dpkg-deb", "-x", package, kit], check=True)
    source = next((kit / "usr/src").glob("v4l2loopback-*"))
    headers = kit / "usr/src" / f"linux-headers-{version}"
    for path in (headers / "Makefile", headers / ".kernelvariables"):
        path.write_text(path.read_text().replace("/usr/src/", f"{kit.resolve()}/usr/src/"))
    for name in ("scripts", "tools"):
        link = headers / name
        if link.is_symlink():
            link.unlink()
            link.symlink_to(next((kit / "usr/lib").glob("linux-kbuild-*")).resolve() / name)
    made = subprocess.run(["make", "-s", "-C", headers, f"M={source.resolve()}", "modules"], text=True,
                          capture_output=True)
    if made.returncode != 0:
        sys.exit(f"{LOOPBACK} cannot be built:\n{made.stdout}{made.stderr}")
    shutil.copy(source / f"{LOOPBACK}.ko", modules)


def unpack_kernel(image):
    """The ELF file in a bzImage: unpacking it here, once, saves seconds of each start. Fields of the
    header: Documentation/x86/boot.rst of the kernel. A word with the size follows the xz stream."""
    setup_sectors = image[0x1F1] or 4
    offset, length = struct.unpack_from("<II", image, 0x248)
    start = (setup_sectors + 1) * 512 + offset
    return lzma.LZMADecompressor().decompress(image[start:start + length])


def kernel(kernels):
    """The folder of the latest kernel. Raises Missing."""
    if not shutil.which("qemu-system-x86_64"):
        raise Missing("qemu-system-x86_64 is missing")
    found = sorted(kernels.glob("linux-image-*"), key=lambda path: path.stat().st_mtime)
    if not found:
        raise Missing(f"there is no kernel in {kernels}")
    if not (found[-1] / "modules" / f"{LOOPBACK}.ko").exists():
        raise Missing(f"{found[-1].name} has no module {LOOPBACK}")
    return found[-1]


def load_order(modules, wanted):
    """Files with parameters: the modules wanted, (name, parameters), and what they need, those first."""
    files = {path.stem.replace("-", "_"): path for path in modules.glob("*.ko")}
    order = {}

    def add(one, parameters=""):
        path = files.get(one.replace("-", "_"))
        if path is None:
            raise Missing(f"the module {one} is not among the kernel's in {modules}")
        needed = re.search(rb"\0depends=([^\0]*)\0", path.read_bytes()).group(1).decode()
        for other in filter(None, needed.split(",")):
            add(other)
        order.setdefault(path, parameters)

    for name, parameters in wanted:
        add(name, parameters)
    return order


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


def initial_files(init, kernel_folder, modules):
    order = load_order(kernel_folder / "modules", modules)
    files = {"init": init.read_bytes()}
    for path in order:
        files[f"modules/{path.name}"] = path.read_bytes()
    files["modules/list"] = "".join(f"{path.name} {text}".rstrip() + "\n"
                                    for path, text in order.items()).encode()
    entries = [(folder, stat.S_IFDIR | 0o755, b"", 0) for folder in ("dev", "modules", "root")]
    entries.append(("dev/console", stat.S_IFCHR | 0o600, b"", 5 << 8 | 1))
    entries += [(path, stat.S_IFREG | 0o755, content, 0) for path, content in sorted(files.items())]
    return archive(entries)


# Found by the first process, which loads them: the root of this machine, ports of virtio.
BASIC = [("virtio_pci", ""), ("9pnet_virtio", ""), ("9p", ""), ("virtio_console", "")]


# The machine's clock counts its instructions, one nanosecond each, and skips its waits: neither the emulated
# processor's slowness nor a busy machine outside makes a program in it late.
COUNTED = ["-icount", "shift=0,sleep=off"]


class Machine:
    """Started by its constructor; commands run in its root, one after the other. `out`: the folder that it
    may write, at /mnt there. `devices`: further arguments of QEMU, `files`: descriptors that they name."""

    def __init__(self, init, kernel_folder, out, modules=(), devices=(), files=()):
        self.out = out.resolve()
        self.out.mkdir(parents=True, exist_ok=True)
        initrd = self.out / "initrd.cpio"
        initrd.write_bytes(initial_files(init, kernel_folder, [*BASIC, *modules]))
        self.monitor_path = self.out / "qmp"
        self.command = [
            # Copies by single bytes, which these features announce as fast, are slow in an emulator.
            "qemu-system-x86_64", "-accel", "tcg", "-machine", "q35", "-cpu", "max,erms=off,fsrm=off",
            "-m", "512",
            "-smp", "1", "-nodefaults", "-no-user-config", "-display", "none", "-no-reboot",
            "-serial", "stdio", "-kernel", str(kernel_folder / "vmlinux"), "-initrd", str(initrd),
            "-append", "console=ttyS0 quiet panic=-1 nokaslr mitigations=off random.trust_cpu=on "
            "cryptomgr.notests 8250.nr_uarts=4",
            "-fsdev", "local,id=root,path=/,security_model=none,readonly=on,multidevs=remap",
            "-device", "virtio-9p-pci,fsdev=root,mount_tag=root",
            "-fsdev", f"local,id=out,path={self.out},security_model=none",
            "-device", "virtio-9p-pci,fsdev=out,mount_tag=out",
            "-qmp", f"unix:{self.monitor_path},server=on,wait=off", *devices]
        self.process = subprocess.Popen(self.command, stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                        stderr=subprocess.STDOUT, pass_fds=files,
                                        preexec_fn=die_with_parent)
        self.console = []  # every line that it printed
        self._lines = queue.Queue()
        threading.Thread(target=self._read, daemon=True).start()
        self._until(r"^READY$")

    def _read(self):
        for line in self.process.stdout:
            text = line.decode(errors="replace").rstrip("\r\n")
            self.console.append(text)
            self._lines.put(text)
        self._lines.put(None)

    def _until(self, pattern):
        lines, end = [], time.monotonic() + PATIENCE_S
        while True:
            try:
                line = self._lines.get(timeout=max(0.0, end - time.monotonic()))
            except queue.Empty:
                self.stop()
                raise RuntimeError(f"the machine did not print /{pattern}/ in {PATIENCE_S} s; it printed\n" +
                                   "\n".join(self.console[-40:])) from None
            if line is None:
                self.check_crash()
                raise RuntimeError("the machine ended; it printed\n" + "\n".join(self.console[-40:]))
            if found := re.search(pattern, line):
                return found, lines
            lines.append(line)

    def run(self, command, check=True):
        """One line of shell. Returns (exit status, what it printed)."""
        self.process.stdin.write(command.encode() + b"\n")
        self.process.stdin.flush()
        found, lines = self._until(r"^EXIT:(\d+)$")
        code, text = int(found.group(1)), "\n".join(lines).strip()
        if check and code != 0:
            raise RuntimeError(f"in the machine `{command}` ended with {code}:\n{text}")
        return code, text

    def qmp(self, execute, **arguments):
        """One command of QEMU's monitor protocol."""
        with contextlib.closing(socket.socket(socket.AF_UNIX)) as monitor:
            monitor.connect(str(self.monitor_path))
            stream = monitor.makefile("rw")
            stream.readline()
            for name, values in (("qmp_capabilities", {}), (execute, arguments)):
                stream.write(json.dumps({"execute": name, "arguments": values}) + "\n")
                stream.flush()
                while "event" in (answer := json.loads(stream.readline())):
                    pass
            if "error" in answer:
                raise RuntimeError(f"QEMU: {execute}: {answer['error']['desc']}")
            return answer["return"]

    def power_off(self):
        with contextlib.suppress(BrokenPipeError):
            self.process.stdin.write(b"poweroff\n")
            self.process.stdin.close()
        try:
            self.process.wait(20)
        except subprocess.TimeoutExpired:
            self.stop()

    def stop(self):
        self.process.kill()
        self.process.wait()

    def __enter__(self):
        return self

    def check_crash(self):
        with contextlib.suppress(subprocess.TimeoutExpired):
            if (ended := self.process.wait(2)) < 0:
                raise Crashed(f"QEMU itself was ended by signal {-ended}")

    def __exit__(self, kind, *_):
        try:
            if kind is not None:
                self.check_crash()
        finally:
            self.power_off()
            (self.out / "console.txt").write_text("\n".join(self.console) + "\n")


if __name__ == "__main__":  # usage: machine.py FOLDER
    try:
        fetch(pathlib.Path(sys.argv[1]))
    except subprocess.CalledProcessError as failed:
        sys.exit(f"`{' '.join(map(str, failed.cmd))}` failed: is the network up?")
