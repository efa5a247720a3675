"""What the tests of the package share: NAME_test.py ROOT MODCAL."""
import re
import subprocess
import sys
import tempfile
import textwrap
import unittest
from pathlib import Path

ROOT, PROGRAM = Path(sys.argv[1]), sys.argv[2]

SCENE = {
    "string": {"length": 0.33, "linear_density": 3.1e-3, "fundamental": 196, "inharmonicity": 1e-4, "modes": 12,
               "damping": {"type": "constant", "ratio": 3e-3}},
    "bow": {"position": "30 mm", "velocity": 0.1, "normal_force": 1},
    "duration": 0.2,
}
SIMULATE = {"kind": "simulate", "title": "a stroke", "scene": SCENE, "simulator": {"type": "modal_event"},
            "measurement": {"sample_rate": 12800}, "files": ["csv"]}
INVERT = {"kind": "invert", "scene": SCENE, "simulator": {"type": "modal_event"},
          "measurement": {"sample_rate": 12800, "noise_level": 0.01}}
CALIBRATE = {**INVERT, "kind": "calibrate", "model_error": {"contact": "0.4 mm"},
             "calibration": {"parameters": {"frequencies": "none", "law": True, "contact": True},
                             "objective": {"type": "force_mismatch", "weights": "transfer"},
                             "optimizer": {"type": "gsl", "algorithm": "dogleg"}}}
SWEEP = {**INVERT, "title": "three seeds", "sweep": {"product": {"seed": [1, 2, 3]}}}


def programs(page):
    """The indented blocks of a page that are Python."""
    text = (ROOT / page).read_text(encoding="utf-8")
    blocks = re.findall(r"(?:^(?:    .*)?\n)*^    .*\n", text, re.M)
    return [textwrap.dedent(block).strip() + "\n" for block in blocks if "modcal." in block and "import modcal" in block]


class Folder(unittest.TestCase):
    """A folder of its own for each test."""

    def setUp(self):
        held = tempfile.TemporaryDirectory()
        self.addCleanup(held.cleanup)
        self.folder = Path(held.name)

    def file(self, experiment, name="mine.yaml"):
        from modcal import yaml

        path = self.folder / name
        path.write_text(experiment if isinstance(experiment, str) else yaml.block(experiment), encoding="utf-8")
        return path

    def program(self, *words, code=0):
        done = subprocess.run([PROGRAM, *map(str, words)], cwd=self.folder, capture_output=True, text=True)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done.stdout


def main():
    unittest.main(argv=sys.argv[:1] + sys.argv[3:])
