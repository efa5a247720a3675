"""The stubs say what the module has; the package and a program that uses it are typed strictly."""
import json
import os
import shutil
import subprocess
import sys

from cases import ROOT, Folder, main, programs

try:
    import mypy  # noqa: F401
except ImportError:
    sys.exit(77)

USER = '''
import modcal

found: modcal.Result = modcal.run("mine.yaml", {"seed": 2})
problem = modcal.Problem("mine.yaml")
value: float = problem.objective(problem.x0)
search: modcal.Search = problem.minimize("nlopt", budget={"evaluations": 10})
'''


# Libraries that are not typed.
SETTINGS = "[mypy]\n[mypy-scipy.*]\nignore_missing_imports = True\n"


def cells(notebook):
    """The code of a notebook as one program."""
    held = json.loads(notebook.read_text(encoding="utf-8"))["cells"]
    return "\n".join("".join(cell["source"]) for cell in held if cell["cell_type"] == "code") + "\n"


class Types(Folder):
    def mypy(self, *words, fine=True, path=os.environ["PYTHONPATH"]):
        environment = {**os.environ, "MYPYPATH": path, "PYTHONPATH": path}
        done = subprocess.run([sys.executable, "-m", *words], cwd=self.folder, env=environment, capture_output=True,
                              text=True)
        self.assertEqual(done.returncode == 0, fine, done.stdout + done.stderr)

    def test_stubs_say_what_the_module_has(self):
        allowed = self.folder / "allowed"
        # pybind11's classes have a metaclass, and a constructor that takes anything.
        allowed.write_text(r"modcal\._core\.[A-Z]\w+(\.__init__)?" + "\n", encoding="utf-8")
        words = ("mypy.stubtest", "modcal._core", "--ignore-unused-allowlist", "--allowlist", str(allowed))
        self.mypy(*words)
        package = self.folder / "modcal"
        shutil.copytree(os.environ["PYTHONPATH"] + "/modcal", package)
        with open(package / "_core.pyi", "a", encoding="utf-8") as stub:
            stub.write("def planted() -> None: ...\n")
        self.mypy(*words, fine=False, path=str(self.folder))

    def test_stub_is_what_make_stubs_writes(self):
        done = subprocess.run([sys.executable, ROOT / "python/core/stubs.py"], capture_output=True, text=True, check=True)
        self.assertEqual((ROOT / "python/modcal/_core.pyi").read_text(encoding="utf-8"), done.stdout)

    def test_strict(self):
        self.mypy("mypy", "--strict", os.environ["PYTHONPATH"] + "/modcal")
        user = self.folder / "user.py"
        user.write_text(USER, encoding="utf-8")
        self.mypy("mypy", "--strict", str(user))
        user.write_text(USER.replace("value: float", "value: str"), encoding="utf-8")
        self.mypy("mypy", "--strict", str(user), fine=False)

    def test_strict_examples(self):
        """Programs of the pages, notebooks and examples."""
        texts = {f"{page.lower().replace('/', '_').replace('.', '_')}_{i}": program
                 for page in ("README.md", "docs/python.md") for i, program in enumerate(programs(page))}
        texts.update({book.stem: cells(book) for book in (ROOT / "examples/notebooks").glob("*.ipynb")})
        texts.update({file.stem: file.read_text(encoding="utf-8") for file in (ROOT / "examples").glob("*.py")})
        self.assertGreaterEqual(len(texts), 15)
        files = [str(self.file(text, f"{name}.py")) for name, text in texts.items()]
        settings = self.file(SETTINGS, "mypy.ini")
        self.mypy("mypy", "--strict", "--config-file", str(settings), *files)
        self.file(USER.replace("value: float", "value: str"), "planted.py")
        self.mypy("mypy", "--strict", "--config-file", str(settings), *files, str(self.folder / "planted.py"), fine=False)


if __name__ == "__main__":
    main()
