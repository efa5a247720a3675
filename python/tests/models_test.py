"""Models of strings and structures, and what is found with them."""
import numpy as np
from cases import ROOT, Folder, main

import modcal

PLATE = ROOT / "configs/structures"
SENSORS = ["a1", "a2", "a3", "a4"]
LENGTH, DENSITY, FUNDAMENTAL, STIFFNESS, CONTACT = 0.33, 3.1e-3, 196.0, 1e-4, 0.03


def strike(name):
    """A strike on the plate as arrays."""
    with open(PLATE / name, encoding="utf-8") as file:
        titles = file.readline().strip().split(",")
    columns = np.loadtxt(PLATE / name, delimiter=",", comments="#", skiprows=1).T
    named = {title.split(" [")[0]: column for title, column in zip(titles, columns)}
    return modcal.Record(time=named["t"], responses={name: named[name] for name in SENSORS}, force=named["force"])


class OfAString(Folder):
    def model(self, **keys):
        return modcal.Model.string(CONTACT, length=LENGTH, linear_density=DENSITY, fundamental=FUNDAMENTAL,
                                   inharmonicity=STIFFNESS, modes=12, damping={"type": "constant", "ratio": 3e-3},
                                   **keys)

    def test_transfer_is_the_sum_over_its_modes(self):
        model = self.model(recorded=False)
        n = np.arange(1, 13)
        omega = 2 * np.pi * n * FUNDAMENTAL * np.sqrt(1 + STIFFNESS * n**2)
        np.testing.assert_allclose(model.frequencies, omega / (2 * np.pi), rtol=1e-14)
        np.testing.assert_array_equal(model.damping_ratios, np.full(12, 3e-3))
        tension = DENSITY * (2 * LENGTH * FUNDAMENTAL) ** 2
        shape = np.sin(n * np.pi * CONTACT / LENGTH)
        mass = DENSITY * LENGTH / 2
        gains = [-tension * n * np.pi / LENGTH, (-1.0) ** n * tension * n * np.pi / LENGTH, shape]
        at = np.array([30.0, 195.9, 777.7, 2500.0])
        s = 2j * np.pi * at[:, None]
        expected = [np.sum(gain * shape / mass / (s**2 + 2 * 3e-3 * omega * s + omega**2), axis=1) for gain in gains]
        # Twelve terms of one size, each to some units of 2e-16; they cancel to a tenth at most.
        np.testing.assert_allclose(model.transfer(at), expected, rtol=1e-12)
        self.assertEqual(model.sensors, {"R1": "force", "R2": "force", "y": "displacement"})

    def test_it_stands_for_string_and_position(self):
        left, right = np.loadtxt(ROOT / "examples/bowed_violin_d.csv", delimiter=",", comments="#", skiprows=4).T[:2]
        keys = {"length": LENGTH, "linear_density": 1e-3, "fundamental": 294, "inharmonicity": 1.1e-4, "modes": 40}
        model = modcal.Model.string("41 mm", **keys)
        by_model = modcal.Inverter(model, samples=left.size, rate=44100)(left, right)[0].force
        by_keys = modcal.Inverter(keys, "41 mm", samples=left.size, rate=44100)(left, right)[0].force
        np.testing.assert_array_equal(by_model, by_keys)
        record = modcal.Record(rate=44100, left=left, right=right)
        np.testing.assert_array_equal(modcal.invert(record, model).f_c_joint,
                                      modcal.invert(record, keys, "41 mm").f_c_joint)
        with self.assertRaisesRegex(modcal.InvalidInput, "has its contact already"):
            modcal.invert(record, model, 0.03)
        with self.assertRaisesRegex(modcal.InvalidInput, "give position"):
            modcal.invert(record, keys)
        with self.assertRaisesRegex(modcal.InvalidInput, "Model.table"):
            modcal.identify(record, model)

    def test_mistakes(self):
        with self.assertRaisesRegex(modcal.InvalidInput, "lenght"):
            modcal.Model.string(CONTACT, lenght=LENGTH, linear_density=DENSITY, fundamental=FUNDAMENTAL)
        for wrong in ([-1.0], [float("nan")], [100.0, float("inf")]):
            with self.assertRaisesRegex(modcal.InvalidInput, "give frequencies from 0 on"):
                self.model().transfer(wrong)


class OfAStructure(Folder):
    @classmethod
    def setUpClass(cls):
        cls.fitted = modcal.fit_modes(strike("plate_strike.csv"), 10, "600 Hz")

    def test_modes_are_those_of_the_file(self):
        stored = modcal.run(PLATE / "fit_plate.yaml")
        self.assertEqual(self.fitted.texts["table.yaml"], stored.texts["table.yaml"])
        model = modcal.Model.table(self.fitted)
        self.assertEqual(model.sensors, {name: "acceleration" for name in SENSORS})
        self.assertEqual(model.constants.shape, (4, len(model.frequencies)))
        f, zeta = model.frequencies[0], model.damping_ratios[0]
        # At the resonance a lightly damped mode answers with s² A/(2 i ζ ω²) = i A/(2 ζ), all others stay small.
        at_peak = model.transfer([f])[3, 0]
        self.assertAlmostEqual(abs(at_peak) / abs(model.constants[3, 0] / (2 * zeta)), 1.0, delta=0.1)

    def test_modes_of_measured_response_functions(self):
        truth = modcal.Model.table(self.fitted)
        f = np.arange(0.0, 301.0, 0.25)
        clean = truth.transfer(f)
        few = {"low": 10, "high": 300, "most_modes": 14}
        exact = modcal.Model.response(f, dict(zip(SENSORS, clean)), **few)
        band = (f > 12) & (f < 290)

        def error(model):
            return np.linalg.norm((model.transfer(f) - clean)[:, band]) / np.linalg.norm(clean[:, band])

        # The truth is of the family that is fitted, but for its modes above the band, which the
        # modes that are left over take: a hundredth of the static term in a hundredth of the response.
        self.assertEqual(exact.sensors, truth.sensors)
        self.assertLess(error(exact), 1e-4)
        rng = np.random.default_rng(7)
        noise = rng.normal(size=(2, *clean.shape)) * np.abs(clean).max(axis=1, keepdims=True) * 1e-3
        noisy = clean + noise[0] + 1j * noise[1]
        found = modcal.Model.response(f, dict(zip(SENSORS, noisy)), **few)
        # 140 numbers of 8900 take the share √(140/8900) = 0.13 of the noise; weights that suit an error of the model
        # and not white noise take twice as much.
        left = np.linalg.norm((noisy - clean)[:, band]) / np.linalg.norm(clean[:, band])
        self.assertLess(error(found), 0.35 * left)

    def test_force_is_that_of_the_files(self):
        found = modcal.identify(strike("plate_other_strike.csv"), modcal.Model.table(PLATE / "plate_modes.json"))
        stored = modcal.run(PLATE / "force_on_plate.yaml")
        self.assertEqual(found.summary.splitlines()[0], stored.summary.splitlines()[0])
        for name, signal in stored.signals.items():
            np.testing.assert_array_equal(found.signals[name], signal)

    def test_mistakes(self):
        with self.assertRaisesRegex(modcal.InvalidInput, 'channel a cannot read "speed": acceleration, '):
            modcal.Record(rate=1e3, responses={"a": np.zeros(9)}, kinds="speed")
        with self.assertRaisesRegex(modcal.InvalidInput, "give one of them"):
            modcal.Record(rate=1e3, responses={"a": np.zeros(9)}, left=np.zeros(9))
        with self.assertRaisesRegex(modcal.InvalidInput, "give that of fit_modes"):
            modcal.Model.table(modcal.Result("invert", ""))
        with self.assertRaisesRegex(modcal.InvalidInput, "a table of modes: it has no string"):
            modcal.invert(modcal.Record(rate=1e3, left=np.zeros(9)), modcal.Model.table(self.fitted))
        f = np.arange(0.0, 100.0)
        zero = np.zeros(9)
        for keys, words in (({"responses": {"f_c": zero}}, "cannot be named f_c"),
                            ({"responses": {"a": zero}, "kinds": {"b": "velocity"}}, "kinds names b")):
            with self.assertRaisesRegex(modcal.InvalidInput, words):
                modcal.Record(rate=1e3, **keys)
        noise = np.random.default_rng(1).normal(size=(2, 2000))
        with self.assertRaisesRegex(modcal.InvalidInput, "rejected: the modes leave"):
            modcal.Model.response(0.25 * np.arange(2000), {"a": noise[0] + 1j * noise[1]}, low=10, high=300,
                                  most_modes=6)
        with self.assertRaisesRegex(modcal.InvalidInput, "no response to fit"):
            modcal.Model.response(f, {}, low=10, high=50)
        with self.assertRaisesRegex(modcal.InvalidInput, "kinds names a1x, which is no response; name some of a"):
            modcal.Model.response(f, {"a": f}, low=10, high=50, kinds={"a1x": "velocity"})
        for wrong in (0, -1, 2.5, "3"):
            with self.assertRaisesRegex(modcal.InvalidInput, "most_modes = .* is no number of modes; give a whole number"):
                modcal.Model.response(f, {"a": f}, low=10, high=50, most_modes=wrong)
        for response, words in ((0.0 * f, "response of b is zero at every frequency of the band"),
                                (1e200 * f, r"response of b reaches 5e\+201, whose square is outside")):
            with self.assertRaisesRegex(modcal.InvalidInput, words):
                modcal.Model.response(f, {"a": f, "b": response}, low=10, high=50)
        nan = np.where(f == 20, np.nan, f)
        for at, response, words in ((f + 0.5, f, "no multiples of an even step"),
                                    (f, f[:-1], "no row of 100 numbers"), (f, nan, "not finite at 20 Hz"),
                                    (f[30:], f[30:], "not within the frequencies, 30 to 99 Hz")):
            with self.assertRaisesRegex(modcal.InvalidInput, words):
                modcal.Model.response(at, {"a": response}, low=10, high=50)
        with self.assertRaisesRegex(modcal.InvalidInput, "missing.yaml"):
            modcal.Model.table("missing.yaml")


main()
