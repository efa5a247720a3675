#!/usr/bin/env python3
"""Mutation testing: which small wrong changes to the numerical kernels does no test see?

mutate.py ROOT BUILD --seed S --count N draws N mutants of the .cpp and -inl.hpp files of libsim,
libinverse and libcalib: an operator (operators.py) evenly, then one of its places evenly. Of each,
the translation units that hold it are compiled anew, linked before the static libraries of BUILD,
which has to be built without unity (the preset mutation), and the test files of the programs built
there run that link it, nearest by folder first. A test that fails or does not end in time kills the
mutant. Survivors are printed with what they change; those that
equivalent.txt proves to change nothing are counted apart. Exit 0: no other survivor; 1: some.

--list prints the mutants drawn and ends; --only TEXT draws among those whose path or new line holds
TEXT; --results FILE keeps verdicts, so that a run which was ended goes on (strike out the lines of
those to be judged again); --check tells which lines of equivalent.txt are no mutant any more.
"""
import argparse
import copy
import json
import os
import random
import re
import resource
import shlex
import shutil
import subprocess
import sys
import threading
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
from build import Build  # noqa: E402
from operators import OPERATORS, mutants_of  # noqa: E402

LIBRARIES = ("libsim", "libinverse", "libcalib")
LINKING = 0.7  # seconds
# Compiled with assertions, which show what reads past an array's end: subscripts are shifted, summed
# and limited.
ASSERTED = ("index", "comparison", "sign", "extreme")
# Files, texts and lists of names hold no numerics.
NO_KERNEL = re.compile(r"^libsim/(base|records)/|/registry\.cpp$|_options\.cpp$|_text\.cpp$")


def kernels(root):
    found = []
    for library in LIBRARIES:
        for path in sorted((root / library).rglob("*")):
            name = str(path.relative_to(root))
            if name.endswith((".cpp", "-inl.hpp")) and not NO_KERNEL.search(name):
                found.append(name)
    return found


def drawn(root, seed, count, only):
    """`count` different mutants, or all there are."""
    by_operator = {name: [] for name in OPERATORS}
    for path in kernels(root):
        for mutant in mutants_of(path, (root / path).read_text()):
            if only in mutant.key():
                by_operator[mutant.operator].append(mutant)
    source, result = random.Random(seed), []
    while len(result) < count and any(by_operator.values()):
        sites = by_operator[source.choice([n for n in OPERATORS if by_operator[n]])]
        result.append(sites.pop(source.randrange(len(sites))))
    return result


class Results:
    """Verdicts, a line of JSON each in a file that a run goes on from; without a file, none are kept."""

    def __init__(self, path):
        self.path, self.known = path, {}
        if path and path.exists():
            for line in path.read_text().splitlines():
                row = json.loads(line)
                self.known[row["mutant"]] = (row["verdict"], row["by"])

    def add(self, mutant, verdict, by):
        self.known[mutant.report()] = (verdict, by)
        if self.path:
            with self.path.open("a") as file:
                file.write(json.dumps({"verdict": verdict, "by": by, "mutant": mutant.report()}) + "\n")


class Judge:
    """Compiles mutants, runs tests, tells what becomes of each."""

    def __init__(self, build, scratch, most_seconds, slack):
        self.build, self.scratch = build, scratch
        self.most_seconds, self.slack = most_seconds, slack
        self.memory, self.sound, self.lock = 4 << 30, {}, threading.Lock()

    def run(self, command, folder, seconds):
        """Exit code; None where it does not end in time."""
        def limit():
            resource.setrlimit(resource.RLIMIT_AS, (self.memory, self.memory))
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        with open(os.devnull, "w") as nowhere, \
                subprocess.Popen(command, cwd=folder, stdout=nowhere, stderr=nowhere,
                                 start_new_session=True, preexec_fn=limit) as process:
            try:
                return process.wait(timeout=seconds)
            except subprocess.TimeoutExpired:
                os.killpg(process.pid, 9)
                return None

    def is_sound(self, test):
        """Whether it passes without any mutant, linked as with one; others tell nothing."""
        with self.lock:
            if test not in self.sound:
                folder = self.scratch / "sound"
                folder.mkdir(exist_ok=True)
                self.sound[test] = self.run(self.linked(test, [], folder), folder, 600) == 0
                if not self.sound[test]:
                    print(f"{test} fails without any mutant: build the tests first", flush=True)
            return self.sound[test]

    def compile(self, mutant, folder):
        """The objects that hold it; no list where the compiler refuses."""
        shadow = folder / "shadow"
        changed = shadow / mutant.path
        changed.parent.mkdir(parents=True)
        changed.write_text(mutant.changed)
        objects = []
        for i, output in enumerate(self.build.objects_of(mutant.path)):
            words = shlex.split(self.build.compile[output])
            words = [w for w in words if w not in ("ccache", "-Werror", "-MD")]
            for option in ("-MT", "-MF"):
                if option in words:
                    at = words.index(option)
                    del words[at:at + 2]
            # Before all other folders, so that a file that includes itself takes the changed one.
            words.insert(1, f"-I{shadow}")
            if mutant.operator in ASSERTED:
                words += ["-D_GLIBCXX_ASSERTIONS", "-UNDEBUG", "-Wno-invalid-pch"]
            words[words.index("-o") + 1] = str(folder / f"{i}.o")
            if self.build.source[output] == mutant.path:
                words[words.index("-c") + 1] = str(changed)
            if subprocess.run(words, cwd=self.build.folder, capture_output=True).returncode:
                return None
            objects.append(str(folder / f"{i}.o"))
        return objects

    def linked(self, test, objects, folder):
        """How its program is called, which is linked in the folder where it is not yet."""
        name, file = self.build.tests[test]
        program = folder / Path(name).name
        if program.exists():
            return [str(program), file]
        command, inputs = self.build.link[name]
        command = command.replace(f" -o {name} ", f" -o {program} ", 1)
        command = command.replace(f" {inputs[0]} ", f" {' '.join(objects)} {inputs[0]} ", 1)
        command = re.sub(r"^: && | && :\s*$", "", command) + " -Wl,--allow-multiple-definition"
        linked = subprocess.run(command, shell=True, cwd=self.build.folder, capture_output=True)
        if linked.returncode:
            raise RuntimeError(f"{name} cannot be linked: {linked.stderr.decode()[-400:]}")
        return [str(program), file]

    def fails(self, test, objects, folder):
        seconds = self.slack + 10.0 * self.build.seconds.get(test, 1.0)
        code = self.run(self.linked(test, objects, folder), folder, seconds)
        return code != 0 and self.is_sound(test)

    def by_itself(self, mutant, test, folder):
        """Whether the unchanged file passes, compiled as the mutant was."""
        if mutant.operator not in ASSERTED:
            return True
        plain, here = copy.copy(mutant), folder / "plain"
        plain.changed = (self.build.root / mutant.path).read_text()
        shutil.rmtree(here, ignore_errors=True)
        here.mkdir()
        passes = self.run(self.linked(test, self.compile(plain, here), here), here, 600) == 0
        if not passes:
            print(f"{test} fails with the assertions of {mutant.path}", flush=True)
        return passes

    def verdict(self, number, mutant):
        """(mutant, verdict, by which test or after how many)."""
        folder = self.scratch / str(number)
        folder.mkdir()
        try:
            objects = self.compile(mutant, folder)
            if not objects:
                return mutant, "not compiled" if objects is None else "in no library", ""
            spent, ran = 0.0, 0
            for test in self.build.tests_of(mutant.path):
                linked = (folder / Path(self.build.tests[test][0]).name).exists()
                seconds = (0.0 if linked else LINKING) + self.build.seconds.get(test, 1.0)
                if ran > 0 and spent + seconds > self.most_seconds:
                    continue
                spent, ran = spent + seconds, ran + 1
                if self.fails(test, objects, folder) and self.by_itself(mutant, test, folder):
                    return mutant, "killed", test
            return mutant, "survived", f"{ran} tests"
        finally:
            shutil.rmtree(folder, ignore_errors=True)


def equivalents(path):
    """{key: proof}: a line each, `file: new line of code ## proof`."""
    lines = [line for line in path.read_text().splitlines() if line and line[0] != "#"]
    return dict(line.split(" ## ", 1) for line in lines)


def check_equivalents(root, proofs):
    every = {m.key() for path in kernels(root) for m in mutants_of(path, (root / path).read_text())}
    gone = sorted(set(proofs) - every)
    for key in gone:
        print(f"equivalent.txt: no mutant any more: {key}")
    return 1 if gone else 0


def judge_all(judge, mutants, proofs, results, jobs):
    """Prints what becomes of each; the counts."""
    counts = {name: 0 for name in ("killed", "survived", "equivalent", "not compiled", "in no library")}
    todo = []
    for number, mutant in enumerate(mutants):
        if mutant.key() in proofs:
            counts["equivalent"] += 1
        else:
            todo.append((number, mutant))

    def verdict(pair):
        if pair[1].report() not in results.known:
            results.add(*judge.verdict(*pair))
        return pair[1], *results.known[pair[1].report()]

    with ThreadPoolExecutor(jobs) as pool:
        for mutant, what, by in pool.map(verdict, todo):
            counts[what] += 1
            text = mutant.report() if what == "survived" else f"{mutant.path}:{mutant.line}: {mutant.new}"
            print(f"{what.upper() if what == 'survived' else what} {text}  [{by}]", flush=True)
    return counts


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("root", type=Path)
    parser.add_argument("build", type=Path)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=20)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--seconds", type=float, default=60.0, help="of tests that a mutant may take")
    parser.add_argument("--slack", type=float, default=20.0,
                        help="seconds beyond ten times its own after which a test has not ended")
    parser.add_argument("--only", default="")
    parser.add_argument("--equivalent", type=Path, default=Path(__file__).parent / "equivalent.txt")
    parser.add_argument("--results", type=Path, help="verdicts so far, which are kept and not judged again")
    parser.add_argument("--list", action="store_true")
    parser.add_argument("--check", action="store_true")
    how = parser.parse_args()
    root, proofs = how.root.resolve(), equivalents(how.equivalent)
    if how.check:
        return check_equivalents(root, proofs)
    mutants = drawn(root, how.seed, how.count, how.only)
    if how.list:
        for mutant in mutants:
            print(mutant.report())
        return 0
    scratch = how.build.resolve() / "mutation"
    shutil.rmtree(scratch, ignore_errors=True)
    scratch.mkdir()
    judge = Judge(Build(root, how.build.resolve()), scratch, how.seconds, how.slack)
    counts = judge_all(judge, mutants, proofs, Results(how.results), how.jobs)
    print(f"seed {how.seed}: {len(mutants)} mutants, " +
          ", ".join(f"{count} {name}" for name, count in counts.items() if count))
    return 1 if counts["survived"] else 0


if __name__ == "__main__":
    sys.exit(main())
