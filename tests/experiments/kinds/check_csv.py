"""check_csv.py REPORTS EXAMPLES MODCAL: reads every CSV file of the reports that configs_test has written into the
folder, of a calibration, of the example record and of a list, by pandas.read_csv(comment="#") and
numpy.genfromtxt(names=True) as they are. Exit code 77: there is no pandas or no NumPy.
"""
import csv
import pathlib
import re
import subprocess
import sys
import tempfile

try:
    import numpy
    import pandas
except ImportError as error:
    print(f"{error}: CSV files are not read by others (install python3-numpy and python3-pandas)")
    sys.exit(77)


def is_number(text):
    """Whether the text of a cell reads as a number."""
    try:
        float(text)
        return True
    except ValueError:
        return False


def rows_of(file):
    """Headings and rows by Python's own reader, without comments."""
    with open(file, newline="", encoding="utf-8") as stream:
        rows = [row for row in csv.reader(stream) if row and not row[0].startswith("#")]
    return rows[0], rows[1:]


def findings_of(file):
    """What pandas and NumPy read otherwise than it stands in the file."""
    headings, rows = rows_of(file)
    table = pandas.read_csv(file, comment="#")
    # Columns of one name get a number behind it.
    names = [re.sub(r"\.[0-9]+$", "", name) for name in table.columns]
    if [name for name, heading in zip(names, headings) if not heading.startswith(name)] or len(names) != len(headings):
        yield f"pandas has the columns {list(table.columns)} for {headings}"
    if len(table) != len(rows):
        yield f"pandas reads {len(table)} of {len(rows)} rows"
    try:
        array = numpy.genfromtxt(file, names=True, delimiter=",", dtype=None, encoding="utf-8")
    except ValueError as error:
        yield f"NumPy reads nothing: {str(error).splitlines()[:2]}"
        return
    if array.dtype.names is None or len(array.dtype.names) != len(headings):
        yield f"NumPy has the columns {array.dtype.names} for {headings}"
        return
    if array.size != len(rows):
        yield f"NumPy reads {array.size} of {len(rows)} rows"
    for place, name in enumerate(array.dtype.names):
        cells = [row[place] for row in rows if row[place]]
        if cells and all(map(is_number, cells)):
            if array[name].dtype.kind not in "if" or table.dtypes.iloc[place].kind not in "if":
                yield f"{headings[place]} is no column of numbers"


def write_files(examples, modcal, folder):
    """All kinds of CSV files that no report of an experiment file has, below the folder."""
    record = pathlib.Path(examples) / "bowed_violin_d.csv"
    (folder / "record.csv").write_bytes(record.read_bytes())

    def run(*words):
        subprocess.run([modcal, *words], check=True, cwd=folder, stdout=subprocess.DEVNULL,
                       stderr=subprocess.DEVNULL)
    run("new", "calibrate", "record.csv", "--length", "0.33 m", "--out", "mine.yaml")
    run("run", "mine.yaml")
    run("new", "simulate", "--out", "strokes.yaml")
    run("run", "strokes.yaml", "--set",
        "sweep={product: {scene.bow.normal_force: [0.5 N, 1 N]}}")


def main():
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        write_files(*sys.argv[2:4], folder)
        files = sorted(pathlib.Path(sys.argv[1]).rglob("*.csv")) + sorted(folder.rglob("*.csv"))
        found = [f"{file}: {finding}" for file in files for finding in findings_of(file)]
    print("\n".join(found) if found else f"{len(files)} files read")
    if found or len(files) < 50:
        sys.exit(1)


if __name__ == "__main__":
    main()
