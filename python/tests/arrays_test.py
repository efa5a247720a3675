"""Records as arrays: the numbers of a file, and the sentences of the program for what is no record."""

import numpy as np
from cases import ROOT, Folder, main

import modcal

STRING = {"length": 0.33, "linear_density": 1e-3, "fundamental": 293.978, "inharmonicity": 0.00011,
          "damping": {"type": "constant", "ratio": 1e-3}}


def columns():
    return np.loadtxt(ROOT / "examples/bowed_violin_d.csv", delimiter=",", comments="#", skiprows=4).T


class FromArrays(Folder):
    def setUp(self):
        super().setUp()
        self.left, self.right, self.force = columns()
        self.file_section = {"file": str(ROOT / "examples/bowed_violin_d.csv"), "left": {"channel": "R1"},
                             "right": {"channel": "R2"}, "reference": {"channel": "f_c"}}

    def experiment(self, kind, **keys):
        return {"kind": kind, "record": self.file_section, "string": STRING, "bow": {"position": 0.041018}, **keys}

    def record(self, **keys):
        return modcal.Record(rate=44100, left=self.left, right=self.right, force=self.force, **keys)

    def test_invert(self):
        found = modcal.invert(self.record(), STRING, 0.041018)
        stored = modcal.run(self.experiment("invert"))
        np.testing.assert_array_equal(found.f_c_joint, stored.f_c_joint)
        np.testing.assert_array_equal(found.f_c_joint_deviation, stored.f_c_joint_deviation)
        self.assertEqual(found.tables["identification"].columns, stored.tables["identification"].columns)

    def test_one_reaction(self):
        record = modcal.Record(rate=44100, left=self.left)
        found = modcal.invert(record, STRING, "41.018 mm", inversion={"estimator": "one_sided"})
        self.assertIn("f_c1", found.signals)

    def test_calibrate(self):
        found = modcal.calibrate(self.record(), STRING, 0.041018)
        stored = modcal.run(self.experiment("calibrate"))
        self.assertEqual(found.parameters, stored.parameters)
        np.testing.assert_array_equal(found.f_c_joint, stored.f_c_joint)
        self.assertAlmostEqual(found.parameters[0]["final"], 294.0, delta=5 * found.parameters[0]["sd"])

    def test_new_reads_an_array(self):
        record = self.record()
        text = modcal.new("invert", record, length="0.33 m")
        self.assertIn("fundamental: 293.971 Hz", text)
        self.assertEqual(len(modcal.run(text).f_c_joint), len(record))

    def test_layouts(self):
        whole = modcal.invert(self.record(), STRING, 0.041018).f_c_joint
        doubled = np.repeat(self.left, 2)
        frozen = self.right.copy()
        frozen.setflags(write=False)
        times = np.arange(self.left.size) / 44100
        record = modcal.Record(time=times, left=doubled[::2], right=frozen)
        self.assertEqual(record.rate, 44100.0)
        np.testing.assert_array_equal(modcal.invert(record, STRING, 0.041018).f_c_joint, whole)
        listed = modcal.Record(rate=44100, left=list(self.left), right=self.right.astype(">f8"))
        np.testing.assert_array_equal(modcal.invert(listed, STRING, 0.041018).f_c_joint, whole)

    def test_refused_arrays(self):
        nan = self.left.copy()
        nan[17] = np.nan
        for keys, words in (
            ({"left": nan}, "sample 17 of channel R1 is nan; repair it, or keep only what stands before or behind it"),
            ({"left": self.left.reshape(2, -1)}, "shape"),
            ({"left": []}, "is empty"),
            ({"left": np.ma.masked_less(self.left, 0.0)}, "masked samples"),
            ({"left": [[1.0], [2.0, 3.0]]}, "is no array"),
            ({"left": np.array(["a"])}, "not of real numbers"),
            ({"left": np.array([None, 1], dtype=object)}, "not of real numbers"),
            ({"left": self.left * 1j}, "not of real numbers"),
            ({"left": self.left[:-1], "right": self.right}, "differ in length"),
            ({}, "needs a reaction"),
            ({"left": self.left, "time": np.zeros(self.left.size)}, "either rate= or time="),
        ):
            with self.assertRaisesRegex(modcal.InvalidInput, words):
                modcal.Record(rate=44100, **keys)
        for times, words in ((np.zeros(self.left.size), "does not rise"),
                             (np.linspace(0, 1, self.left.size) ** 2, "evenly spaced")):
            with self.assertRaisesRegex(modcal.InvalidInput, words):
                modcal.Record(time=times, left=self.left)
        with self.assertRaisesRegex(modcal.InvalidInput, "rate"):
            modcal.Record(rate=-1, left=self.left)

    def test_faults_are_told_as_those_of_a_file(self):
        flat = np.zeros_like(self.left)
        file = self.folder / "flat.csv"
        np.savetxt(file, np.column_stack([flat, self.right]), delimiter=",", header="R1 [N],R2 [N]", comments="")
        with self.assertRaises(modcal.InvalidInput) as of_array:
            modcal.invert(modcal.Record(rate=44100, left=flat, right=self.right), STRING, 0.041018)
        section = {**self.file_section, "file": str(file), "sample_rate": 44100}
        del section["reference"]
        with self.assertRaises(modcal.InvalidInput) as of_file:
            modcal.run({**self.experiment("invert"), "record": section})
        told = [error.exception.mistakes[0].text.partition("channel R1")[2] for error in (of_array, of_file)]
        self.assertEqual(told[0], told[1])
        self.assertNotEqual(told[0], "")


class Prepared(Folder):
    """The library's own inversion, without an experiment around it."""

    STRING = {"length": 0.33, "linear_density": 3.1e-3, "fundamental": 196, "modes": 50}

    def test_is_that_of_the_experiment(self):
        scene = {"string": self.STRING, "bow": {"position": 0.03}, "duration": 0.2}
        measurement = {"sample_rate": 51200, "remove_mean": False, "noise_level": 0.01}
        stroke = modcal.simulate(scene=scene, measurement=measurement, simulator={"type": "modal_event"})
        record = modcal.Record(rate=51200, left=stroke.R1, right=stroke.R2)
        whole = modcal.invert(record, self.STRING, 0.03, measurement={"remove_mean": False})
        inverter = modcal.Inverter(self.STRING, "30 mm", samples=len(record), rate=51200)
        (estimate,) = inverter(stroke.R1, stroke.R2, motion=True)
        np.testing.assert_array_equal(estimate.force, whole.f_c_joint)
        np.testing.assert_array_equal(estimate.velocity, whole.v_joint)
        self.assertEqual(inverter(stroke.R1, stroke.R2)[0].velocity.size, 0)

    def test_refusals(self):
        with self.assertRaisesRegex(modcal.InvalidInput, 'did you mean "modes"'):
            modcal.Inverter({**self.STRING, "mods": 3}, 0.03, samples=100, rate=51200)
        inverter = modcal.Inverter(self.STRING, 0.03, samples=1000, rate=51200)
        with self.assertRaisesRegex(modcal.InvalidInput, "needs a reaction"):
            inverter()
        with self.assertRaises(modcal.InvalidInput):
            inverter(np.zeros(999), np.zeros(999))
        with self.assertRaises(modcal.InvalidInput):
            inverter(np.full(1000, np.nan), np.zeros(1000))
        loud = np.random.default_rng(1).normal(size=1000)
        loud[17] = 1e200
        with self.assertRaisesRegex(modcal.InvalidInput, "right, sample 17: 1e.200 is the largest magnitude, whose square"):
            inverter(np.zeros(1000), loud)
        self.assertEqual(inverter(np.zeros(1000), np.zeros(1000))[0].force.std(), 0.0)

    def test_rates_that_show_no_string(self):
        for rate, words in ((1e-9, "a sample rate of 1e-09 Hz does not show a string of f0 = 196 Hz"),
                            (300, "a sample rate of 300 Hz does not show"),
                            (1e9, r"100 samples at 1e\+09 Hz are 1e-07 s, less than two periods"),
                            (1e12, "less than two periods")):
            with self.assertRaisesRegex(modcal.InvalidInput, words):
                modcal.Inverter(self.STRING, 0.03, samples=100, rate=rate)
        with self.assertRaisesRegex(modcal.InvalidInput, r"highest mode \(9800 Hz\) is not below half the sample rate"):
            modcal.Inverter(self.STRING, 0.03, samples=1000, rate=12800)


if __name__ == "__main__":
    main()
