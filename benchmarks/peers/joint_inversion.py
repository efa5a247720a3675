#!/usr/bin/python3
"""The joint inversion of both reactions as a NumPy user would write it.

Same data and same steps as benchmarks/inversion_benchmark.cpp (prior "jumps"): noise levels from 8
Hann-windowed segments above the top mode with the cross relation, weighting, two transforms, the
evidence of 100 amplitudes of the prior, the inverse transform. Transfer functions, windows and the
prior's shape are prepared outside the timed part in both.

    inversion_benchmark --write_case=case.bin
    joint_inversion.py case.bin [repetitions]

Prints the median processor time, its ratio to that of the C++ program (which stands in the file)
and the largest difference from the force the C++ program found.
"""
import sys
import time

import numpy as np
import scipy.fft

LENGTH, FUNDAMENTAL, DENSITY, MODES, ZETA, CONTACT = 0.33, 196.0, 3.1e-3, 50, 1e-3, 0.03


def transfer_on_axis(samples, rate):
    """H_1 and H_2 of one windowed segment, for the cross relation."""
    tension = 4 * LENGTH**2 * FUNDAMENTAL**2 * DENSITY
    n = np.arange(1, MODES + 1)
    omega = 2 * np.pi * FUNDAMENTAL * n
    gain = tension * n * np.pi / LENGTH * np.sin(n * np.pi * CONTACT / LENGTH) / (DENSITY * LENGTH / 2)
    s = 2j * np.pi * np.fft.rfftfreq(samples, 1 / rate)[:, None]
    denominator = omega**2 + s**2 + 2 * ZETA * omega * s
    return (-gain / denominator).sum(1), ((-1.0) ** n * gain / denominator).sum(1)


class Case:
    def __init__(self, path):
        numbers = np.fromfile(path)
        self.samples = int(numbers[0])
        self.rate, self.sigma, _, _, self.parameter = numbers[1:6]
        bins = self.samples // 2 + 1
        parts = np.split(numbers[6:], np.cumsum([2 * bins, 2 * bins, bins, self.samples, self.samples]))
        self.h = [parts[0].view(complex).copy(), parts[1].view(complex).copy()]
        self.shape, self.r, self.force = parts[2], [parts[3], parts[4]], parts[5][: self.samples]
        self.peer_milliseconds = parts[5][self.samples]
        for h in self.h:  # what sampling shows of the first and last bin
            h[0], h[-1] = h[0].real, h[-1].real
        self.segment = 4096
        self.window = np.sin(np.pi * (np.arange(self.segment) + 0.5) / self.segment) ** 2
        self.axis = transfer_on_axis(self.segment, self.rate)
        spacing = self.rate / self.segment
        top = FUNDAMENTAL * MODES
        low = min(1.2 * top, 0.5 * (top + self.rate / 2))
        self.band = slice(int(np.ceil(low / spacing)), int(0.97 * self.rate / 2 / spacing))
        self.weight = np.exp(-self.sigma * np.arange(self.samples) / self.rate)
        self.lambdas = 2.0 ** (0.5 * (-64 + np.arange(100) * 0.75))


def noise_levels(case):
    segments = min(8, case.samples // case.segment)
    starts = np.arange(segments) * ((case.samples - case.segment) // (segments - 1))
    x = [
        scipy.fft.rfft(np.stack([r[s : s + case.segment] for s in starts]) * case.window)[:, case.band]
        for r in case.r
    ]
    power = np.array([np.mean(np.abs(xr) ** 2) for xr in x]) / np.sum(case.window**2)
    h = [a[case.band] for a in case.axis]
    weight = 1 / (np.abs(h[0]) ** 2 + np.abs(h[1]) ** 2)
    cross = np.mean(weight * np.abs(x[0] * h[1] - x[1] * h[0]) ** 2) / np.sum(case.window**2)
    expected = np.mean(weight * (np.abs(h[1]) ** 2 * power[0] + np.abs(h[0]) ** 2 * power[1]))
    return power * min(1.0, cross / expected)


def invert(case):
    v = noise_levels(case)
    x = [scipy.fft.rfft(r * case.weight) for r in case.r]
    q = sum(np.abs(h) ** 2 / vr for h, vr in zip(case.h, v))
    d = sum(np.conj(h) * xr / vr for h, xr, vr in zip(case.h, x, v))
    mean = v.mean()
    multiplicity = np.full(q.size, 2.0)
    multiplicity[0] = multiplicity[-1] = 1.0
    u = np.abs(d) ** 2 / q / np.sum(case.weight**2)
    g = q * mean * case.shape
    criterion, residual, solution = np.empty(100), np.empty(100), np.empty(100)
    for j, level in enumerate(case.lambdas):
        ratio = g / level**2
        kept = ratio / (1 + ratio)
        criterion[j] = np.sum(multiplicity * (np.log1p(ratio) - u * kept))
        residual[j] = np.sqrt(np.sum(multiplicity * u * (1 - kept) ** 2))
        solution[j] = np.sqrt(np.sum(multiplicity * u / q * kept**2))
    best = int(np.argmin(criterion))
    a, b, c = criterion[best - 1 : best + 2]
    level = case.lambdas[best] * 2.0 ** (0.5 * 0.75 * 0.5 * (a - c) / (a - 2 * b + c))
    prior = mean / level**2 * case.shape
    force = scipy.fft.irfft(d / (q + 1 / prior), case.samples) / case.weight
    return level, force


def main():
    case = Case(sys.argv[1])
    repetitions = int(sys.argv[2]) if len(sys.argv) > 2 else 5
    times = []
    for _ in range(repetitions):
        start = time.process_time()
        level, force = invert(case)
        times.append(time.process_time() - start)
    difference = np.abs(force - case.force).max() / case.force.std()
    milliseconds = 1e3 * np.median(times)
    print(
        f"joint inversion of {case.samples} samples: NumPy/SciPy {milliseconds:.2f} ms, "
        f"C++ {case.peer_milliseconds:.2f} ms: {milliseconds / case.peer_milliseconds:.1f} times faster"
    )
    print(f"parameter {level:.6g} (C++ {case.parameter:.6g}), largest difference {difference:.2g} of the standard deviation")


if __name__ == "__main__":
    main()
