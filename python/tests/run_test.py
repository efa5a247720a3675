"""Experiments in memory and in folders: the program's numbers, its sentences, its places."""
import _thread
import json
import pickle
import signal
import subprocess
import threading
import time

import numpy as np
from cases import CALIBRATE, INVERT, PROGRAM, SIMULATE, SWEEP, Folder, main

import modcal
from modcal import yaml


class SameBits(Folder):
    def compare(self, experiment):
        """What run() returns and what load() reads of the program's folder."""
        file = self.file(experiment)
        self.program("run", file, "--out", "out", "-q")
        stored, found = modcal.load(self.folder / "out"), modcal.run(file)
        self.assertEqual(set(stored.signals), set(found.signals))
        for name, samples in found.signals.items():
            np.testing.assert_array_equal(samples, stored.signals[name], name)
            self.assertEqual(found.units[name], stored.units[name])
        self.assertTrue(set(found.tables) <= set(stored.tables))
        for name, table in found.tables.items():
            if name == "search":  # the seconds it took
                continue
            self.assertEqual(table.columns, stored.tables[name].columns, name)
        return found, stored

    def test_simulation(self):
        found, stored = self.compare(SIMULATE)
        self.assertEqual((found.kind, found.title, found.rate), ("simulate", "a stroke", 12800.0))
        self.assertEqual(len(found.f_c), 2560)
        np.testing.assert_array_equal(found.time, np.arange(2560) / 12800)
        self.assertEqual(stored.title, "a stroke")

    def test_inversion(self):
        found, _ = self.compare(INVERT)
        self.assertGreater(found.identification["correlation"][0], 0.9)

    def test_calibration(self):
        found, stored = self.compare(CALIBRATE)
        self.assertEqual(found.parameters, stored.parameters)
        names = [one["name"] for one in found.parameters]
        self.assertEqual(names, ["f0", "B", "x_c"])

    def test_overrides_are_those_of_the_program(self):
        file = self.file(SIMULATE)
        self.program("run", file, "--out", "out", "-q", "--set", "scene.bow.position=41 mm")
        found = modcal.run(file, {"scene.bow.position": "41 mm"})
        np.testing.assert_array_equal(found.f_c, modcal.load(self.folder / "out").f_c)
        np.testing.assert_array_equal(found.f_c, modcal.run(file, {"scene.bow.position": 0.041}).f_c)
        self.assertFalse(np.array_equal(found.f_c, modcal.run(file).f_c))

    def test_into_a_folder(self):
        file = self.file(CALIBRATE)
        found = modcal.run(file, out=self.folder / "ours")
        self.program("run", file, "--out", "theirs", "-q")
        for name in ("parameters.csv", "identified.csv", "resolved.yaml"):
            self.assertEqual((self.folder / "ours" / name).read_bytes(), (self.folder / "theirs" / name).read_bytes())
        self.assertTrue((self.folder / "ours" / "report.html").exists())
        self.assertIn("f0", found.summary)
        self.assertEqual(found.status, "ok")

    def test_new_finds_its_examples(self):
        text = modcal.new("simulate")
        self.assertEqual(modcal.validate(text), [])

    def test_threads_of_python(self):
        alone = [modcal.run(INVERT, {"seed": seed}).f_c_joint for seed in range(4)]
        together = [None] * 4

        def work(seed):
            together[seed] = modcal.run(INVERT, {"seed": seed}).f_c_joint

        threads = [threading.Thread(target=work, args=(seed,)) for seed in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        for one, other in zip(alone, together):
            np.testing.assert_array_equal(one, other)


class Lists(Folder):
    def test_in_memory(self):
        found = modcal.run(SWEEP)
        self.assertEqual(len(found.tables["tasks"]), 3)

    def test_folder_goes_on_and_is_loaded(self):
        file, out = self.file(SWEEP), self.folder / "out"
        self.program("run", file, "--out", "out", "-q", "--shard", "1/3")
        begun = modcal.load(out)
        self.assertEqual(begun.summary, "1 of 3 tasks done, 0 failed")
        self.assertEqual(begun.tables["tasks"]["seed"], ["1"])
        whole = modcal.run(file, out=out)
        self.assertEqual(len(whole.tables["tasks"]), 3)
        self.assertEqual(whole.tables["tasks"]["identification.correlation"][0],
                         begun.tables["tasks"]["identification.correlation"][0])
        self.assertEqual(modcal.ask("status", str(out))["done"], 3)


class Loaded(Folder):
    def test_what_a_run_said(self):
        file = self.file(CALIBRATE)
        found = modcal.run(file, out=self.folder / "ours")
        stored = modcal.load(self.folder / "ours")
        for key in ("status", "answer", "summary", "warnings", "missed"):
            self.assertEqual(getattr(stored, key), getattr(found, key), key)
        told = json.loads(self.program("run", file, "--out", "theirs", "--json", "-q"))
        self.assertEqual(stored.answer, told["verdict"])
        self.assertEqual(stored.warnings, told.get("warnings", []))
        self.assertIn("f0", stored.summary)
        self.assertIn(stored.summary.splitlines()[0], stored._repr_html_().replace("&lt;", "<").replace("&gt;", ">"))

    def test_warnings_and_failures(self):
        cut = {"calibration.budget.evaluations": 2, "calibration.optimizer": "nlopt", "scene.duration": 0.05}
        found = modcal.run(self.file(CALIBRATE), cut, out=self.folder / "out")
        stored = modcal.load(self.folder / "out")
        self.assertEqual((stored.status, stored.warnings), (found.status, found.warnings))
        self.assertTrue(stored.warnings, stored.summary)

    def test_a_study_that_runs(self):
        long = {**SWEEP, "scene": {**SWEEP["scene"], "duration": 2}, "sweep": {"product": {"seed": list(range(2000))}}}
        words = [PROGRAM, "run", str(self.file(long)), "--out", "out", "-q", "--threads", "1"]
        with subprocess.Popen(words, cwd=self.folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as running:
            out = self.folder / "out"
            try:
                seen = None
                while seen is None or not len(seen.tables["tasks"]):
                    self.assertIsNone(running.poll())
                    time.sleep(0.1)
                    if (out / "resolved.yaml").exists() and (out / "journal").is_dir():
                        seen = modcal.load(out)
            finally:
                running.send_signal(signal.SIGINT)
                running.wait()
        self.assertEqual((seen.kind, seen.status), ("invert", "running"))
        self.assertRegex(seen.summary, r"^[1-9]\d* of 2000 tasks done, 0 failed")
        self.assertIn("identification.correlation", seen.tables["tasks"].columns)
        self.assertEqual(modcal.load(out).status, "unfinished")

    def test_a_single_run_that_was_stopped(self):
        file = self.file(SIMULATE)
        self.program("run", file, "--out", "out", "-q")
        for written in (self.folder / "out").iterdir():
            if written.is_file() and written.name not in ("provenance.json", "resolved.yaml"):
                written.unlink()
        begun = modcal.load(self.folder / "out")
        self.assertEqual((begun.kind, begun.status, begun.title), ("simulate", "unfinished", "a stroke"))


class Refusals(Folder):
    def refused(self, call, *arguments, **keys):
        with self.assertRaises(modcal.InvalidInput) as caught:
            call(*arguments, **keys)
        return caught.exception

    def test_place_and_remedy(self):
        file = self.file(yaml.block(SIMULATE) + "titel: a stroke\nmeasurment: {}\n")
        error = self.refused(modcal.run, file)
        line = len(SIMULATE) + 1
        self.assertEqual((error.path, error.line, error.column), (str(file), line, 1))
        self.assertEqual(error.remedy, 'did you mean "title"?')
        self.assertIn(f"{file}:{line}:1: ", str(error))
        self.assertIn("^", str(error))
        self.assertEqual([one.line for one in error.mistakes], [line, line + 1])
        into = self.refused(modcal.run, file, out=self.folder / "out")
        self.assertEqual([one[:4] for one in into.mistakes], [one[:4] for one in error.mistakes])
        self.assertEqual(pickle.loads(pickle.dumps(error)).mistakes, error.mistakes)

    def test_sentences_of_the_program(self):
        file = self.file({**SIMULATE, "simulator": {"type": "modal_evnt"}})
        answer = json.loads(self.program("validate", file, "--json", code=3))
        self.assertEqual([one.text for one in modcal.validate(file)], [one["text"] for one in answer["mistakes"]])
        self.assertEqual(modcal.validate(self.file(SIMULATE)), [])

    def test_override(self):
        error = self.refused(modcal.run, SIMULATE, {"scene.bow.velocity": 0.1, "scene.duration": "3 m"})
        self.assertEqual((error.path, error.line), ("--set 2", 1))

    def test_text_and_dictionary(self):
        self.assertEqual(self.refused(modcal.run, "kind: simulate\nscene: 3\n").path, "<text>")
        self.assertIn("unknown kind", str(self.refused(modcal.run, {"kind": "simulat"})))

    def test_missing(self):
        self.assertIn("no-such", str(self.refused(modcal.run, self.folder / "no-such.yaml")))
        self.assertIn("no run", str(self.refused(modcal.load, self.folder)))
        self.assertIn("no task", str(self.refused(modcal.ask, "replay", "out", "-1")))
        self.assertIn("unknown", str(self.refused(modcal.describe, "objective", "no_such")))

    def test_attributes_that_are_not_there(self):
        with self.assertRaisesRegex(AttributeError, "has no f_x; it has .*f_c"):
            modcal.run(SIMULATE).f_x


class Interrupt(Folder):
    LONG = {**SIMULATE, "scene": {**SIMULATE["scene"], "duration": 600}}

    def test_ctrl_c_ends_a_simulation(self):
        begin = time.monotonic()
        pressed = []
        shares = []

        def press():
            time.sleep(0.5)
            pressed.append(time.monotonic())
            _thread.interrupt_main()

        threading.Thread(target=press).start()
        with self.assertRaises(KeyboardInterrupt):
            modcal.run(self.LONG, progress=shares.append)
        delay = time.monotonic() - pressed[0]
        # What was left of the simulation would have taken many times as long, on any machine.
        left = (pressed[0] - begin) * (1.0 - shares[-1]) / max(shares[-1], 1e-3)
        self.assertLess(delay, 0.5 * left)
        self.assertEqual(len(modcal.run(SIMULATE).f_c), 2560)  # the wish is forgotten

    def test_what_progress_raises_ends_it(self):
        def refuse(share):
            raise LookupError(share)

        with self.assertRaises(LookupError):
            modcal.run(self.LONG, progress=refuse)

    def test_python_goes_on_beside_it(self):
        class Enough(Exception):
            pass

        counts = []
        shares = []
        done = threading.Event()

        def count():
            while not done.is_set():
                counts.append(0)
                time.sleep(0.001)

        def progress(share):
            shares.append(share)
            if len(counts) > 20:
                raise Enough

        thread = threading.Thread(target=count)
        thread.start()
        try:
            # With Python's lock held the counts stand still, and the simulation comes to its end.
            with self.assertRaises(Enough):
                modcal.run(self.LONG, progress=progress)
        finally:
            done.set()
            thread.join()
        self.assertTrue(all(0.0 <= share <= 1.0 for share in shares))

    def test_progress_ends_at_one(self):
        shares = []
        modcal.run(SIMULATE, progress=shares.append)
        self.assertEqual(shares[-1], 1.0)


class Told(Folder):
    def test_what_can_stand_in_a_file(self):
        self.assertIn("calibrate", modcal.plugins("experiment"))
        self.assertIn("objective", modcal.plugins())
        keys = [one["key"] for one in modcal.describe("experiment", "calibrate")["options"]]
        self.assertIn("calibration", keys)
        self.assertEqual(modcal.schema(), json.loads(self.program("schema")))

    def test_limit(self):
        file = self.file(CALIBRATE)
        self.assertEqual(modcal.limit(file), json.loads(self.program("limit", file, "--json")))

    def test_views(self):
        found = modcal.run(CALIBRATE)
        told = found.to_dict()
        self.assertEqual(told["calibration"]["parameters"], found.parameters)
        json.dumps(told)
        self.assertIn("<table>", found._repr_html_())
        self.assertIn("f0", repr(found))
        self.assertIn("parameters", dir(found))
        try:
            import pandas  # noqa: F401
        except ImportError:
            self.skipTest("pandas is not there")
        self.assertEqual(list(found.to_frame("parameters")["name"]), ["f0", "B", "x_c"])
        self.assertEqual(len(found.to_frame()), len(found.time))

    def test_arrays_outlive_their_result(self):
        force = modcal.run(SIMULATE).f_c
        copy = force.copy()
        modcal.run(SIMULATE, {"scene.bow.position": 0.05})
        np.testing.assert_array_equal(force, copy)

    def test_memory_does_not_grow(self):
        def resident():
            with open("/proc/self/statm", encoding="ascii") as sizes:
                return int(sizes.read().split()[1]) * 4096

        def work(times):
            for _ in range(times):
                modcal.run({**SIMULATE, "scene": {**SIMULATE["scene"], "duration": 0.01}})

        work(100)
        before = resident()
        work(500)
        self.assertLess(resident() - before, 8e6)


if __name__ == "__main__":
    main()
