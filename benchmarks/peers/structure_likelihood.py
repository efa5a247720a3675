#!/usr/bin/python3
"""The joint likelihood of a structure's responses and the force by a table, as a NumPy user would write them.

Same data and same work as benchmarks/structure/blind_likelihood_benchmark.cpp: K = 4 accelerations, 30 modes. The likelihood has
2000 bins: e = (I - h h^H/|h|^2) y, and its derivatives by ln f and ln zeta of every mode, -(I - h h^H/|h|^2) dh F, all modes at
once. The force of 4 x 200000 samples: spectra on a contour, H, F = sum conj(H) Y/V / (sum |H|^2/V + 1/P), back to samples.

    structure_likelihood.py [repetitions]

Prints median times, and the cost 2 |e|^2 and the norm of the derivatives, which the program prints as well.
"""
import sys
import time

import numpy as np

K, MODES, BINS = 4, 30, 2000
OMEGA = 2 * np.pi * (12 + 15 * np.arange(MODES))
ZETA = np.full(MODES, 0.01)
I = np.arange(K * MODES)
CONSTANTS = (np.cos(0.7 * I) + 1j * 0.1 * np.sin(1.3 * I)).reshape(K, MODES)


def transfer(s):
    """H, sensors x bins, and what every mode makes of it without its constants."""
    pole = s**2 + 2 * (ZETA * OMEGA)[:, None] * s + (OMEGA**2)[:, None]
    turned = -OMEGA[:, None] / s
    shapes = s**2 * (CONSTANTS.real[:, :, None] + CONSTANTS.imag[:, :, None] * turned) / pole
    return shapes.sum(axis=1), shapes, pole


def likelihood(s, data, root):
    h, shapes, pole = transfer(s)
    h, y = h * root, data * root
    told = (abs(h) ** 2).sum(axis=0)
    force = (h.conj() * y).sum(axis=0) / told
    e = y - h * force
    # dH/d ln f: of 1/pole and of what is turned; dH/d ln zeta: of 1/pole.
    by_damping = -shapes * (2 * (ZETA * OMEGA)[:, None] * s / pole)
    by_frequency = -shapes * ((2 * (ZETA * OMEGA)[:, None] * s + 2 * (OMEGA**2)[:, None]) / pole)
    by_frequency += s**2 * (CONSTANTS.imag[:, :, None] * (-OMEGA[:, None] / s)) / pole
    slopes = np.stack([by_frequency, by_damping], axis=2) * (root * force)
    along = (h.conj()[:, None, None, :] * slopes).sum(axis=0) / told
    return e, -(slopes - h[:, None, None, :] * along[None])


def force_of(records, rate, sigma, low, high):
    samples = records.shape[1]
    spacing = rate / samples
    t = np.arange(samples) / rate
    bins = np.arange(int(np.floor(low / spacing)) + 1, int(np.floor(high / spacing)) + 1)
    spectra = np.fft.rfft(records * np.exp(-sigma * t), axis=1)[:, bins]
    s = sigma + 2j * np.pi * spacing * bins
    h = transfer(s)[0]
    variance = np.exp(-2 * sigma * t).sum()
    whole = np.zeros(samples // 2 + 1, complex)
    whole[bins] = (h.conj() * spectra).sum(axis=0) / variance / ((abs(h) ** 2).sum(axis=0) / variance + 1e-9)
    return np.fft.irfft(whole, samples)


def timed(what, repetitions):
    times = []
    for _ in range(repetitions):
        begin = time.perf_counter()
        result = what()
        times.append(time.perf_counter() - begin)
    return 1e3 * np.median(times), result


def main():
    repetitions = int(sys.argv[1]) if len(sys.argv) > 1 else 5
    m = np.arange(BINS)
    s = 2j * np.pi * 2000 / 8000 * (20 + m)
    data = transfer(s)[0] + 0.01 * np.exp(0.1j * m * np.arange(K)[:, None])
    milliseconds, (e, slopes) = timed(lambda: likelihood(s, data, 100.0), repetitions)
    print(f"likelihood with Jacobian: {milliseconds:.1f} ms, cost {2 * (abs(e) ** 2).sum():.6g}, slopes {np.linalg.norm(slopes):.6g}")
    j = np.arange(200_000)
    records = np.sin(0.001 * (np.arange(K)[:, None] + 3) * j)
    milliseconds, force = timed(lambda: force_of(records, 2000, 0.02, 5, 480), repetitions)
    print(f"force of 4 x 200000 samples: {milliseconds:.0f} ms, rms {np.sqrt(np.mean(force**2)):.6g}")


if __name__ == "__main__":
    main()
