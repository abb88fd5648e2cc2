# Makes a wheel of the package kaz: module, robot, worlds, firmware; CMake builds in build/release.
# SPDX-License-Identifier: Apache-2.0
"""python3 -m venv --system-site-packages ENV && ENV/bin/pip install --no-build-isolation PATH/python"""

import os
import pathlib
import re
import shutil
import subprocess

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext
from setuptools.command.build_py import build_py

HERE = pathlib.Path(__file__).resolve().parent
TREE = HERE.parent
# KAZ_BUILD: a build folder that has all, which is taken as it is.
GIVEN = os.environ.get("KAZ_BUILD")
BUILD = pathlib.Path(GIVEN) if GIVEN else TREE / "build/release"
VERSION = re.search(r"project\(kaz VERSION ([0-9.]+)", (TREE / "CMakeLists.txt").read_text()).group(1)


def make():
    if not GIVEN:
        build()
    if not list((BUILD / "python/kaz").glob("_kaz*.so")):
        raise SystemExit("kaz: the module was not built: apt-get install pybind11-dev python3-dev "
                         "python3-numpy")


def build():
    subprocess.run(["cmake", "--preset", "release"], cwd=TREE, check=True)
    jobs = os.environ.get("KAZ_JOBS") or str(os.cpu_count())
    subprocess.run(["cmake", "--build", BUILD, "--target", "kaz_python", "-j", jobs], cwd=TREE, check=True)


class BuildModule(build_ext):
    def build_extension(self, ext):
        make()
        to = pathlib.Path(self.get_ext_fullpath(ext.name))
        to.parent.mkdir(parents=True, exist_ok=True)
        for module in (BUILD / "python/kaz").glob("_kaz*.so"):
            shutil.copy(module, to.parent / module.name)
        share = to.parent / "share"
        shutil.rmtree(share, ignore_errors=True)
        for part in ("robot", "worlds"):
            shutil.copytree(BUILD / "share/kaz" / part, share / part)
        (share / "firmware").mkdir()
        for image in ("kaz.mot", "kaz.coff", "writer.bin"):
            shutil.copy(BUILD / "firmware" / image, share / "firmware")


setup(
    name="kaz", version=VERSION, license="Apache-2.0",
    description="A simulated desktop humanoid with its emulated servo board, its client, its vision",
    packages=["kaz"], package_data={"kaz": ["*.pyi", "py.typed"]},
    ext_modules=[Extension("kaz._kaz", [])], cmdclass={"build_ext": BuildModule, "build_py": build_py},
    install_requires=["numpy"], python_requires=">=3.11", zip_safe=False)
