"""The module of the wheel, by CMake. MODCAL_BUILD_FOLDER: a folder configured with MODCAL_PYTHON to take it from."""
import os
import shutil
import subprocess
import sys
from pathlib import Path

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext


class CMakeBuild(build_ext):
    def build_extension(self, extension):
        build = os.environ.get("MODCAL_BUILD_FOLDER")
        if build is None:
            build = "build/wheel"
            subprocess.run(["cmake", "-S", ".", "-B", build, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
                            "-DMODCAL_PYTHON=ON", f"-DPython3_EXECUTABLE={sys.executable}"], check=True)
        subprocess.run(["cmake", "--build", build, "--target", "modcal_python"], check=True)
        target = Path(self.get_ext_fullpath(extension.name))
        target.parent.mkdir(parents=True, exist_ok=True)
        (module,) = Path(build, "python/modcal").glob("_core*.so")
        shutil.copy(module, target)


Path("build").mkdir(exist_ok=True)  # for setuptools' own files
setup(ext_modules=[Extension("modcal._core", [])], cmdclass={"build_ext": CMakeBuild},
      options={"egg_info": {"egg_base": "build"}})
