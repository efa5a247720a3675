#!/usr/bin/python3
"""Records that NumPy, SciPy and h5py write are read to the last bit, and what modcal writes they read likewise: peers.py MODCAL"""
import json
import subprocess
import sys
import tempfile
from pathlib import Path

import h5py
import numpy as np
import scipy.io

PROGRAM = sys.argv[1]
RATE = 8192.0
DRAW = np.random.default_rng(5)
FORCE, MOTION = DRAW.normal(size=50), DRAW.normal(size=50) * 1e-9


def modcal(*arguments):
    return subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True)


def read_back(file, *options):
    """{name: (unit, samples)} and the rate, as a table of modcal's own has them."""
    table = file.with_suffix(".back.csv")
    done = modcal("convert", file, table, *options)
    assert done.returncode == 0, (file, done.stderr)
    lines = table.read_text().split("\n")
    rate = next(float(line.split(":")[1].split()[0]) for line in lines if line.startswith("# sample_rate"))
    rows = [line for line in lines if line and not line.startswith("#")]
    heads = rows[0].split(",")
    values = np.array([[float(x) for x in row.split(",")] for row in rows[1:]])
    table.unlink()
    result = {}
    for i, head in enumerate(heads[1:], 1):
        name, _, unit = head.strip('"').partition(" [")
        result[name] = (unit.rstrip("]"), values[:, i])
    return result, rate


def same(found, expected):
    assert np.array_equal(found, np.asarray(expected, dtype=float)), (found, expected)


def theirs(folder):
    two = np.stack([FORCE, MOTION], axis=1)
    for name, array in (("c.npy", two), ("fortran.npy", np.asfortranarray(two)), ("across.npy", two.T.copy()),
                        ("big.npy", two.astype(">f8")), ("single.npy", two.astype("f4"))):
        np.save(folder / name, array)
        found, rate = read_back(folder / name, "--sample-rate", RATE)
        assert rate == RATE
        stem = Path(name).stem
        long = array if array.shape[0] == 50 else array.T
        same(found[f"{stem}_1"][1], long[:, 0])
        same(found[f"{stem}_2"][1], long[:, 1])
    for kind in ("i1", "u1", "i2", ">i4", "u8", "f2", "?"):
        counts = np.abs(100 * FORCE).astype(kind)
        np.save(folder / "counts.npy", counts)
        same(read_back(folder / "counts.npy", "--sample-rate", "100")[0]["counts"][1], counts)
    fields = np.zeros(50, dtype=[("t [s]", "f8"), ("F [lbf]", "f4"), ("more", [("acc [g]", ">f8", (2,))])])
    fields["t [s]"] = np.arange(50) / RATE
    fields["F [lbf]"] = FORCE
    fields["more"]["acc [g]"][:, 1] = MOTION
    np.save(folder / "fields.npy", fields)
    found, rate = read_back(folder / "fields.npy")
    assert rate == RATE and found["F"][0] == "lbf", (found, rate)
    same(found["F"][1], FORCE.astype("f4"))
    for save in (np.savez, np.savez_compressed):
        save(folder / "a.npz", Kraft=FORCE, weg=MOTION, **{"Kraft.unit": "mN", "fs": RATE, "note": "Größe"})
        found, rate = read_back(folder / "a.npz")
        assert rate == RATE and found["Kraft"][0] == "mN"
        same(found["Kraft"][1], FORCE)
        same(found["weg"][1], MOTION)
    # Objects are never unpickled.
    np.save(folder / "objects.npy", np.array([{"a": 1}, None], dtype=object), allow_pickle=True)
    assert modcal("inspect", folder / "objects.npy").returncode == 3
    with h5py.File(folder / "a.h5", "w") as file:
        group = file.create_group("run 1")
        group.attrs["dt"] = 1 / RATE
        group.create_dataset("hammer", data=FORCE, compression="gzip", chunks=(7,)).attrs["unit"] = "lbf"
        group.create_dataset("plate", data=np.stack([MOTION, FORCE]).astype(">f4")).attrs["units"] = np.bytes_("g")
        group.create_dataset("spectrum", data=FORCE + 1j)
        file.create_dataset("text", data="a word")
    found, rate = read_back(folder / "a.h5")
    assert rate == RATE and found["run 1.hammer"][0] == "lbf" and found["run 1.plate_1"][0] == "g", found
    same(found["run 1.hammer"][1], FORCE)
    same(found["run 1.plate_1"][1], MOTION.astype("f4"))
    with h5py.File(folder / "outside.h5", "w") as file:
        file.create_dataset("secret", shape=(50,), dtype="u1", external=[("/etc/passwd", 0, 50)])
    assert "no vector of numbers" in modcal("inspect", folder / "outside.h5").stderr


def ours(folder):
    rows = "\n".join(f"{i / RATE!r},{float(f)!r},{float(m)!r}" for i, (f, m) in enumerate(zip(FORCE, MOTION)))
    (folder / "own.csv").write_text(f"# sample_rate: {RATE} Hz\nt [s],F [lbf],größe/2 [m/s2]\n{rows}\n")
    for name in ("own.npy", "own.npz", "own.h5", "own.mat", "own.lvm", "own.uff"):
        done = modcal("convert", folder / "own.csv", folder / name)
        assert done.returncode == 0, done.stderr
        found, rate = read_back(folder / name)
        assert rate == RATE and found["F"][0] == "lbf", (name, rate)
        same(found["F"][1], FORCE)
        same(found["größe/2"][1], MOTION)
    fields = np.load(folder / "own.npy")
    assert fields.dtype.names == ("t [s]", "F [lbf]", "größe/2 [m/s2]")
    same(fields["F [lbf]"], FORCE)
    archive = np.load(folder / "own.npz")
    assert archive["sample_rate"] == RATE and archive["größe/2.unit"] == "m/s2"
    same(archive["größe/2"], MOTION)
    with h5py.File(folder / "own.h5") as file:
        assert file.attrs["sample_rate"] == RATE and file["größe_2"].attrs["name"] == "größe/2"
        assert file["F"].attrs["unit"] == "lbf"
        same(file["F"][:], FORCE)
    same(scipy.io.loadmat(folder / "own.mat")["F"][:, 0], FORCE)


def units(folder):
    """g and lbf of any of the formats arrive in SI."""
    report = json.loads(modcal("inspect", folder / "own.h5", "--json").stdout)
    assert [channel["unit"] for channel in report["channels"]] == ["lbf", "m/s2"], report["channels"]


def functions(folder):
    """Response functions of a plate with two modes are the same table in every format."""
    lines = np.arange(4.0, 200.0, 0.5)
    turn = 2 * np.pi
    s = 1j * turn * lines
    modes = [(60.0, 0.01, 2.0), (130.0, 0.02, -1.5)]
    response = s**2 * sum(a / (s**2 + 2 * z * turn * f * s + (turn * f)**2) for f, z, a in modes)
    two = np.stack([response, 0.3 * response * np.exp(0.2j)], axis=1)
    np.savez(folder / "h.npz", frequency=lines, H=two, **{"H.unit": "g/lbf"})
    scipy.io.savemat(folder / "h.mat", {"test": {"f": lines[:, None], "H": two, "unit": "none"}})
    with h5py.File(folder / "h.h5", "w") as file:
        file["freq"] = lines
        file["H"] = two.T.astype(">c16")
        file["H"].attrs["unit"] = "g/lbf"
    fields = np.zeros(lines.size, dtype=[("f [Hz]", "f8"), ("H_1 [g/lbf]", ">c16"), ("H_2 [g/lbf]", "c16")])
    fields["f [Hz]"], fields["H_1 [g/lbf]"], fields["H_2 [g/lbf]"] = lines, two[:, 0], two[:, 1]
    np.save(folder / "h.npy", fields)
    rows = "\n".join(",".join(repr(float(x)) for x in (f, h[0].real, h[0].imag, abs(h[1]), np.angle(h[1], deg=True)))
                     for f, h in zip(lines, two))
    (folder / "h.csv").write_text(f"frequency [Hz],H_1 real [g/lbf],H_1 imaginary [g/lbf],H_2 [g/lbf],H_2 phase [deg]\n{rows}\n")
    tables = {}
    for name in ("h.csv", "h.npz", "h.npy", "h.h5", "h.mat"):
        names, more = (("test.H_1", "test.H_2"), ", calibration: 2.204622621848776") if name == "h.mat" else (("H_1", "H_2"), "")
        channels = ", ".join(f"{{channel: {channel}{more}}}" for channel in names)
        (folder / "fit.yaml").write_text(f"kind: fit_modes\nfunctions: {{file: {name}, responses: [{channels}]}}\nlow: 10\nhigh: 190\nmost_modes: 3\n")
        done = modcal("run", folder / "fit.yaml", "--out", folder / ("out_" + name))
        assert done.returncode == 0, (name, done.stderr)
        fit = json.loads((folder / ("out_" + name) / "modes_fit.json").read_text())
        tables[name] = [(mode["f_hz"], mode["zeta"]) for mode in fit["modes"] if not mode["stands_in"]]
        for f, z, _ in modes:
            assert any(abs(found[0] / f - 1) < 1e-6 and abs(found[1] / z - 1) < 1e-5 for found in tables[name]), (name, tables)


def converted(folder):
    """The functions of h.npz, as they are written in turn from format to format."""
    theirs = np.load(folder / "h.npz")
    lines, two = theirs["frequency"], theirs["H"]
    last = folder / "h.npz"
    for name in ("conv.uff", "conv.h5", "conv.csv", "conv.mat", "conv.npz"):
        done = modcal("convert", last, folder / name)
        assert done.returncode == 0 and not done.stderr, (name, done.stderr)
        last = folder / name
    read = {"npz": np.load(folder / "conv.npz"), "mat": scipy.io.loadmat(folder / "conv.mat"), "h5": h5py.File(folder / "conv.h5")}
    for kind, file in read.items():
        assert np.array_equal(np.ravel(file["f"]), lines), kind
        for j in (0, 1):
            assert np.array_equal(np.ravel(file[f"H_{j + 1}"]), two[:, j]), kind
    assert read["npz"]["H_1.unit"] == "g/lbf" and read["h5"]["H_1"].attrs["unit"] == "g/lbf"
    rows = np.loadtxt(folder / "conv.csv", delimiter=",", skiprows=1)
    assert np.array_equal(rows[:, 0], lines) and np.array_equal(rows[:, 3] + 1j * rows[:, 4], two[:, 1])


def main():
    with tempfile.TemporaryDirectory() as name:
        theirs(Path(name))
        ours(Path(name))
        units(Path(name))
        functions(Path(name))
        converted(Path(name))


if __name__ == "__main__":
    main()
