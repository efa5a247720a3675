"""The programs of README and docs/python.md run as they stand."""
import contextlib
import io
import os
import shutil
import subprocess

from cases import ROOT, Folder, main, programs


class Pages(Folder):
    def setUp(self):
        super().setUp()
        shutil.copytree(ROOT / "examples", self.folder / "examples")
        shutil.copytree(ROOT / "configs", self.folder / "configs")
        before = os.getcwd()
        os.chdir(self.folder)
        self.addCleanup(os.chdir, before)

    def said(self, program):
        told = io.StringIO()
        with contextlib.redirect_stdout(told):
            exec(compile(program, "page", "exec"), {"__name__": "page"})
        return told.getvalue()

    def test_readme(self):
        (program,) = programs("README.md")
        self.assertLessEqual(len([line for line in program.splitlines() if line.strip()]), 12)
        try:
            import matplotlib  # noqa: F401
        except ImportError:
            self.skipTest("matplotlib is not there")
        said = self.said(program)
        self.assertRegex(said, r"f0 = 294 ± 0\.00\d+ Hz")
        self.assertGreater((self.folder / "force.png").stat().st_size, 10_000)

    def test_docs(self):
        found = programs("docs/python.md")
        self.assertGreaterEqual(len(found), 3)
        for program in found:
            with self.subTest(program=program.splitlines()[2]):
                self.said(program)

    def test_notebooks(self):
        """As jupyter-nbconvert runs them; each cell in the folder of its notebook."""
        if shutil.which("jupyter-nbconvert") is None:
            self.skipTest("jupyter-nbconvert is not there")
        books = sorted((self.folder / "examples/notebooks").glob("*.ipynb"))
        self.assertGreaterEqual(len(books), 5)
        for book in books:
            with self.subTest(book=book.name):
                done = subprocess.run(["jupyter-nbconvert", "--to", "html", "--execute", str(book)], capture_output=True,
                                      text=True, env={**os.environ, "HOME": str(self.folder)})
                self.assertEqual(done.returncode, 0, done.stderr)


if __name__ == "__main__":
    main()
