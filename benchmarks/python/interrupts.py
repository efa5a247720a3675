#!/usr/bin/python3
"""How long work goes on after Ctrl-C: interrupts.py BUILD [PRESSES]. Each task is begun anew and interrupted at moments
spread over its length; the longest delay is what counts."""
import _thread
import sys
import threading
import time
import warnings
from pathlib import Path

BUILD, PRESSES = Path(sys.argv[1]).resolve(), int((sys.argv + ["12"])[2])
ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(BUILD / "python"))
import numpy as np  # noqa: E402

import modcal  # noqa: E402

STRING = {"length": 0.33, "linear_density": 3.1e-3, "fundamental": 196, "modes": 50}


def delay(call, after):
    """Seconds from Ctrl-C to its end; None: it had ended before."""
    pressed = []

    def press():
        pressed.append(time.monotonic())
        _thread.interrupt_main()

    timer = threading.Timer(after, press)
    try:
        timer.start()
        call()
        timer.cancel()
        timer.join()
        if pressed:
            time.sleep(1)  # for a press that came as it ended
    except KeyboardInterrupt:
        return time.monotonic() - pressed[0]
    return None


def told(name, call, whole):
    found = [delay(call, whole * (i + 0.5) / PRESSES) for i in range(PRESSES)]
    found = [one for one in found if one is not None]
    print(f"{name}: {whole:.1f} s, {len(found)} times interrupted, ended after {max(found, default=float('nan')):.2f} s at most",
          flush=True)


def length(call):
    begin = time.monotonic()
    call()
    return time.monotonic() - begin


def main():
    warnings.simplefilter("ignore")
    loop = ROOT / "configs/beyond/simulator_in_the_loop.yaml"
    longer = {"scene.duration": 2, "measurement.sample_rate": "51.2 kHz"}
    problem = modcal.Problem(loop, longer)
    evaluate = lambda: problem.objective(problem.x0)  # noqa: E731
    told("an evaluation of the simulator in the loop", evaluate, length(evaluate))
    reactions = np.random.default_rng(1).normal(0, 1, (2, 5_000_000))
    inverter = modcal.Inverter(STRING, 0.03, samples=reactions.shape[1], rate=51200)
    alone = lambda: inverter(reactions[0], reactions[1])  # noqa: E731
    told("Inverter of 5 million samples", alone, length(alone))
    calibrate = lambda: modcal.run(ROOT / "configs/beyond/calibrate_to_the_bound.yaml")  # noqa: E731
    told("a calibration to the bound", calibrate, length(calibrate))


main()
