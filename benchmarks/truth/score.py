#!/usr/bin/env python3
"""Coverage of `modcal`'s error bars on records that it has not made.

score.py BUILD OUT simulates strings with BUILD/benchmarks/truth, adds noise, calibrates every record with BUILD/modcal from
starts that are off (f0 by up to 2 %, B by up to 20 %, x_c by up to 1.5 mm, uniform) and prints, for f0, B, x_c and all
identified f_n, which share of the truths lies within one and two of the deviations stated (a Gaussian: 68 and 95 %) and the
largest |z|; how many were accepted (exit code 0), and what a calibration costs. What is finished stays in OUT: the same command
goes on where it stopped; records are kept, and so are results of the same program, record and configuration.
"""
import argparse
import concurrent.futures
import hashlib
import json
import math
import operator
import os
import random
import resource
import subprocess
import sys
import threading
import time
from pathlib import Path

# f0 [Hz], B, L [m], linear density [kg/m], x_c [m], bow velocity [m/s], s0 [1/s], s1 [m^2/s]: zeta_n of 5e-4 to 2e-3
# below 15 kHz. The paper's string is violin_g.
STRINGS = {
    "violin_d": (294.0, 1.1e-4, 0.33, 1.0e-3, 41.0e-3, 0.10, 3.0, 8.0e-4),
    "violin_g": (196.0, 1.4e-4, 0.33, 3.1e-3, 30.0e-3, 0.10, 2.2, 6.5e-4),
    "violin_e": (659.3, 5.0e-5, 0.325, 3.8e-4, 28.7e-3, 0.20, 5.0, 1.6e-3),
    "viola_c": (130.8, 2.6e-4, 0.37, 6.0e-3, 45.2e-3, 0.12, 1.6, 6.0e-4),
    "cello_d": (146.8, 1.7e-4, 0.69, 4.5e-3, 66.9e-3, 0.10, 1.6, 2.2e-3),
    "cello_c": (65.4, 3.0e-4, 0.69, 15.0e-3, 71.3e-3, 0.15, 0.9, 1.4e-3),
}
ACTIONS = ("exponential", "thermal", "torsion", "pluck")
# What a record has and its model may not: further arguments of truth, and what is done to the reactions afterwards.
MISMATCHES = {
    "none": ([], {}),
    **{f"gain_{g:g}": (["--gain", 1 + g], {}) for g in (0.002, 0.005, 0.02)},
    **{f"delay_{us:g}us": (["--delay", 1e-6 * us], {}) for us in (0.2, 1)},
    **{f"corner_{hz:g}hz": (["--corner", hz], {}) for hz in (0.5, 2)},
    **{f"body_{b:g}": (["--body-peak", b], {}) for b in (0.005, 0.0125)},
    **{f"polarization_alike_{p:g}": (["--polarization-1", p, "--polarization-2", p], {}) for p in (0.03, 0.1)},
    **{f"polarization_unlike_{p:g}": (["--polarization-1", p, "--polarization-2", 0.3 * p], {}) for p in (0.03, 0.1)},
    "drift_1e-4": (["--drift", 1e-4], {}),
    # The bow wanders along the string: slowly by 1 and 2.5 mm from the middle, to and fro by 1.5 mm.
    **{f"wander_{mm:g}mm": (["--wander", 1e-3 * mm], {}) for mm in (1, 2.5)},
    "wander_1.5mm_7hz": (["--wander", 1.5e-3, "--wander-frequency", 7], {}),
    # A mode of the body between the string's first and second, heavy and light.
    **{f"bridge_{kg:g}kg": (["--bridge-mass", kg, "--body-frequency", 430], {}) for kg in (0.2, 0.05)},
    "mid_stroke": (["--start", 0.3], {}),
    "damping_constant": ([], {"damping": "constant"}),
    **{f"hum_{h:g}": ([], {"hum": h}) for h in (0.001, 0.01, 0.05)},
    **{f"pink_{p:g}": ([], {"pink": p}) for p in (0.1, 0.5)},
    **{f"correlated_{c:g}": ([], {"correlated": c}) for c in (0.3, 0.9)},
    # Nine times the power of the noise about a tenth of the sampling rate, a third of that wide.
    "hill": ([], {"hill": 0.1}),
    "8_bit": ([], {"bits": 8}),
    # Sensors and damping as far from those stated, and modes as far from their law, as the priors say: the error bars
    # should hold what they promise.
    "as_stated": ([], {"drawn": True}),
    # With a second polarization as far off, too: the sum of the record and a share of what another string makes of its force.
    "as_stated_polarized": ([], {"drawn": True, "polarized": True}),
}
MISMATCHES_OF_RECORDS = [name for name in MISMATCHES if name != "as_stated_polarized"]
SCATTER = 1e-5  # of f_n about their law: the least that modcal takes for possible
CALIBRATION = """  parameters: {frequencies: all, law: true, contact: true}
  objective: joint_likelihood
  optimizer: staged
"""


def arguments():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("build", type=Path, help="build folder: modcal and benchmarks/truth")
    p.add_argument("out", type=Path, help="folder of records and results")
    p.add_argument("--jobs", type=int, default=1)
    p.add_argument("--quick", action="store_true", help="three strings, one action each, 1 draw: 9 calibrations")
    p.add_argument("--strings", nargs="+", choices=STRINGS, default=list(STRINGS))
    p.add_argument("--actions", nargs="+", choices=ACTIONS, default=["exponential", "thermal", "torsion"])
    p.add_argument("--noise", nargs="+", type=float, default=[0.001, 0.01, 0.05])
    p.add_argument("--draws", type=int, default=6, help="noise and start, of each record and noise")
    p.add_argument("--mismatch", nargs="+", choices=("all", *MISMATCHES), default=["none"], metavar="NAME",
                   help=f"what the records have and the model has not: all (but the last), {', '.join(MISMATCHES)}")
    p.add_argument("--drawn-mismatch", action="store_true",
                   help="sensors, damping, scatter of the modes and a second polarization, drawn from the priors of modcal's defaults")
    p.add_argument("--rate", type=float, default=51200.0)
    p.add_argument("--duration", type=float, default=1.0)
    p.add_argument("--reactions", choices=("tension", "support"), default="tension")
    p.add_argument("--damping", choices=("table", "constant"), default="table",
                   help="stated: the true zeta_n, or 1e-3 for all")
    p.add_argument("--modes", type=int, help="stated number of modes; left out: as many as the record tells")
    p.add_argument("--string-keys", default="", help="further keys of string:")
    p.add_argument("--record-keys", default="", help="further keys of record:")
    p.add_argument("--calibration", type=Path, help="file with the lines below calibration:")
    p.add_argument("--force", action="store_true", help="identify it, too, and compare it with the true one")
    p.add_argument("--timeout", type=float, default=600.0, help="of one calibration [s]")
    a = p.parse_args()
    a.build, a.out = a.build.resolve(), a.out.resolve()
    a.pairs = [(s, k) for s in a.strings for k in a.actions]
    a.mismatch = MISMATCHES_OF_RECORDS if "all" in a.mismatch else a.mismatch
    a.mismatch = ["as_stated", "as_stated_polarized"] if a.drawn_mismatch else a.mismatch
    if a.quick:
        a.pairs = [("violin_d", "exponential"), ("violin_g", "thermal"), ("cello_d", "torsion")]
        a.draws = 1
    a.cells = [(*pair, m) for pair in a.pairs for m in a.mismatch]
    a.lines = a.calibration.read_text() if a.calibration else CALIBRATION
    return a


def digest(*parts):
    return hashlib.sha256("\n".join(map(str, parts)).encode()).hexdigest()[:16]


def file_digest(path):
    return hashlib.sha256(path.read_bytes()).hexdigest()[:16]


def truth_command(name, action, mismatch, a):
    """The command line of a record without noise. The bow presses with a third of what the Helmholtz motion allows."""
    f0, B, L, rho, x, v, s0, s1 = STRINGS[name]
    impedance = 2.0 * L * f0 * rho
    press = 0.35 * 2.0 * impedance * v / (x / L * 0.19)
    command = ["--f0", f0, "--B", B, "--length", L, "--density", rho, "--x", x, "--velocity", v, "--loss", s0,
               "--diffusion", s1, "--rate", a.rate, "--duration", a.duration, "--reactions", a.reactions]
    if action == "pluck":
        command += ["--action", "force", "--force", f"0:0,0.02:{press:.4g},0.0204:0"]
    else:
        # Rosin warms with the work of the slips: H, G and S follow it from the string it was tuned for.
        heat = press * v / 0.1
        command += ["--normal-force", f"{press:.6g}", "--action", "thermal" if action == "thermal" else "exponential",
                    "--heat-capacity", 5e-6 * heat, "--conductance", 2e-3 * heat, "--carried-heat", 1e-3 * press]
    if action == "torsion":
        command += ["--torsion", "--torsion-loss", 0.34 * f0, "--torsion-diffusion", 0.2 * L * L]
    return list(map(str, command + MISMATCHES[mismatch][0]))


def second_polarization(name, action):
    """Options of a record that has all of a second polarization, of a detuning drawn up and down between 0.1 and 1 %."""
    draw = random.Random(f"detuning {name} {action}").uniform
    detuning = math.copysign(10.0 ** draw(-3.0, -2.0), draw(-1.0, 1.0))
    return ["--polarization-1", "1", "--polarization-2", "1", "--detuning", f"{detuning:.6g}"]


def simulated(name, action, mismatch, a, truth_digest, further=()):
    """Path of the record's files without their endings."""
    return made(f"{name}-{action}", [*truth_command(name, action, mismatch, a), *further], a, truth_digest)


def made(label, command, a, truth_digest):
    """The same of a command line of truth."""
    path = a.out / "records" / f"{label}-{digest(truth_digest, *command)}"
    if not path.with_suffix(".json").exists():
        path.parent.mkdir(parents=True, exist_ok=True)
        draft = path.with_name(path.name + f".{os.getpid()}.{threading.get_ident()}")
        subprocess.run([a.build / "benchmarks/truth", *command, draft], check=True, stdout=subprocess.DEVNULL)
        os.replace(f"{draft}.csv", f"{path}.csv")
        os.replace(f"{draft}.json", f"{path}.json")
    return path


def pink(normal, count):
    """Noise of variance 1 whose power falls as 1/f between 5 Hz and 13 kHz: eleven first-order processes an octave apart."""
    corners = [2.0 ** -k for k in range(11)]
    keep = [math.exp(-c) for c in corners]
    drive = [math.sqrt(1.0 - k * k) for k in keep]
    state = [normal(0.0, 1.0) for _ in corners]
    result = []
    for _ in range(count):
        state = [k * x + d * normal(0.0, 1.0) for k, d, x in zip(keep, drive, state)]
        result.append(sum(state) / math.sqrt(len(state)))
    return result


def hilly(normal, count, place):
    """White noise and that noise through a resonance at PLACE of the sampling rate; of variance 1."""
    pole = 0.9
    turn, last, before, result = 2.0 * pole * math.cos(2.0 * math.pi * place), 0.0, 0.0, []
    for _ in range(count):
        white = normal(0.0, 1.0)
        last, before = turn * last - pole * pole * before + 0.25 * white, last
        result.append(white + last)
    rms = math.sqrt(sum(x * x for x in result) / count)
    return [x / rms for x in result]


def noise_of(normal, count, how):
    """Noise of variance 1 for both reactions."""
    channels = [[normal(0.0, 1.0) for _ in range(count)] for _ in range(2)]
    if "correlated" in how:
        c = how["correlated"]
        channels[1] = [c * x + math.sqrt(1.0 - c * c) * y for x, y in zip(*channels)]
    if "hill" in how:
        channels = [hilly(normal, count, how["hill"]) for _ in channels]
    if "pink" in how:
        share = how["pink"]
        channels = [[math.sqrt(1.0 - share) * x + math.sqrt(share) * y for x, y in zip(white, pink(normal, count))]
                    for white in channels]
    return channels


def relative_sensor(normal, rate, spacing):
    """A sensor drawn from the priors of modcal's defaults, as a filter of the samples: gain (2 %), delay (one sample), a
    response whose logarithm's real and imaginary part have 0.5 % and do not turn within a knot, and a corner (1 Hz)."""
    delay, reach = normal(0.0, 1.0), round(rate / (4.0 * spacing))
    taps = [normal(0.0, 0.005 * math.sqrt(2.0 / (2 * reach + 1))) for _ in range(2 * reach + 1)]
    for i in range(2 * reach + 1):
        late = i - reach - delay
        window = 0.5 + 0.5 * math.cos(math.pi * late / (reach + 4.0)) if abs(late) < reach + 4.0 else 0.0
        taps[i] += window * (math.sin(math.pi * late) / (math.pi * late) if late else 1.0)
    gain, keep = math.exp(normal(0.0, 0.02)), math.exp(-2.0 * math.pi * abs(normal(0.0, 1.0)) / rate)
    return [gain * tap for tap in reversed(taps)], reach, keep


def read_by(sensor, x):
    """What the sensor reads; before and after the record stands its first and its last sample."""
    taps, reach, keep = sensor
    padded = [x[0]] * reach + x + [x[-1]] * reach
    slow, result = sum(taps) * x[0], []
    for i in range(len(x)):
        value = sum(map(operator.mul, taps, padded[i:i + len(taps)]))
        slow = keep * slow + (1.0 - keep) * value
        result.append(value - slow)
    return result


def scattered_modes(truth, noise, draw, path):
    """f_n of a string whose modes scatter about their law."""
    normal = random.Random(f"scatter {path.name} {noise} {draw}").gauss
    return [f * (1.0 + normal(0.0, SCATTER)) for f in truth["modes"]["f"]]


def added_by(modes, truth, force):
    """What both reactions have more where the modes are elsewhere: each moved by the same force, less itself before. By
    impulse invariance, whose error is a small part of the difference."""
    string, rate = truth["string"], truth["record"]["rate"]
    length, mass = string["L"], 0.5 * string["rho_L"] * string["L"]
    tension = 4.0 * length ** 2 * string["f0"] ** 2 * string["rho_L"]
    odd, even = [0.0] * len(force), [0.0] * len(force)
    for n, (other, own, zeta) in enumerate(zip(modes, truth["modes"]["f"], truth["modes"]["zeta"]), 1):
        if own > 0.45 * rate:
            break
        wave = n * math.pi / length
        total = even if n % 2 == 0 else odd
        for f, sign in ((other, 1.0), (own, -1.0)):
            omega = 2.0 * math.pi * f
            damped, r = omega * math.sqrt(1.0 - zeta * zeta), math.exp(-zeta * omega / rate)
            a, b = 2.0 * r * math.cos(damped / rate), r * r
            drive = (sign * tension * wave * math.sin(wave * truth["x_c"]) / (mass * damped * rate)
                     * r * math.sin(damped / rate))
            last = before = 0.0
            for i, x in enumerate(force):
                total[i] += last
                last, before = a * last - b * before + drive * x, last
    return [-(o + e) for o, e in zip(odd, even)], [e - o for o, e in zip(odd, even)]


def columns_of(path):
    return [line.split(",")[:4] for line in Path(f"{path}.csv").read_text().splitlines()[1:]]


def with_noise(path, noise, draw, how, folder, other=None):
    """Writes folder/record.csv: R1 and R2 with noise of this share of their standard deviations, hum of 50 Hz and its
    harmonics (1/h) likewise, rounded to so many bits of the peak."""
    rows = columns_of(path)
    with_other = columns_of(other) if other else None
    normal = random.Random(f"{path.name} {noise} {draw}").gauss
    rate = (len(rows) - 1) / float(rows[-1][0])
    truth = json.loads(Path(f"{path}.json").read_text())
    more = None
    if "drawn" in how:
        more = added_by(scattered_modes(truth, noise, draw, path), truth, [float(row[3]) for row in rows])
    noisy = []
    for column, draws in zip((1, 2), noise_of(normal, len(rows), how)):
        x = [float(row[column]) for row in rows]
        if other:
            # The same force moves both strings: their reactions add.
            share = random.Random(f"polarization {column} {path.name} {noise} {draw}").gauss(0.0, 0.03)
            x = [v + share * (float(row[column]) - v) for v, row in zip(x, with_other)]
        if more:
            x = [v + change for v, change in zip(x, more[column - 1])]
        if "drawn" in how and column == 2:
            drawn = random.Random(f"sensor {path.name} {noise} {draw}").gauss
            x = read_by(relative_sensor(drawn, rate, min(300.0, truth["string"]["f0"])), x)
        mean = sum(x) / len(x)
        sigma = math.sqrt(sum((v - mean) ** 2 for v in x) / len(x))
        x = [v + noise * sigma * d for v, d in zip(x, draws)]
        if "hum" in how:
            turn = 2.0 * math.pi * 50.0 / rate
            waves = [(how["hum"] * sigma / h, h * turn, 0.7 * h * draw) for h in range(1, 9)]
            x = [v + sum(a * math.cos(w * i + p) for a, w, p in waves) for i, v in enumerate(x)]
        if "bits" in how:
            step = 2.0 * max(map(abs, x)) / 2 ** how["bits"]
            x = [step * round(v / step) for v in x]
        noisy.append(x)
    text = "".join(f"{row[0]},{r1:.12g},{r2:.12g}\n" for row, r1, r2 in zip(rows, *noisy))
    (folder / "record.csv").write_text("t [s],R1 [N],R2 [N]\n" + text)


def configuration(truth, name, mismatch, noise, draw, a):
    off = random.Random(f"start {name} {noise} {draw}").uniform
    string = truth["string"]
    table = [(f, z) for f, z in zip(truth["modes"]["f"], truth["modes"]["zeta"]) if f < 0.5 * a.rate]
    if "drawn" in MISMATCHES[mismatch][1]:
        # All of them by a factor e, each by 30 %.
        drawn = random.Random(f"damping {name} {noise} {draw}").gauss
        factor = drawn(0.0, 1.0)
        table = [(f, z * math.exp(factor + drawn(0.0, 0.3))) for f, z in table]
    damping = "{type: constant, ratio: 1e-3}"
    if MISMATCHES[mismatch][1].get("damping", a.damping) == "table":
        damping = (f"{{type: table, frequencies: [{', '.join(f'{f:.9g} Hz' for f, _ in table)}], "
                   f"ratios: [{', '.join(f'{z:.9g}' for _, z in table)}]}}")
    keys = (f", modes: {a.modes}" if a.modes else "") + (f", {a.string_keys}" if a.string_keys else "")
    record = "file: record.csv, left: {channel: R1}, right: {channel: R2}" + (f", {a.record_keys}" if a.record_keys else "")
    return (f"kind: calibrate\nrecord: {{{record}}}\n"
            f"string: {{length: {string['L']} m, linear_density: {string['rho_L']} kg/m, "
            f"fundamental: {string['f0'] * (1 + off(-0.02, 0.02)):.9g} Hz, "
            f"inharmonicity: {string['B'] * (1 + off(-0.2, 0.2)):.6g}, damping: {damping}{keys}}}\n"
            f"bow: {{position: {1e3 * truth['x_c'] + off(-1.5, 1.5):.6g} mm}}\n"
            + ("write_signals: true\n" if a.force else "") + f"calibration:\n{a.lines}")


def z_of(found, truth, sd):
    return None if not sd else (found - truth) / sd


def scored(calibration, truth):
    """z of the parameters and of the identified modes."""
    named = {p["name"]: p for p in calibration["parameters"]}
    true = {"f0": truth["string"]["f0"], "B": truth["string"]["B"], "x_c": truth["x_c"]}
    result = {}
    for name, value in true.items():
        p = named[name]
        result[name] = {"z": z_of(p["final"], value, p.get("sd")), "sd": p.get("sd"), "error": p["final"] - value}
    result["f_n"], result["leaving"] = [], 0
    for mode in calibration["modes"]:
        # The string obeys its law: a mode said to leave it is a false alarm.
        result["leaving"] += mode.get("law") not in ("follows", "", None)
        if mode.get("source") != "identified" or mode["n"] > len(truth["modes"]["f"]):
            continue
        value = truth["modes"]["f"][mode["n"] - 1]
        result["f_n"].append((mode["n"], z_of(mode["f_hz"], value, mode["relative_sd"] * mode["f_hz"]),
                              mode["relative_sd"]))
    continuation = calibration.get("continuation") or {}
    result["chi2"] = continuation.get("chi2")
    return result


def calibrated(task, a):
    """Runs one calibration: a line of the results."""
    name, action, mismatch, noise, draw, path, other, text, key = task
    truth = json.loads(Path(f"{path}.json").read_text())
    folder = a.out / "runs" / key
    folder.mkdir(parents=True, exist_ok=True)
    with_noise(path, noise, draw, MISMATCHES[mismatch][1], folder, other)
    if "drawn" in MISMATCHES[mismatch][1]:
        truth["modes"]["f"] = scattered_modes(truth, noise, draw, path)
    (folder / "calibrate.yaml").write_text(text)
    line = {"key": key, "string": name, "action": action, "mismatch": mismatch, "noise": noise, "draw": draw}
    begin = time.monotonic()
    try:
        done = subprocess.run([a.build / "modcal", "run", "calibrate.yaml", "--out", "out", "--threads", "1"], cwd=folder,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=a.timeout)
        line |= {"exit": done.returncode, "accepted": done.returncode == 0}
        found = sorted(folder.glob("out/**/calibration.json"))
        if found:
            line |= scored(json.loads(found[0].read_text()), truth)
            if a.force:
                from force_held import force_held
                line["force"] = force_held(found[0].parent / "identified.csv", f"{path}.csv")
        else:
            line["failure"] = done.stdout.strip()[-400:]
    except subprocess.TimeoutExpired:
        line |= {"accepted": False, "failure": f"longer than {a.timeout:g} s"}
    line["wall"] = time.monotonic() - begin
    for leftover in folder.glob("record.csv"):
        leftover.unlink()
    return line


def finished(out, keys):
    try:
        lines = [json.loads(line) for line in (out / "results.jsonl").read_text().splitlines() if line.endswith("}")]
    except FileNotFoundError:
        lines = []
    return {line["key"]: line for line in lines if line["key"] in keys}


def tasks_of(a):
    program, truth_digest = file_digest(a.build / "modcal"), file_digest(a.build / "benchmarks/truth")
    # Mismatches that are put on afterwards share a record.
    commands = {cell: tuple(truth_command(*cell, a)) for cell in a.cells}
    first = {}
    for cell, command in commands.items():
        first.setdefault((cell[:2], command), cell)
    with concurrent.futures.ThreadPoolExecutor(a.jobs) as pool:
        made = dict(zip(first, pool.map(lambda cell: simulated(*cell, a, truth_digest), first.values())))
        polarized = [cell for cell in a.cells if "polarized" in MISMATCHES[cell[2]][1]]
        others = dict(zip(polarized, pool.map(
            lambda cell: simulated(*cell, a, truth_digest, second_polarization(*cell[:2])), polarized)))
    paths = [made[cell[:2], commands[cell]] for cell in a.cells]
    tasks = []
    for (name, action, mismatch), path in zip(a.cells, paths):
        truth = json.loads(Path(f"{path}.json").read_text())
        for noise in a.noise:
            for draw in range(a.draws):
                text = configuration(truth, name, mismatch, noise, draw, a)
                key = f"{name}-{action}-{mismatch}-{noise:g}-{draw}-{digest(program, path.name, text)}"
                tasks.append((name, action, mismatch, noise, draw, path, others.get((name, action, mismatch)), text, key))
    return tasks


def row(label, z, sds):
    z = [abs(v) for v in z if v is not None and math.isfinite(v)]
    if not z:
        return f"  {label:5} none"
    share = [100.0 * sum(v <= k for v in z) / len(z) for k in (1, 2)]
    sd = sorted(sds)[len(sds) // 2] if sds else math.nan
    return (f"  {label:5} n {len(z):5}  within 1 sd {share[0]:5.1f} %, 2 sd {share[1]:5.1f} %  largest |z| {max(z):8.1f}  "
            f"median |z| {sorted(z)[len(z) // 2]:6.2f}  mean z^2 {sum(v * v for v in z) / len(z):6.2f}  median sd {sd:.2g}")


def wrong(line):
    """Off by more than an honest deviation allows: f0, B or x_c beyond 4, an f_n beyond 5."""
    modes = max((abs(z) for _, z, _ in line["f_n"] if z is not None), default=0.0)
    return modes > 5.0 or any(line[name]["z"] is None or abs(line[name]["z"]) > 4.0 for name in ("f0", "B", "x_c"))


def summary(lines, title):
    scored_lines = [line for line in lines if "f0" in line]
    accepted = [line for line in scored_lines if line["accepted"]]
    wall = sorted(line["wall"] for line in lines)
    failed = len(lines) - len(scored_lines)
    print(f"\n{title}: {len(lines)} calibrations, {len(accepted)} accepted, of them {sum(map(wrong, accepted))} "
          f"wrong (beyond 4 sd, f_n 5), {len(scored_lines) - len(accepted)} refused"
          + (f", {failed} without a result" if failed else "")
          + f"; median {wall[len(wall) // 2]:.1f} s, longest {wall[-1]:.1f} s")
    for group, chosen in (("accepted", accepted), ("all", scored_lines)):
        if not chosen or (group == "all" and len(accepted) == len(scored_lines)):
            continue
        print(f" {group}: modes said to leave the law {sum(line['leaving'] for line in chosen)}")
        for name in ("f0", "B", "x_c"):
            print(row(name, [line[name]["z"] for line in chosen], [line[name]["sd"] for line in chosen if line[name]["sd"]]))
        modes = [mode for line in chosen for mode in line["f_n"]]
        print(row("f_n", [z for _, z, _ in modes], [sd for _, _, sd in modes]))
        forces = [line["force"] for line in chosen if "force" in line]
        if forces:
            print("  force " + ", ".join(f"{what} {min(of):.3g} .. {sorted(of)[len(of) // 2]:.3g} .. {max(of):.3g}" for what, of in (
                ("in the 95 % band", [f["held"] for f in forces]), ("error", [f["error"] for f in forces]),
                ("deviation over error", [f["deviation"] for f in forces]))) + " (least, median, largest)")


def main():
    a = arguments()
    tasks = tasks_of(a)
    done = finished(a.out, {task[-1] for task in tasks})
    todo = [task for task in tasks if task[-1] not in done]
    print(f"{len(tasks)} calibrations, {len(done)} of them done before", flush=True)
    lock = threading.Lock()
    with concurrent.futures.ThreadPoolExecutor(a.jobs) as pool, open(a.out / "results.jsonl", "a") as results:
        for future in concurrent.futures.as_completed([pool.submit(calibrated, task, a) for task in todo]):
            line = future.result()
            with lock:
                results.write(json.dumps(line) + "\n")
                results.flush()
            done[line["key"]] = line
            print(f"{len(done)}/{len(tasks)} {line['string']} {line['action']} {line['mismatch']} {100 * line['noise']:g} % "
                  f"{'accepted' if line['accepted'] else 'refused'} {line['wall']:.1f} s", file=sys.stderr, flush=True)
    lines = list(done.values())
    for mismatch in a.mismatch:
        for noise in a.noise:
            title = (f"{mismatch}, " if len(a.mismatch) > 1 else "") + f"noise {100 * noise:g} %"
            summary([line for line in lines if (line["mismatch"], line["noise"]) == (mismatch, noise)], title)
    summary(lines, "everything")
    for text in sorted({line["failure"] for line in lines if "failure" in line}):
        print(f"\n{sum(line.get('failure') == text for line in lines)} without a result: {text}")
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    if todo:
        print(f"\n{(used.ru_utime + used.ru_stime) / len(todo):.1f} s of processor time a calibration, records included")


if __name__ == "__main__":
    main()
