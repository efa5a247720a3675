#!/usr/bin/python3
"""What the fuzzers begin with, besides tests/fuzz/corpus: seeds.py ROOT CORPUS TARGET... fills CORPUS/TARGET.

Experiments are those of configs/ and the tests' wrong ones; records are a short one, the tests' wrong
ones made of it, and one of every kind of sound, universal and MAT file. The dictionary holds the words of all experiments.
"""
import io
import re
import struct
import subprocess
import sys
import tempfile
import zlib
from pathlib import Path

import h5py
import numpy as np

ROWS = 60  # of the record: enough for every test, short enough to be changed everywhere


def tables(path):
    """(name, {mark: lines}) of the groups of a table of tests/experiments/cli/wrong."""
    for group in re.split(r"\n\s*\n", path.read_text()):
        lines = [line for line in group.split("\n") if line and line[0] != "#"]
        marks = {}
        for line in lines[1:]:
            marks.setdefault(line[0], []).append(line[2:])
        if lines:
            yield lines[0], marks


def experiments(root):
    for path in sorted((root / "configs").rglob("*.yaml")):
        yield path.stem, path.read_text()
    wrong = root / "tests/experiments/cli/wrong"
    bases = {name: "\n".join(marks["|"]) + "\n" for name, marks in tables(wrong / "bases.txt")}
    yield from bases.items()
    for name, marks in tables(wrong / "files.txt"):
        text = bases[marks["@"][0]]
        new = "\n".join(marks.get("+", [""])).replace("\\n", "\n").replace("\\t", "\t")
        old = "\n".join(marks.get("-", [""])).replace("\\n", "\n").replace("\\t", "\t")
        yield name, text.replace(old, new, 1) if old else text + new


def csv_records(root):
    with tempfile.TemporaryDirectory() as folder:
        good = (root / "examples/bowed_violin_d.csv").read_text().split("\n")[:ROWS]
        good.insert(3, good.pop(0))  # the tables count lines from comments before the headings
        Path(folder, "good.csv").write_text("\n".join(good) + "\n")
        yield "good", Path(folder, "good.csv").read_bytes()
        yield "functions", b"h1 [g/lbf],h1 imaginary,p [m/N],p phase [deg],c,frequency [Hz]\n" + b"".join(
            b"%g,%g,%g,%g,0.9,%g\n" % (i, 2 * i, 3 * i, 4 * i, 0.5 * i) for i in range(1, 30))
        for name, marks in tables(root / "tests/experiments/cli/wrong/records.txt"):
            for command in marks["$"]:
                subprocess.run(["sh", "-c", command], cwd=folder, stderr=subprocess.DEVNULL)
            record = Path(folder, "record.csv")
            if record.is_file():
                yield name, record.read_bytes()[:20000]
                record.unlink()


def chunk(name, content):
    return name + struct.pack("<I", len(content)) + content + b"\0" * (len(content) % 2)


def riff(code, bits, samples, comment=b"", extensible=False, rf64=False):
    frame = 2 * bits // 8
    form = struct.pack("<HHIIHH", 0xFFFE if extensible else code, 2, 8000, 8000 * frame, frame, bits)
    if extensible:
        form += struct.pack("<HHI", 22, bits, 3) + struct.pack("<H", code) + bytes.fromhex(
            "000000001000800000aa00389b71")
    info = chunk(b"LIST", b"INFO" + chunk(b"ICMT", comment + b"\0")) if comment else b""
    body = b"WAVE"
    if rf64:
        body += chunk(b"ds64", struct.pack("<QQQI", len(samples) + 80, len(samples), len(samples) // frame, 0))
    body += chunk(b"fmt ", form) + info + chunk(b"data", samples)
    return (b"RF64" + struct.pack("<I", 0xFFFFFFFF) + body) if rf64 else chunk(b"RIFF", body)


def wave64(samples):
    tail = bytes.fromhex("f3acd3118cd100c04f8edb8a")
    guid = b"riff" + bytes.fromhex("2e91cf11a5d628db04c10000")
    form = struct.pack("<HHIIHH", 1, 2, 8000, 32000, 4, 16)
    body = b"wave" + tail
    body += b"fmt " + tail + struct.pack("<Q", 24 + len(form)) + form
    body += b"data" + tail + struct.pack("<Q", 24 + len(samples)) + samples
    return guid + struct.pack("<Q", 24 + len(body)) + body


def sounds():
    values = [0.5 * ((7 * i) % 13 - 6) / 6 for i in range(64)]
    pcm16 = b"".join(struct.pack("<h", round(32767 * x)) for x in values)
    comment = b'{"modcal":{"full_scale":10,"channels":[["R1","N"],["R2","N"]]}}'
    yield "pcm8", riff(1, 8, bytes(round(128 + 127 * x) for x in values))
    yield "pcm16", riff(1, 16, pcm16, comment)
    yield "pcm24", riff(1, 24, b"".join(struct.pack("<i", round(8388607 * x))[:3] for x in values))
    yield "pcm32", riff(1, 32, b"".join(struct.pack("<i", round(2147483647 * x)) for x in values))
    yield "float", riff(3, 32, b"".join(struct.pack("<f", x) for x in values), comment)
    yield "double", riff(3, 64, b"".join(struct.pack("<d", x) for x in values), comment)
    yield "extensible", riff(3, 32, b"".join(struct.pack("<f", x) for x in values), extensible=True)
    yield "rf64", riff(1, 16, pcm16, rf64=True)
    yield "w64", wave64(pcm16)
    yield "cut", riff(1, 16, pcm16)[:-20]
    yield "nan", riff(3, 32, struct.pack("<4f", 0.1, float("nan"), float("inf"), -0.1))
    big = b"".join(struct.pack(">h", round(32767 * x)) for x in values)
    yield "au", b".snd" + struct.pack(">IIIII", 24, len(big), 3, 8000, 2) + big
    common = struct.pack(">hIh", 2, 32, 16) + bytes.fromhex("400bfa00000000000000")
    ssnd = struct.pack(">II", 0, 0) + big
    aiff = b"AIFFCOMM" + struct.pack(">I", len(common)) + common + b"SSND" + struct.pack(">I", len(ssnd)) + ssnd
    yield "aiff", b"FORM" + struct.pack(">I", len(aiff)) + aiff


def universal(values, kind, order=4, spaced=True, binary=False, function=1):
    """One data set 58 of a file of others."""
    reals = [part for value in values for part in (value.real, value.imag)] if order in (5, 6) else values
    if not spaced:
        reals = [part for i, value in enumerate(values) for part in (0.01 * i, value)]
    body = struct.pack(f"<{len(reals)}d", *reals) if binary else "".join(
        "".join(f"{real:20.11E}" for real in reals[i:i + 4]) + "\n" for i in range(0, len(reals), 4)).encode()
    head = "    -1\n" + (f"    58b{1:6}{2:6}{11:12}{len(body):12}{0:6}{0:6}{0:12}{0:12}\n" if binary else "    58\n")
    head += f"{kind}\nmade by seeds.py\n01-Jan-20 00:00:00\nNONE\nNONE\n"
    head += f"{function:5}{0:10}{0:5}{0:10} {'NONE':10}{1:10}{3:4} {'NONE':10}{1:10}{3:4}\n"
    head += f"{order:10}{len(values):10}{int(spaced):10}{0.0:13.5E}{0.01:13.5E}{0.0:13.5E}\n"
    for code, label, unit in ((17, "Time", "s"), (12, "Acceleration", kind), (0, "NONE", "NONE"), (0, "NONE", "NONE")):
        head += f"{code:10}{0:5}{0:5}{0:5} {label:20} {unit:20}\n"
    return head.encode() + body + (b"\n" if binary else b"") + b"    -1\n"


def universals():
    real = [0.5 * ((7 * i) % 13 - 6) / 6 for i in range(30)]
    both = [complex(x, -x) for x in real]
    units = (b"    -1\n   164\n         1  SI: m newton             2\n" + 3 * b"  1.00000000000000000D+00" +
             b"\n  2.73150000000000000D+02\n    -1\n")
    yield "text", units + universal(real, "m/s2") + universal(real, "N")
    yield "single", universal(real, "g", order=2)
    yield "uneven", universal(real, "m/s2", spaced=False)
    yield "binary", universal(real, "m/s2", binary=True) + universal(real, "N", binary=True)
    yield "response", universal(both, "m/s2/N", order=6, function=4)
    yield "cut", universal(real, "m/s2")[:-200]


def element(kind, content):
    """A part of a MAT 5 file."""
    return struct.pack("<II", kind, len(content)) + content + b"\0" * (-len(content) % 8)


def matrix(name, values, is_text=False, imaginary=()):
    data = element(4, struct.pack(f"<{len(values)}H", *map(ord, values))) if is_text else element(
        9, struct.pack(f"<{len(values)}d", *values))
    if imaginary:
        data += element(9, struct.pack(f"<{len(imaginary)}d", *imaginary))
    flags = element(6, struct.pack("<II", (4 if is_text else 6) | (0x800 if imaginary else 0), 0))
    size = element(5, struct.pack("<ii", 1, len(values)))
    return element(14, flags + size + element(1, name.encode()) + data)


def matlab_files():
    values = {"t": [0.01 * i for i in range(30)], "R1": [((7 * i) % 13) / 6.0 for i in range(30)],
              "R2": [((5 * i) % 11) / 6.0 for i in range(30)], "fs": [100.0]}
    head = b"MATLAB 5.0 MAT-file".ljust(124) + struct.pack("<H", 0x0100) + b"IM"
    parts = [matrix(name, held) for name, held in values.items()] + [matrix("note", "a text", is_text=True)]
    yield "5", head + b"".join(parts)
    yield "functions", head + matrix("H", values["R1"], imaginary=values["R2"]) + matrix("f", values["t"])
    yield "5z", head + b"".join(struct.pack("<II", 15, len(z)) + z for z in map(zlib.compress, parts))
    yield "4", b"".join(struct.pack("<5i", 0, 1, len(held), 0, len(name) + 1) + name.encode() + b"\0" +
                        struct.pack(f"<{len(held)}d", *held) for name, held in values.items())


def numpy_arrays():
    columns = np.array([[0.01 * i, ((7 * i) % 13) / 6, ((5 * i) % 11) / 6] for i in range(30)])
    fields = np.rec.fromarrays(columns.T, names="t [s],R1 [N],R2 [N]", formats="f8,>f4,i2")
    for name, array in (("plain", columns), ("fortran", np.asfortranarray(columns)), ("fields", fields),
                        ("complex", columns[:, 1] + 1j), ("objects", np.array([None], dtype=object))):
        with io.BytesIO() as file:
            np.save(file, array)
            yield name, file.getvalue()


def numpy_archives():
    values = {"R1": [((7 * i) % 13) / 6 for i in range(30)], "R2": [((5 * i) % 11) / 6 for i in range(30)]}
    for name, save in (("stored", np.savez), ("deflated", np.savez_compressed)):
        with io.BytesIO() as file:
            save(file, sample_rate=100.0, **{"R1.unit": "N"}, **values)
            yield name, file.getvalue()
    with io.BytesIO() as file:
        np.savez(file, H=np.array(values["R1"]) + 1j * np.array(values["R2"]), frequency=0.5 * np.arange(30), coherence=np.ones(30))
        yield "functions", file.getvalue()


def hdf5_files():
    with h5py.File("seed", "w", driver="core", backing_store=False) as file:
        file.attrs["sample_rate"] = 100.0
        for name in ("R1", "run/R2"):
            data = file.create_dataset(name, data=[((7 * i) % 13) / 6 for i in range(30)], chunks=(8,), compression=1)
            data.attrs["unit"] = "N"
        file.flush()
        yield "two", file.id.get_file_image()
    with h5py.File("seed", "w", driver="core", backing_store=False) as file:
        file.create_dataset("H", data=np.ones((2, 30), dtype=">c8") * 1j)
        file["df"] = 0.5
        file.flush()
        yield "functions", file.id.get_file_image()


def labview_files():
    rows = "".join(f"{0.01 * i:.6f}\t{((7 * i) % 13) / 6:.6f}\t{((5 * i) % 11) / 6:.6f}\n" for i in range(30))
    for name, decimal, columns in (("one", ".", "One"), ("comma", ",", "One")):
        head = (f"LabVIEW Measurement\t\nSeparator\tTab\nDecimal_Separator\t{decimal}\nX_Columns\t{columns}\n"
                "***End_of_Header***\t\n\t\n")
        part = ("Channels\t2\t\t\nSamples\t30\t30\t\nDate\t2016/08/23\t2016/08/23\t\nTime\t10:45:{0}\t10:45:{0}\t\n"
                "Y_Unit_Label\tN\tN\t\nX_Dimension\tTime\tTime\t\nX0\t0\t0\t\nDelta_X\t0.010000\t0.010000\t\n"
                "***End_of_Header***\t\t\t\nX_Value\tR1\tR2\tComment\n" + rows + "\n")
        parts = part.format("10.0") + part.format("10.3")
        yield name, (head + (parts.replace(".", ",") if decimal == "," else parts)).encode()


def mode_tables(root):
    yield "plate", (root / "configs/structures/plate_modes.json").read_bytes()
    yield "one", (b"low: 10 Hz\nhigh: 100\nsensors: [{name: a, kind: velocity}]\n"
                  b"modes: [{frequency: 20, damping_ratio: 0.01, constants: [1]}]\n")


def words(root):
    text = "\n".join(t for _, t in experiments(root))
    found = set(re.findall(r"[A-Za-z_][A-Za-z_0-9]{2,}", text))
    found |= {": ", "- ", "{", "}", "[", "]", "#", "--set ", "&a ", "*a", "<<: ", "!!str ", "---", "|", ">", "? "}
    return "".join(f'"{word}"\n' for word in sorted(found))


def main():
    root, corpus = Path(sys.argv[1]), Path(sys.argv[2])
    for target, seeds in (("experiment", lambda: ((n, t.encode()) for n, t in experiments(root))),
                          ("csv", lambda: csv_records(root)), ("wav", sounds),
                          ("uff", universals), ("mat", matlab_files), ("npy", numpy_arrays),
                          ("npz", numpy_archives), ("hdf5", hdf5_files), ("lvm", labview_files), ("table", lambda: mode_tables(root))):
        if target not in sys.argv[3:]:
            continue
        folder = corpus / target
        folder.mkdir(parents=True, exist_ok=True)
        for name, content in seeds():
            (folder / re.sub(r"\W+", "_", name)).write_bytes(content)
        if target == "experiment":
            (corpus / "experiment.dict").write_text(words(root))


if __name__ == "__main__":
    main()
