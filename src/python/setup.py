"""Builds the package as a wheel that holds every library it needs but those of the C and C++ systems.

CMake compiles; $BESPOKE_BUILD_DIRECTORY, where it is set, names a build of this checkout to take the module from.
"""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext
from wheel.bdist_wheel import bdist_wheel

CHECKOUT = Path(__file__).resolve().parents[2]
BUILD = CHECKOUT / "build/wheel"

# What PEP 600 expects of any system; its version of glibc is in the wheel's tag.
OF_THE_SYSTEM = re.compile(r"lib(c|m|dl|rt|pthread|stdc\+\+|gcc_s)\.so|ld-linux")


def version():
    text = (CHECKOUT / "CMakeLists.txt").read_text()
    return re.search(r"project\(bespoke VERSION ([\d.]+)", text)[1]


def shared_libraries(module):
    """Names and paths of the libraries that a module is linked to, and of those that these are."""
    listing = subprocess.run(["ldd", module], check=True, capture_output=True, text=True).stdout
    if missing := re.findall(r"(\S+) => not found", listing):
        sys.exit(f"{module}: needs {', '.join(missing)}; run tools/setup")
    found = re.findall(r"(\S+) => (/\S+)", listing)
    return {name: Path(path).resolve() for name, path in found if not OF_THE_SYSTEM.match(name)}


def copy_licence(library, directory):
    """What Debian says of the rights in the package that a library is from."""
    names = [str(library), str(library).removeprefix("/usr")]  # Debian 12 knows some by their older place
    owner = subprocess.run(["dpkg", "-S", *names], capture_output=True, text=True).stdout.partition(":")[0]
    licence = Path("/usr/share/doc", owner or "-", "copyright")
    if not licence.exists():
        sys.exit(f"{library}: is from no package of the system, so that its licence cannot be passed on")
    shutil.copy(licence, directory / f"{owner}.copyright")


class CMakeExtension(build_ext):
    def build_extension(self, extension):
        given = os.environ.get("BESPOKE_BUILD_DIRECTORY")
        build = Path(given or self.build_temp).resolve()
        if not given:
            options = {
                "CMAKE_BUILD_TYPE": "Release",
                "Python3_EXECUTABLE": sys.executable,
                "BESPOKE_PYTHON": "ON",
                **{f"BESPOKE_BUILD_{part}": "OFF" for part in ("TOOLS", "SAMPLES", "TESTS", "BENCHMARKS")},
            }
            definitions = [f"-D{name}={value}" for name, value in options.items()]
            subprocess.run(["cmake", "-S", CHECKOUT, "-B", build, "-G", "Ninja", *definitions], check=True)
        subprocess.run(["cmake", "--build", build, "--target", "bespoke_engine"], check=True)
        (built,) = (build / "python" / "bespoke").glob("_engine.*.so")

        module = Path(self.get_ext_fullpath(extension.name))
        libraries = module.parent / "libraries"
        libraries.mkdir(parents=True, exist_ok=True)
        shutil.copy2(built, module)
        for name, path in shared_libraries(module).items():
            shutil.copy2(path, libraries / name)
            copy_licence(path, libraries)
        # DT_RPATH, not DT_RUNPATH: the libraries find one another by it as well.
        subprocess.run(["patchelf", "--force-rpath", "--set-rpath", "$ORIGIN/libraries", module], check=True)
        subprocess.run(["strip", "--strip-unneeded", module], check=True)


class PlatformWheel(bdist_wheel):
    def get_tag(self):
        python, abi, platform = super().get_tag()
        glibc = os.confstr("CS_GNU_LIBC_VERSION").split()[1].replace(".", "_")
        return python, abi, platform.replace("linux", f"manylinux_{glibc}", 1)


BUILD.mkdir(parents=True, exist_ok=True)
setup(
    version=version(),
    packages=["bespoke"],
    package_data={"bespoke": ["py.typed", "_engine.pyi"]},
    ext_modules=[Extension("bespoke._engine", [])],
    options={"build": {"build_base": str(BUILD)}, "egg_info": {"egg_base": str(BUILD)}},
    cmdclass={"build_ext": CMakeExtension, "bdist_wheel": PlatformWheel},
)
