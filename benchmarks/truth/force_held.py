"""How a force that `modcal calibrate` identified stands to the true one."""
import csv
import re

import numpy as np


def force_held(identified, record):
    """Error of f_c over the standard deviation of the true one, share of the samples in the 95 % band, and the mean deviation over the
    error's; of what lies below the band's limit, without means, a tenth of the record at its begin and a twentieth at its
    end left out."""
    text = identified.read_text().splitlines()
    limits = [re.search(r"side joint: .* below ([\d.e+]+) Hz", line) for line in text if line.startswith("#")]
    rows = list(csv.reader(line for line in text if not line.startswith("#")))
    names = [name.split(" ")[0] for name in rows[0]]
    column = lambda name: np.array([float(row[names.index(name)] or "nan") for row in rows[1:]])
    found, deviation = column("f_c_joint"), column("f_c_joint_deviation")
    with open(record) as file:
        rows = list(csv.reader(line for line in file if not line.startswith("#")))
    place = [name.split(" ")[0] for name in rows[0]].index("f_c")
    time, truth = (np.array([float(row[i]) for row in rows[1:]]) for i in (0, place))
    spectrum, f = np.fft.rfft(truth), np.fft.rfftfreq(truth.size, time[1] - time[0])
    limit = next((float(match[1]) for match in limits if match), np.inf)
    truth = np.fft.irfft(np.where(f > limit, 0, spectrum), truth.size)
    inner = slice(truth.size // 10, truth.size - truth.size // 20)
    error = (found - truth)[inner]
    error -= error.mean()
    return {"error": error.std() / truth[inner].std(), "held": float(np.mean(abs(error) < 1.959964 * deviation[inner])),
            "deviation": deviation[inner].mean() / error.std()}
