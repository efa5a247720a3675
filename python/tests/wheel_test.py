"""The wheel: made without a network from the module of this build, unpacked, imported."""
import importlib.util
import os
import subprocess
import sys
import zipfile
from pathlib import Path

from cases import INVERT, ROOT, Folder, main

if not all(importlib.util.find_spec(name) for name in ("pip", "setuptools", "wheel")):
    sys.exit(77)
BUILD = Path(os.environ["PYTHONPATH"]).parent
USE = """import sys, modcal
assert modcal.__file__.startswith(sys.argv[2]), modcal.__file__
print(repr(modcal.run(sys.argv[1]).f_c_joint.tolist()))
"""


class Wheel(Folder):
    def call(self, *words, **environment):
        done = subprocess.run([sys.executable, *map(str, words)], cwd=self.folder, capture_output=True, text=True,
                              env={**os.environ, **environment})
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return done.stdout

    def test_has_the_numbers_of_the_build(self):
        self.call("-m", "pip", "wheel", ROOT, "--no-build-isolation", "--no-deps", "--no-index", "-w", self.folder,
                  MODCAL_BUILD_FOLDER=str(BUILD))
        (wheel,) = self.folder.glob("modcal-*.whl")
        there, file = self.folder / "there", self.file(INVERT)
        with zipfile.ZipFile(wheel) as packed:
            self.assertIn("modcal/py.typed", packed.namelist())
            packed.extractall(there)
        program = self.file(USE, "use.py")
        found = [self.call(program, file, place, PYTHONPATH=str(place)) for place in (there, BUILD / "python")]
        self.assertEqual(found[0], found[1])


if __name__ == "__main__":
    main()
