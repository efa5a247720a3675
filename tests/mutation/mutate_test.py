#!/usr/bin/env python3
"""The tool itself on a planted kernel: what a test sees is killed, what none sees survives, what is
proved equivalent is counted apart, and a mutant that never ends is killed by the clock.

mutate_test.py ROOT CXX; ROOT's own equivalent.txt must hold nothing but mutants of today.
"""
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE))
from operators import masked, mutants_of  # noqa: E402

ROOT, CXX = Path(sys.argv[1]), sys.argv[2]

KERNEL = """double seen(double x) { return x + 3.0; }
double unseen(double x) { return x * 5.0; }
double magnitude(double x) { return x < 0.0 ? -x : x; }
int steps(double end) {
  int n = 0;
  for (double x = 0.0; x > end; x = x - 1.0) ++n;
  return n;
}
"""
TEST = """double seen(double x);
double unseen(double x);
double magnitude(double x);
int steps(double end);
int main() { return seen(1.0) == 4.0 && unseen(0.0) == 0.0 && magnitude(-2.0) == 2.0 && steps(-3.0) == 3 ? 0 : 1; }
"""
NINJA = """rule cxx
  command = {cxx} -c $in -o $out
rule archive
  command = ar qc $out $in && ranlib $out
rule link
  command = : && {cxx} $in -o $out && :
build libsim/planted.o: cxx {root}/libsim/planted/kernel.cpp
build libsim/libplanted.a: archive libsim/planted.o
build tests/kernel.o: cxx {root}/tests/libsim/planted/kernel_test.cpp
build tests/libsim_planted_tests: link tests/kernel.o libsim/libplanted.a
"""
PROOFS = """# a comment
libsim/planted/kernel.cpp: double magnitude(double x) { return x <= 0.0 ? -x : x; } ## -0 equals 0
"""


class Planted(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        root = Path(cls.folder.name)
        for name in ("libsim/planted", "libinverse", "libcalib", "tests/libsim/planted", "build"):
            (root / name).mkdir(parents=True)
        (root / "libsim/planted/kernel.cpp").write_text(KERNEL)
        (root / "tests/libsim/planted/kernel_test.cpp").write_text(TEST)
        (root / "build/build.ninja").write_text(NINJA.format(cxx=CXX, root=root))
        (root / "proofs.txt").write_text(PROOFS)
        subprocess.run(["ninja", "-C", str(root / "build")], check=True, capture_output=True)
        cls.root = root

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def mutate(self, *options):
        command = [sys.executable, str(HERE / "mutate.py"), str(self.root), str(self.root / "build"),
                   "--equivalent", str(self.root / "proofs.txt"), "--slack", "1", *options]
        return subprocess.run(command, capture_output=True, text=True, env=dict(os.environ, LC_ALL="C"))

    def test_everything_drawn_is_judged_rightly(self):
        run = self.mutate("--count", "100", "--seed", "7")
        lines = run.stdout.splitlines()
        self.assertEqual(run.returncode, 1, run.stdout + run.stderr)
        survivors = [line for line in lines if line.startswith("SURVIVED")]
        self.assertTrue(survivors and all("kernel.cpp:2 " in line for line in survivors[:2]), run.stdout)
        self.assertIn("  + double unseen(double x) { return x / 5.0; }", "\n".join(lines))
        for wrong in ("x - 3.0", "(2.0 * 3.0)"):
            self.assertTrue(any(line.startswith("killed") and wrong in line for line in lines), wrong)
        self.assertTrue(any(line.startswith("killed") and "x = x + 1.0" in line for line in lines),
                        "what never ends")
        self.assertIn("1 equivalent", lines[-1])

    def test_a_seed_draws_the_same_mutants_again(self):
        once, again, other = (self.mutate("--list", "--count", "5", "--seed", s).stdout for s in "112")
        self.assertEqual(once, again)
        self.assertNotEqual(once, other)

    def test_a_run_goes_on_from_the_verdicts_it_kept(self):
        kept = self.root / "verdicts.txt"
        options = ("--only", "double seen", "--results", str(kept))
        self.assertIn("2 mutants, 2 killed", self.mutate(*options).stdout)
        line = kept.read_text().splitlines()[0]
        kept.write_text(line.replace('"killed"', '"survived"') + "\n")
        self.assertIn("2 mutants, 1 killed, 1 survived", self.mutate(*options).stdout)
        self.assertEqual(len(kept.read_text().splitlines()), 2, "the second is judged again")

    def test_nothing_to_find_is_a_success(self):
        run = self.mutate("--only", "return x - 3.0")
        self.assertEqual(run.returncode, 0, run.stdout)
        self.assertIn("1 mutants, 1 killed", run.stdout)

    def test_a_proof_of_nothing_is_told(self):
        self.assertEqual(self.mutate("--check").returncode, 0)
        (self.root / "gone.txt").write_text("libsim/planted/kernel.cpp: nothing ## proof\n")
        run = self.mutate("--check", "--equivalent", str(self.root / "gone.txt"))
        self.assertEqual(run.returncode, 1)
        self.assertIn("no mutant any more: libsim/planted/kernel.cpp: nothing", run.stdout)

    def test_the_proofs_of_the_tree_are_of_mutants(self):
        run = subprocess.run([sys.executable, str(HERE / "mutate.py"), str(ROOT), ".", "--check"],
                             capture_output=True, text=True)
        self.assertEqual(run.returncode, 0, run.stdout + run.stderr)


class Operators(unittest.TestCase):
    def new_lines(self, operator, text):
        return [m.new for m in mutants_of("x.cpp", text) if m.operator == operator]

    def test_each_makes_its_change(self):
        for operator, old, new in [
                ("sign", "a = b + c;", "a = b - c;"), ("product", "a *= b / c;", "a /= b / c;"),
                ("comparison", "if (a < b) return;", "if (a <= b) return;"),
                ("constant", "a = 1e-3;", "a = (2.0 * 1e-3);"),
                ("term", "a = b + f(c, g(d));", "a = b;"),
                ("root", "a = std::sqrt(b);", "a = (b);"), ("index", "a = b[k];", "a = b[k - 1];"),
                ("extreme", "a = std::max(b, c);", "a = std::min(b, c);"),
                ("logic", "if (a && b) return;", "if (a || b) return;")]:
            self.assertIn(new, self.new_lines(operator, old), operator)

    def test_what_is_no_arithmetic_is_left_alone(self):
        for text in ('// a + b\n', '/* a * b */', 'f("a + b");', '#define A (b + c)\n', "f('+', \" - \");",
                     "MODCAL_REQUIRE(a < b, \"no\", c + d);", "double values[3] = {};", "double values[n][3];",
                     "assert(a + b == c);", "[k](int i) {}",
                     "a = 0.0;", "std::vector<int> a;"):
            self.assertEqual([m.new for m in mutants_of("x.cpp", text)], [], text)

    def test_a_term_of_a_product_stays(self):
        self.assertEqual(self.new_lines("term", "a = b + f(c) * d;"), [])
        self.assertEqual(len(masked("a // b\nc")), len("a // b\nc"))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
