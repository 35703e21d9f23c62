"""pip install ./pipeline/python: the package with its extension, built by CMake out of this clone.

It takes what Debian 12 has (.ci/install lists it) and no network. PALPATE_CMAKE_ARGS adds arguments for CMake.
"""

import os
import re
import subprocess
import sys
from pathlib import Path

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

ROOT = Path(__file__).resolve().parents[2]
VERSION = re.search(r"project\(palpate VERSION (\S+)", (ROOT / "CMakeLists.txt").read_text())[1]


class CMakeBuild(build_ext):
    def build_extension(self, ext):
        package = Path(self.get_ext_fullpath(ext.name)).resolve().parent
        build = ROOT / "build-pip"
        configure = ["cmake", "-S", ROOT, "-B", build, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release"]
        configure += ["-DCMAKE_UNITY_BUILD=ON", "-DCMAKE_UNITY_BUILD_BATCH_SIZE=10", "-DBUILD_TESTING=OFF"]
        configure += ["-DPALPATE_PYTHON=ON", "-DPALPATE_PYTHON_INSTALL=.", f"-DPython_EXECUTABLE={sys.executable}"]
        configure += os.environ.get("PALPATE_CMAKE_ARGS", "").split()
        subprocess.run(configure, check=True)
        subprocess.run(["cmake", "--build", build, "--target", "palpate_python"], check=True)
        subprocess.run(
            ["cmake", "--install", build, "--component", "python", "--prefix", package.parent], check=True
        )


setup(
    name="palpate",
    version=VERSION,
    description="From a mesh to a calibrated real-time model",
    license="MIT",
    packages=["palpate"],
    package_data={"palpate": ["py.typed", "*.pyi"]},
    ext_modules=[Extension("palpate._core", sources=[])],
    cmdclass={"build_ext": CMakeBuild},
    python_requires=">=3.9",
    install_requires=["numpy"],
    extras_require={"all": ["pandas", "xarray", "arviz", "meshio", "pyvista", "tqdm", "matplotlib"]},
    zip_safe=False,
)
