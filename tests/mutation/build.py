"""What a build directory holds: libraries to put mutants before, and tests to run on them."""
import json
import os
import re
import subprocess


class Build:
    """What ninja knows of a build directory: how objects are compiled, what tests link."""

    def __init__(self, root, folder):
        self.root, self.folder = root, folder
        self.compile, self.link, self.members, self.source = {}, {}, {}, {}
        self.tests = {}  # as ctest names them: the program and the file in it
        database = subprocess.run(["ninja", "-t", "compdb"], cwd=folder, capture_output=True,
                                  text=True, check=True).stdout
        for edge in json.loads(database):
            output, command = edge["output"], edge["command"]
            inputs = [word for word in command.split() if word.endswith((".o", ".a"))]
            if output.endswith(".o") and edge["file"].endswith(".cpp"):
                self.compile[output] = command
                self.source[output] = os.path.relpath(os.path.join(folder, edge["file"]), root)
            elif output.endswith(".a"):
                self.members[output] = {word for word in inputs if word.endswith(".o")}
            elif re.fullmatch(r"tests/(?!experiments_cli_)\w+_tests", output):  # those run modcal
                if (folder / output).exists():
                    self.link[output] = (command, inputs)
        for program, (_, inputs) in self.link.items():
            for source in (self.source[o] for o in inputs if o in self.source):
                file = source.removeprefix("tests/")
                if file.endswith("_test.cpp"):
                    self.tests[file.removesuffix(".cpp").replace("/", "_")] = (program, file)
        self.includers = self.objects_by_header()
        self.seconds = self.measured_seconds()

    def objects_by_header(self):
        found, output = {}, None
        text = subprocess.run(["ninja", "-t", "deps"], cwd=self.folder, capture_output=True,
                              text=True).stdout
        for line in text.splitlines():
            if line.startswith(" "):
                name = os.path.relpath(os.path.join(self.folder, line.strip()), self.root)
                found.setdefault(name, set()).add(output)
            else:
                output = line.split(":")[0]
        return found

    def measured_seconds(self):
        """Of every test, as ctest saw it last."""
        cost = self.folder / "Testing/Temporary/CTestCostData.txt"
        rows = [line.split() for line in cost.read_text().splitlines()] if cost.exists() else []
        return {row[0]: float(row[2]) for row in rows if len(row) == 3}

    def objects_of(self, path):
        """Members of the static libraries that hold the file."""
        everything = set().union(*self.members.values())
        holds = {o for o, source in self.source.items() if source == path}
        return sorted((holds | self.includers.get(path, set())) & everything)

    def tests_of(self, path):
        """Those that link it: of its own name first, then by what of its folder they share."""
        archives = {a for a, members in self.members.items() if members & set(self.objects_of(path))}
        folder, stem = path.rsplit("/", 1)
        stem = re.sub(r"(-inl)?\.\w+$", "", stem)

        def distance(test):
            file = self.tests[test][1]
            here = file.rsplit("/", 1)[0]
            shared = len(os.path.commonpath([here, folder]).split("/")) if here.split("/")[0] == \
                folder.split("/")[0] else 0
            return (not file.endswith(f"/{stem}_test.cpp"), here != folder, -shared,
                    self.seconds.get(test, 1.0))

        return sorted((t for t, (program, _) in self.tests.items() if archives & set(self.link[program][1])),
                      key=distance)
