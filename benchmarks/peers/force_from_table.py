#!/usr/bin/python3
"""Force at an unreachable place from K responses and a table of modes: what a NumPy user would write, beside modcal.

force_from_table.py BUILD FOLDER [--draws N] makes the strikes and smooth forces of benchmarks/truth/plate.py, whose truth shares
no code with modcal, fits the table of modes with BUILD/modcal and identifies each force by

    modcal       kind: identify_force of BUILD/modcal
    invert       --string only: kind: invert of BUILD/modcal, both ends at once, which knows the string in the place of a table
    pinv         equal-weight pseudo-inverse of H per frequency (the core of ForceFinder)
    tsvd         truncated singular values of the convolution matrix, corner of the L-curve (Hansen 1992)
    tikhonov     Tikhonov on the same matrix, corner of the L-curve, band of its Gaussian posterior
    akf          augmented Kalman filter and smoother: random-walk force (Lourens et al. 2012), variance of largest likelihood
    gp           latent force, Matérn 3/2 (Alvarez 2009; Nayek et al. 2019), variance and length of largest likelihood

All have the same table, record and window. With --string the records are blows and bowed strokes of a string
(string_records.py); their forces are compared from 1 ms before they begin and without their means, which sensors of force mostly
do not give. With --record CSV --table YAML --force COLUMN --responses COLUMN … another record, with a measured force,
is taken. Prints relative rms error over the window, its share between the table's frequencies, the share of the samples in the
95 % band, and seconds of wall clock (modcal: of the whole process), medians of the draws.
"""
import argparse
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import yaml
from scipy import linalg, optimize, signal

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "truth"))
import plate  # noqa: E402
import string_records  # noqa: E402

POWER = {"displacement": 0, "force": 0, "strain": 0, "velocity": 1, "acceleration": 2}


class Table:
    """Modes and static terms as fit_modes writes them."""

    def __init__(self, path):
        data = yaml.safe_load(Path(path).read_text())
        hertz = lambda text: float(str(text).split()[0])
        self.low, self.high = hertz(data["low"]), hertz(data["high"])
        modes, sensors = data["modes"], data["sensors"]
        self.omega = 2 * np.pi * np.array([hertz(m["frequency"]) for m in modes])
        self.zeta = np.array([float(m["damping_ratio"]) for m in modes])
        self.real = np.array([m["constants"] for m in modes]).T  # K × N
        self.imaginary = np.array([m.get("quadrature", [0] * len(sensors)) for m in modes]).T
        self.power = POWER[sensors[0]["kind"]]
        self.below = np.array([float(s.get("below", 0)) for s in sensors])
        self.constant = np.array([float(s.get("constant", 0)) for s in sensors])
        self.scatter = np.array([float(s.get("scatter", 0)) for s in sensors])
        self.noise = np.array([float(s.get("noise", 0)) for s in sensors])

    def transfer(self, s):
        """H, K × frequencies."""
        s = np.asarray(s)[None, :]
        pole = s**2 + 2 * (self.zeta * self.omega)[:, None] * s + (self.omega**2)[:, None]
        turned = s / self.omega[:, None] if self.power == 0 else -self.omega[:, None] / s
        sums = self.real @ (1 / pole) + self.imaginary @ (turned / pole)
        return s**self.power * (sums + self.below[:, None] / s**2 + self.constant[:, None])

    def state_space(self):
        """Continuous A, B, C, D. Static terms that differentiate or integrate the force have none and are left out."""
        n = self.omega.size
        a = np.zeros((2 * n, 2 * n))
        a[:n, n:] = np.eye(n)
        a[n:, :n] = -np.diag(self.omega**2)
        a[n:, n:] = -np.diag(2 * self.zeta * self.omega)
        b = np.concatenate([np.zeros(n), np.ones(n)])
        by_place, by_speed = {
            0: (self.real, self.imaginary / self.omega),
            1: (-self.imaginary * self.omega, self.real),
            2: (-self.real * self.omega**2, -2 * self.real * self.zeta * self.omega - self.imaginary * self.omega),
        }[self.power]
        direct = {0: self.constant, 1: 0 * self.below, 2: self.real.sum(axis=1) + self.below}[self.power]
        return a, b, np.hstack([by_place, by_speed]), direct

    def keep_band(self, x, rate):
        """x without what lies outside of the band; `low` counts where the record is long enough to tell it."""
        parts = [signal.butter(8, self.high, "lowpass", fs=rate, output="sos")]
        if self.low * x.shape[0] > rate:
            parts.append(signal.butter(2, self.low, "highpass", fs=rate, output="sos"))
        return signal.sosfiltfilt(np.vstack(parts), x, axis=0)


def pinv(table, y, rate, count):
    padded = 2 * y.shape[0]
    f = np.fft.rfftfreq(padded, 1 / rate)
    band = (f >= table.low if table.low > f[1] else f >= 0) & (f <= table.high)
    h, spectrum = table.transfer(2j * np.pi * np.maximum(f[band], 1e-9)), np.fft.rfft(y, padded, axis=0).T[:, band]
    force = np.zeros(f.size, complex)
    force[band] = (h.conj() * spectrum).sum(axis=0) / (np.abs(h) ** 2).sum(axis=0)
    return np.fft.irfft(force, padded)[:count], None


def convolution(table, rate, rows):
    """Matrix from so many samples of the force to as many of all sensors."""
    padded = 4 * rows
    sigma = np.log(1e6) / (padded / rate)  # exp(−σt): what wraps around is below 1e-6
    f = np.fft.rfftfreq(padded, 1 / rate)
    h = table.transfer(sigma + 2j * np.pi * np.maximum(f, 1e-9))
    lag = np.arange(padded)
    lag = np.where(lag < padded // 2, lag, lag - padded)  # H ends at half the rate: it rings before 0, too
    impulse = np.fft.irfft(h, padded, axis=1) * np.exp(sigma * lag / rate)
    return np.vstack([linalg.toeplitz(g[:rows], g[-np.arange(rows)]) for g in impulse])


def corner(x, y):
    """Corner of the L-curve, x growing: the sharpest angle of an earlier point, this and the last (Castellanos et al. 2002)."""
    points = np.column_stack([np.log(x), np.log(y)])
    sharpest, at = np.cos(7 * np.pi / 8), len(points) // 2
    for k in range(1, len(points) - 1):
        back, ahead = points[:k] - points[k], points[-1] - points[k]
        cosine = back @ ahead / (np.linalg.norm(back, axis=1) * np.linalg.norm(ahead) + 1e-300)
        cosine[back[:, 1] * ahead[0] <= back[:, 0] * ahead[1]] = -1  # bent the other way
        if cosine.max() > sharpest:
            sharpest, at = cosine.max(), k
    return at


def least_squares(table, y, rate, count, truncated):
    rows = y.shape[0]
    # The modes below the band are a mere static term, those above are not known: both sides lose what lies there.
    a = np.vstack([table.keep_band(part, rate) for part in np.split(convolution(table, rate, rows), y.shape[1])])
    b = table.keep_band(y, rate).T.ravel()
    u, s, vt = linalg.svd(a, full_matrices=False)
    beta = u.T @ b
    rest = b @ b - beta @ beta
    if truncated:
        kept = np.unique(np.geomspace(4, s.size, 60).astype(int))[::-1]
        filters = [(np.arange(s.size) < k).astype(float) for k in kept]
    else:
        lambdas = np.geomspace(1e-5 * s[0], s[0], 60)
        filters = [s**2 / (s**2 + v**2) for v in lambdas]
    residual = np.sqrt([rest + np.sum(((1 - g) * beta) ** 2) for g in filters])
    size = np.sqrt([np.sum((g * beta / s) ** 2) for g in filters])
    at = corner(residual, size)
    force = vt.T @ (filters[at] * beta / s)
    if truncated:
        return force, None
    noise = residual[at] ** 2 / (b.size - filters[at].sum())
    return force, np.sqrt(np.einsum("ij,i->j", vt**2, noise / (s**2 + lambdas[at] ** 2)))


def smoother(table, y, rate, count, matern):
    """Kalman filter and Rauch–Tung–Striebel smoother on modes and force; hyperparameters of largest likelihood."""
    a, b, c, d = table.state_space()
    n, step, k = b.size, 1 / rate, y.shape[1]
    scale = np.abs(table.transfer(2j * np.pi * np.linspace(table.low, table.high, 200))).mean()
    guess = y[:count].std() / scale  # of the force [N]
    # What lies outside of the table's band is noise to the model.
    outside = (y - table.keep_band(y, rate)).std(axis=0)
    noise = np.diag(table.noise**2 + (table.scatter * y.std(axis=0)) ** 2 + outside**2)

    def system(deviation, length):
        force = np.array([[0, 1], [-3 / length**2, -2 * np.sqrt(3) / length]]) if matern else np.zeros((1, 1))
        m = force.shape[0]
        whole = np.zeros((n + m, n + m))
        whole[:n, :n], whole[:n, n], whole[n:, n:] = a, b, force
        density = np.zeros((n + m, n + m))
        density[-1, -1] = 4 * deviation**2 * (np.sqrt(3) / length) ** 3 if matern else deviation**2 / length
        van_loan = linalg.expm(step * np.block([[-whole, density], [np.zeros_like(whole), whole.T]]))
        advance = van_loan[n + m:, n + m:].T
        process = advance @ van_loan[:n + m, n + m:]
        start = np.zeros((n + m, n + m))
        if matern:
            start[n, n], start[n + 1, n + 1] = deviation**2, 3 * deviation**2 / length**2
        read = np.hstack([c, d[:, None], np.zeros((k, m - 1))])
        return advance, (process + process.T) / 2, read, start

    def run(deviation, length, keep):
        advance, process, read, p = system(deviation, length)
        x, likelihood, kept = np.zeros(p.shape[0]), 0.0, []
        for sample in y:
            gain = linalg.solve(read @ p @ read.T + noise, read @ p, assume_a="pos").T
            spread = read @ p @ read.T + noise
            innovation = sample - read @ x
            likelihood -= 0.5 * (innovation @ linalg.solve(spread, innovation) + np.linalg.slogdet(spread)[1])
            x, p = x + gain @ innovation, p - gain @ read @ p
            if keep:
                kept.append((x, p))
            x, p = advance @ x, advance @ p @ advance.T + process
            p = (p + p.T) / 2
        return (likelihood, advance, process, kept) if keep else likelihood

    # Largest likelihood: the best of a grid; of the one number of a random walk, then what is best beside that.
    lengths = np.array([0.3, 0.6, 1.2, 2.4]) / table.high if matern else (0.001,)
    grid = [(guess * v, length) for v in (0.3, 3, 30, 300) for length in lengths]
    deviation, length = max(grid, key=lambda pair: run(*pair, False))
    if not matern:
        near = np.log(deviation) + np.log(10) * np.array([-0.5, 0.5])
        cost = lambda x: -run(np.exp(x), length, False)
        deviation = np.exp(optimize.minimize_scalar(cost, bounds=near, method="bounded", options={"xatol": 0.1}).x)
    _, advance, process, kept = run(deviation, length, True)
    force, variance = np.empty(len(kept)), np.empty(len(kept))
    x, p = kept[-1]
    force[-1], variance[-1] = x[n], p[n, n]
    for j in range(len(kept) - 2, -1, -1):
        xf, pf = kept[j]
        ahead = advance @ pf @ advance.T + process
        unit = np.sqrt(np.diag(ahead)) + 1e-300  # displacements and velocities differ by ω in size
        scaled = ahead / np.outer(unit, unit) + 1e-10 * np.eye(unit.size)
        g = (linalg.solve(scaled, advance @ pf / unit[:, None], assume_a="pos") / unit[:, None]).T
        x, p = xf + g @ (x - advance @ xf), pf + g @ (p - ahead) @ g.T
        force[j], variance[j] = x[n], p[n, n]
    return force[:count], np.sqrt(np.maximum(variance[:count], 0))


METHODS = {
    "pinv": pinv,
    "tsvd": lambda *a: least_squares(*a, truncated=True),
    "tikhonov": lambda *a: least_squares(*a, truncated=False),
    "akf": lambda *a: smoother(*a, matern=False),
    "gp": lambda *a: smoother(*a, matern=True),
}


def by_modcal(build, out, record, table, force, sign, responses, window):
    kind = ", kind: force" if Table(table).power == 0 else ""
    channels = ", ".join(f"{{channel: {r}{kind}}}" for r in responses)
    turned = ", turned: true, calibration: 1" if sign < 0 else ""
    out.mkdir(parents=True, exist_ok=True)
    file = out / "identify.yaml"
    file.write_text(f"kind: identify_force\ntable: {table.resolve()}\nrecord:\n  file: {record.resolve()}\n"
                    f"  force: {{channel: {force}{turned}}}\n  responses: [{channels}]\nwindow: {window} s\n")
    subprocess.run([build / "modcal", "run", file, "--out", out / "run"], check=True, capture_output=True)
    found = string_records.columns(out / "run/identified.csv")
    return [found[name] for name in found.dtype.names[1:3]]


def read(path, force, responses, offset):
    data = string_records.columns(path)

    def column(name):
        values = data[next(c for c in data.dtype.names if name in (c, c.split("_")[0], c.rsplit("_", 1)[0]))]
        return values - np.median(values) if offset else values

    t = data[data.dtype.names[0]]
    return column(force), np.column_stack([column(r) for r in responses]), (t.size - 1) / (t[-1] - t[0])


def judge(force, sd, truth, table, rate):
    error = force - truth
    size = np.sqrt(np.mean(truth**2))
    f = np.fft.rfftfreq(truth.size, 1 / rate)
    band = (f >= table.low) & (f <= table.high)
    inside = np.sqrt(np.mean(np.fft.irfft(np.where(band, np.fft.rfft(error), 0), truth.size) ** 2))
    held = np.nan if sd is None else np.mean(np.abs(error) <= 1.959964 * sd)
    return np.sqrt(np.mean(error**2)) / size, inside / size, held


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("build", type=Path)
    p.add_argument("folder", type=Path)
    p.add_argument("--draws", type=int, default=3)
    p.add_argument("--string", action="store_true", help="records of a string with a force sensor at both ends")
    p.add_argument("--record", type=Path)
    p.add_argument("--table", type=Path)
    p.add_argument("--force", default="force")
    p.add_argument("--turned", action="store_true", help="the force of --record has the other sign")
    p.add_argument("--offset", action="store_true", help="the channels of --record stand off zero by their medians")
    p.add_argument("--responses", nargs="+", default=["a1", "a2", "a3", "a4"])
    p.add_argument("--window", type=float, default=0.08)
    p.add_argument("--cases", nargs="+", help="only these: blow or stroke of --string, strike or smooth of the plate")
    p.add_argument("--methods", nargs="+", default=["modcal", "invert", *METHODS])
    a = p.parse_args()
    a.folder.mkdir(parents=True, exist_ok=True)
    if a.record:
        cases = {a.record.stem: ([a.record], a.table, a.window)}
    elif a.string:
        a.force, a.responses, cases = "f_c", ["R1", "R2"], {}
        for kind in ("blow", "stroke"):
            cases[kind] = (*string_records.records(a.build, a.folder, kind, a.draws), 0.06)
    else:
        strike = a.folder / "strike.csv"
        plate.write(strike, *plate.record(np.random.default_rng(1), 0, 1.5))
        (a.folder / "strike.yaml").write_text(plate.yaml("fit_modes", "strike", low="10 Hz", high="600 Hz"))
        plate.run(a.build, a.folder / "strike.yaml", a.folder / "strike")
        cases = {}
        for kind, window in (("strike", 0.08), ("smooth", 0.5)):
            files = [a.folder / f"{kind}_{draw}.csv" for draw in range(a.draws)]
            for draw, file in enumerate(files):
                plate.write(file, *plate.record(np.random.default_rng([7, draw, 1000]), 1e-3, 1.0, kind))
            cases[kind] = (files, a.folder / "strike/table.yaml", window)
    sign = -1 if a.turned else 1
    print("case      method      error  in band  in the 95 % band  seconds")
    for case, (files, path, window) in cases.items():
        table = Table(path)
        for method in a.methods:
            rows = []
            if a.cases and case not in a.cases or method == "invert" and not a.string:
                continue
            for file in files:
                truth, y, rate = read(file, a.force, a.responses, a.offset)
                truth, count = sign * truth, int(window * rate)
                begin = time.perf_counter()
                if method == "modcal":
                    force, sd = by_modcal(a.build, a.folder / file.stem, file, path, a.force, sign, a.responses, window)
                elif method == "invert":
                    found = string_records.by_invert(a.build, a.folder / f"{file.stem}_invert", file)
                    if found is None:
                        continue
                    force, sd = found
                else:
                    # The spectra take the whole record; all others the window and a tenth more, as the force may go on behind it.
                    read_until = None if method == "pinv" else count + count // 10
                    force, sd = METHODS[method](table, y[:read_until], rate, count)
                seconds = time.perf_counter() - begin
                sd = sd if sd is None else sd[:count]
                force, truth = force[:count], truth[:count]
                if a.string:
                    first = int((string_records.START - 0.001) * rate)
                    force, truth = (x[first:] - x[first:].mean() for x in (force, truth))
                    sd = sd if sd is None else sd[first:]
                rows.append((*judge(force, sd, truth, table, rate), seconds))
            if not rows:
                continue
            error, band, held, seconds = np.median(rows, axis=0)
            share = "-" if np.isnan(held) else f"{100 * held:.1f} %"
            print(f"{case:9s} {method:10s} {error:6.3f} {band:8.3f} {share:>17s} {seconds:8.2f}", flush=True)


if __name__ == "__main__":
    main()
