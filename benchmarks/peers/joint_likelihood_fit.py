#!/usr/bin/python3
"""Calibration to the bound as a NumPy user and a SciPy user would write it.

Same data, starts and objective as benchmarks/calibration_peer.cpp: the joint likelihood of both
reactions with the force eliminated in every bin. The law (f0, B, x_c) goes through records damped by
200, 100, 50 and 20 1/s and cut to 8/sigma, started from the law of the initial frequencies and nine
contact points, one damping factor freed at 20 1/s, then the whole record with the end state projected
out; last every frequency, held to 0.2 % about the law.

NumPy: vectorized over bins x modes, analytic Jacobian, normal equations by BLAS, damped Gauss-Newton
steps. SciPy: scipy.optimize.least_squares on the same residuals, its defaults (differences) and with
the analytic Jacobian. The C++ program also weights the bins, frees its information of noise and gives
error bars and verdicts, which neither of these does.

    calibration_peer --write_case=case.bin
    joint_likelihood_fit.py case.bin [repetitions]

Prints median times, how many times faster the C++ program was, and the differences of the results in
standard deviations.
"""
import sys
import time

import numpy as np
import scipy.linalg
import scipy.optimize

LADDER = (200.0, 100.0, 50.0, 20.0)
WIDTH = 2e-3  # of the prior of f_n about the law


class Case:
    def __init__(self, path):
        numbers = np.fromfile(path)
        (samples, self.rate, modes, self.contact, self.length, self.tension, self.mass, self.zeta) = numbers[:8]
        self.samples, self.modes = int(samples), int(modes)
        self.noise = numbers[8:10]
        self.law_seconds, self.all_seconds = numbers[10:12]
        self.law, self.all_contact = numbers[12:15], numbers[15]
        n = self.modes
        parts = np.split(numbers[16:], np.cumsum([n, n, n, self.samples]))
        self.start, self.found, self.deviation = parts[:3]
        self.records = parts[3:]
        self.n = np.arange(1, n + 1)
        self.sign = (-1.0) ** self.n


class Record:
    """Both reactions damped by exp(-sigma t), cut, transformed and whitened."""

    def __init__(self, case, sigma):
        self.case, self.sigma = case, sigma
        count = case.samples if sigma == 0 else min(case.samples, int(8 / sigma * case.rate))
        weight = np.exp(-sigma * np.arange(count) / case.rate)
        norm = np.sqrt(np.sum(weight**2))
        bins = int(1.05 * case.start[-1] * count / case.rate)
        keep = slice(1, bins + 1)
        self.y = [np.fft.rfft(r[:count] * weight)[keep] / (s * norm) for r, s in zip(case.records, case.noise)]
        self.s = sigma + 2j * np.pi * case.rate / count * np.arange(1, bins + 1)
        self.delay = np.exp(-self.s / case.rate)
        self.offset = np.fft.rfft(weight)[keep] / norm


def stacked(columns):
    return np.concatenate([columns.real, columns.imag])


class Likelihood:
    """Residuals of a record at (omega, x_c, damping factor), linear unknowns projected out."""

    def __init__(self, record):
        self.record = record

    def evaluate(self, omega, contact, factor, jacobian=None):
        """jacobian(d_omega, d_contact, d_factor): the columns asked for, from those of every ln omega_n,
        of x_c and of the logarithm of the damping factor."""
        record, case = self.record, self.record.case
        zeta = case.zeta * factor
        shape = np.pi * case.n / case.length
        gain = case.tension * shape * np.sin(shape * contact) / case.mass
        s = record.s[:, None]
        inverse = 1 / (omega**2 + s**2 + 2 * zeta * omega * s)
        terms = gain * inverse
        h1 = -terms.sum(1) / case.noise[0]
        h2 = (terms @ case.sign) / case.noise[1]
        size = np.sqrt(np.abs(h1) ** 2 + np.abs(h2) ** 2)
        y1, y2 = record.y
        residual = (h2 * y1 - h1 * y2) / size
        kappa = (h2[:, None] / case.noise[0] + case.sign * h1[:, None] / case.noise[1]) / size[:, None]
        if record.sigma == 0:
            pole = np.exp((-zeta + 1j * np.sqrt(1 - zeta**2)) * omega / case.rate)
            up = 1 / (1 - pole * record.delay[:, None])
            down = 1 / (1 - pole.conj() * record.delay[:, None])
            free = np.hstack([stacked(kappa * (up + down)), stacked(1j * kappa * (up - down))])
        else:
            free = stacked(np.stack([h2 / case.noise[0], -h1 / case.noise[1]], 1) * (record.offset / size)[:, None])
        free /= np.sqrt((free**2).sum(0))
        normal = free.T @ free
        normal[np.diag_indices_from(normal)] += 1e-9
        factors = scipy.linalg.cho_factor(normal)
        e = stacked(residual)
        unknown = -scipy.linalg.cho_solve(factors, free.T @ e)
        e = e + free @ unknown
        if jacobian is None:
            return e
        # The data without their transients give the force; alpha is the slope of the residual per force.
        alpha = kappa * inverse * (case.tension * shape / case.mass)
        force = (h1.conj() * y1 + h2.conj() * y2) / size**2
        d_free = 0
        if record.sigma == 0:
            c = unknown.reshape(2, -1) / np.sqrt((np.hstack([stacked(kappa * (up + down)), stacked(1j * kappa * (up - down))]) ** 2).sum(0)).reshape(2, -1)
            c = c[0] + 1j * c[1]
            moving = c * up + c.conj() * down
            total, signed = moving.sum(1), moving @ case.sign
            force = force + (h1.conj() * total / case.noise[0] - h2.conj() * signed / case.noise[1]) / size**2
            slope = (-zeta + 1j * np.sqrt(1 - zeta**2)) * omega / case.rate
            bend = (-zeta * omega / case.rate) * (1 + 1j * zeta / np.sqrt(1 - zeta**2))
            d_up, d_down = up**2 * record.delay[:, None] * pole, down**2 * record.delay[:, None] * pole.conj()
            d_free = kappa * (c * d_up * slope + c.conj() * d_down * slope.conj())
            d_bend = (kappa * (c * d_up * bend + c.conj() * d_down * bend.conj())).sum(1)
        else:
            d_bend = 0
        sine = np.sin(shape * contact)
        alpha_force = alpha * force[:, None]
        d_omega = -alpha_force * sine * inverse * (2 * omega**2 + 2 * zeta * omega * s) + d_free
        d_contact = alpha_force @ (shape * np.cos(shape * contact))
        d_factor = -(alpha_force * inverse * s) @ (sine * 2 * zeta * omega) + d_bend
        columns = stacked(jacobian(d_omega, d_contact, d_factor))
        columns -= free @ scipy.linalg.cho_solve(factors, free.T @ columns)
        return e, columns


class Law:
    """(ln f0, B, x_c[, ln damping factor])."""

    def __init__(self, case, with_factor):
        self.case, self.with_factor = case, with_factor

    def model(self, theta):
        omega = 2 * np.pi * np.exp(theta[0]) * self.case.n * np.sqrt(1 + theta[1] * self.case.n**2)
        return omega, theta[2], np.exp(theta[3]) if self.with_factor else 1.0

    def columns(self, theta):
        bend = 0.5 * self.case.n**2 / (1 + theta[1] * self.case.n**2)
        parts = 4 if self.with_factor else 3
        return lambda w, x, z: np.stack([w.sum(1), w @ bend, x, z][:parts], 1)

    scale = np.array([1e-3, 1e-5, 1e-4, 1e-1])


class Frequencies:
    """(ln of every f_n about a model, x_c, ln damping factor), the prior below the residuals."""

    def __init__(self, case, law, theta):
        self.case, self.base = case, law.model(theta)
        bend = 0.5 * case.n**2 / (1 + theta[1] * case.n**2)
        span = np.linalg.qr(np.stack([np.ones(case.modes), bend], 1))[0]
        self.prior = (np.eye(case.modes) - span @ span.T) / (WIDTH * np.sqrt(2))
        self.start = np.concatenate([np.zeros(case.modes), [theta[2], theta[3]]])
        self.scale = np.concatenate([np.full(case.modes, 1e-4), [1e-4, 1e-1]])

    def model(self, theta):
        return self.base[0] * np.exp(theta[:-2]), theta[-2], np.exp(theta[-1])

    def columns(self, theta):
        return lambda w, x, z: np.hstack([w, x[:, None], z[:, None]])


class Problem:
    """What both users minimize: stacked residuals, their prior, in scaled unknowns."""

    def __init__(self, likelihood, unknowns):
        self.likelihood, self.unknowns = likelihood, unknowns

    def residuals(self, theta):
        e = self.likelihood.evaluate(*self.unknowns.model(theta))
        prior = getattr(self.unknowns, "prior", None)
        return e if prior is None else np.concatenate([e, prior @ theta[:-2]])

    def both(self, theta):
        e, j = self.likelihood.evaluate(*self.unknowns.model(theta), self.unknowns.columns(theta))
        prior = getattr(self.unknowns, "prior", None)
        if prior is None:
            return e, j
        return np.concatenate([e, prior @ theta[:-2]]), np.vstack([j, np.hstack([prior, np.zeros((len(prior), 2))])])


def numpy_fit(problem, theta, tolerance=1e-4, steps=25):
    """Gauss-Newton damped by Marquardt until a step is below sqrt(tolerance) standard deviations."""
    e, j = problem.both(theta)
    cost, damping = e @ e, 1e-6
    for _ in range(steps):
        normal, slope = j.T @ j, j.T @ e
        size = np.sqrt(np.diag(normal))
        while True:
            step = -np.linalg.solve(normal / np.outer(size, size) + damping * np.eye(len(size)), slope / size) / size
            trial = theta + step
            e_trial = problem.residuals(trial)
            if e_trial @ e_trial <= cost or damping > 1e6:
                break
            damping *= 10
        decrement = -slope @ step
        theta, damping = trial, max(damping / 10, 1e-9)
        if decrement < tolerance:
            break
        e, j = problem.both(theta)
        cost = e @ e
    return theta


def scipy_fit(analytic):
    def fit(problem, theta, tolerance=None):  # its own defaults
        scale = problem.unknowns.scale[: len(theta)]
        options = {"jac": lambda z: problem.both(theta + scale * z)[1] * scale} if analytic else {}
        found = scipy.optimize.least_squares(lambda z: problem.residuals(theta + scale * z), np.zeros(len(theta)), **options)
        return theta + scale * found.x

    return fit


def start_law(case):
    """The law through the initial frequencies: f_n^2/n^2 is linear in (f0^2, f0^2 B)."""
    matrix = np.stack([np.ones(case.modes), case.n**2], 1)
    weight = case.n / case.start
    a, b = np.linalg.lstsq(matrix * weight[:, None], (case.start / case.n) ** 2 * weight, rcond=None)[0]
    return np.array([0.5 * np.log(a), b / a, case.contact])


def fit_law(case, fit):
    theta, law = start_law(case), Law(case, False)
    for sigma in LADDER[:-1]:
        problem = Problem(Likelihood(Record(case, sigma)), law)
        if sigma == LADDER[0]:
            grid = [theta + [0, 0, case.length / 660 * step] for step in range(-4, 5)]
            found = [fit(problem, start, 1e-2) for start in grid]
            theta = min(found, key=lambda t: np.sum(problem.residuals(t) ** 2))
        else:
            theta = fit(problem, theta, 1e-2)
    law = Law(case, True)
    theta = fit(Problem(Likelihood(Record(case, LADDER[-1])), law), np.append(theta, 0.0), 1e-3)
    whole = Likelihood(Record(case, 0.0))
    return whole, fit(Problem(whole, law), theta)


def fit_all(case, fit, whole, theta):
    unknowns = Frequencies(case, Law(case, True), theta)
    return unknowns.model(fit(Problem(whole, unknowns), unknowns.start))


def timed(work, repetitions):
    seconds = []
    for _ in range(repetitions):
        begin = time.perf_counter()
        result = work()
        seconds.append(time.perf_counter() - begin)
    return result, np.median(seconds)


def main():
    case = Case(sys.argv[1])
    repetitions = int(sys.argv[2]) if len(sys.argv) > 2 else 3
    print(f"C++: law {1e3 * case.law_seconds:.0f} ms, law and all frequencies {1e3 * case.all_seconds:.0f} ms")
    for name, fit, count in (
        ("NumPy", numpy_fit, repetitions),
        ("SciPy, analytic Jacobian", scipy_fit(True), 1),
        ("SciPy, differences", scipy_fit(False), 1),
    ):
        (whole, theta), law_seconds = timed(lambda: fit_law(case, fit), count)
        (omega, contact, _), more = timed(lambda: fit_all(case, fit, whole, theta), count)
        seconds = law_seconds + more
        print(
            f"{name}: law {law_seconds:.2f} s, {law_seconds / case.law_seconds:.0f} x the C++ program's time; "
            f"law and all frequencies {seconds:.2f} s, {seconds / case.all_seconds:.0f} x"
        )
        excited = np.abs(np.sin(np.pi * case.n * case.all_contact / case.length)) > 0.1
        seen = (case.deviation < 5e-4) & excited
        apart = ((omega / (2 * np.pi) / case.found - 1) / case.deviation)[seen]
        print(
            f"  law: f0 apart by {np.exp(theta[0]) - case.law[0]:.1e} Hz, B by {theta[1] - case.law[1]:.1e}, "
            f"x_c by {theta[2] - case.law[2]:.1e} m; frequencies of {seen.sum()} modes by "
            f"{np.sqrt(np.mean(apart**2)):.2f} standard deviations (rms)"
        )
        if not np.sqrt(np.mean(apart**2)) < 1.0:
            sys.exit("the two programs did not find the same optimum")


if __name__ == "__main__":
    main()
