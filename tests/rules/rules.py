#!/usr/bin/env python3
"""The rules of docs/architecture.md, each a function that yields the offenders it finds.

rules.py ROOT checks the tree at ROOT: an offender that known.txt does not list is an error, and so
is a listed one that is gone: the list may only shrink. Before that every rule has to find what is
planted for it into a copy of the tree. rules.py ROOT --list prints the offenders of today.
"""
import re
import sys
from collections import defaultdict
from functools import cache
from pathlib import Path

LIBRARIES = ("libsim", "libinverse", "libcalib")
PROGRAM = LIBRARIES + ("experiments", "python")
FOLDERS = PROGRAM + ("tests", "benchmarks", "examples")
INCLUDE = re.compile(r'^\s*#\s*include\s*["<]([^">]+)[">]', re.M)


class Tree:
    """Sources below a root, read once: {path: text}, and the same text without comments."""

    def __init__(self, root=None):
        self.text, self.code, self.includes = {}, {}, {}
        for folder in FOLDERS if root else ():
            for path in sorted((Path(root) / folder).rglob("*")):
                if path.suffix in (".cpp", ".hpp"):
                    self.put(str(path.relative_to(root)), path.read_text(errors="replace"))

    def put(self, path, text):
        self.text[path] = text
        self.code[path] = without_comments(text)
        self.includes[path] = INCLUDE.findall(text)

    def with_planted(self, texts):
        """A copy in which each (path, text) is appended to its file."""
        copy = Tree()
        copy.text, copy.code, copy.includes = dict(self.text), dict(self.code), dict(self.includes)
        for path, text in texts:
            copy.put(path, copy.text.get(path, "") + text)
        return copy

    def of(self, folders, suffixes=(".cpp", ".hpp")):
        return [p for p in self.text if p.split("/")[0] in folders and p.endswith(suffixes)]


def without_comments(text):
    """Comments blanked, line numbers kept."""
    token = re.compile(r'//[^\n]*|/\*.*?\*/|R"\((?:.|\n)*?\)"|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])\'', re.S)

    def blank(match):
        found = match.group(0)
        return found if found[0] in "\"'R" else "\n" * found.count("\n")

    return token.sub(blank, text)


def without_strings(code):
    return re.sub(r'R"\((?:.|\n)*?\)"|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])\'',
                  lambda m: '""' + "\n" * m.group(0).count("\n"), code)


# Rule 1: no circle in the graph of folders at any level. Files in sub-folders belong to their
# folder; headers that stand directly in a folder are its floor, sources its roof.


def node_of(path, folder):
    """The node of folder's graph that a path belongs to; None outside."""
    if not path.startswith(folder):
        return None
    rest = path[len(folder):]
    if "/" in rest:
        return rest.split("/")[0]
    return "its headers" if rest.endswith(".hpp") else "its sources"


def circles(tree):
    files = set(tree.of(PROGRAM))
    folders = {""} | {"/".join(p.split("/")[:i]) + "/" for p in files for i in range(1, p.count("/") + 1)}
    for folder in sorted(folders):
        edges = defaultdict(set)
        for path in files:
            a = node_of(path, folder)
            for name in tree.includes[path]:
                b = node_of(name, folder) if name in files else None
                if a and b and a != b:
                    edges[a].add(b)
        reached = {a: reachable(edges, a) for a in list(edges)}
        for a in sorted(edges):
            for b in sorted(edges[a]):
                if a in reached.get(b, ()):
                    yield f"{folder or 'the tree'}: {a} -> {b}"


def reachable(edges, start):
    seen, open_ends = set(), [start]
    while open_ends:
        for b in edges.get(open_ends.pop(), ()):
            if b not in seen:
                seen.add(b)
                open_ends.append(b)
    return seen


# What the parts of the libraries may include of the tree: first match counts.
DIRECTIONS = [
    (r"libsim/(base|signal|model)/", r"libsim/(base|signal|model)/"),
    (r"libsim/(records/|io\.hpp)", r"libsim/(base|signal|model|records)/"),
    (r"libsim/", r"libsim/(?!records/)"),
    (r"libinverse/modes/", r"libsim/(base|signal|model)/|libinverse/modes/"),
    (r"libinverse/(spectral|joint|waves)/", r"libsim/(base|signal|model)/|libinverse/(?!observer/|modes/)"),
    (r"libinverse/", r"(libsim|libinverse)/"),
    (r"libcalib/", r"(libsim|libinverse|libcalib)/"),
    (r"experiments/", r"(libsim|libinverse|libcalib|experiments)/"),
    (r"python/", r"(libsim|libinverse|libcalib|experiments|python)/"),
]
# Packages and the one place that includes them.
DOORS = [
    (r"fftw3", r"libsim/signal/fft\.cpp"),
    (r"(ceres/|nlopt|gsl/)", r"libcalib/"),
    (r"(yaml-cpp/|CLI/)", r"experiments/"),
    (r"nlohmann/", r"experiments/|python/|libsim/records/"),
    (r"(sndfile|csv\.h$|matio|hdf5|zip\.h$)", r"libsim/records/"),
    (r"(udunits2|converter\.h$)", r"libsim/base/"),
    (r"(sqlite3|xxhash)", r"experiments/runs/"),
]


def directions(tree):
    for path in tree.text:
        program = path.split("/")[0] in PROGRAM
        for name in tree.includes[path]:
            if program and name.split("/")[0] in FOLDERS:
                allowed = next(to for of, to in DIRECTIONS if re.match(of, path))
                if not re.match(allowed, name):
                    yield f"{path}: {name} points against the direction of the libraries"
            for package, place in DOORS:
                everywhere = package == "fftw3"
                if (program or everywhere) and re.match(package, name) and not re.match(place, path):
                    yield f"{path}: {name} belongs to {place}"


# Rule 2: sizes.


def folder_sizes(tree):
    count = defaultdict(int)
    for path in tree.of(PROGRAM):
        count[path.rsplit("/", 1)[0]] += 1
    for folder, files in sorted(count.items()):
        if files > 30:
            yield f"{folder}: more than 30 source files"


def file_sizes(tree):
    for path in tree.of(PROGRAM):
        if tree.text[path].count("\n") > 300:
            yield f"{path}: more than 300 lines"


def example_sizes(tree):
    for path in tree.of(("examples",)):
        if tree.text[path].count("\n") > 30:
            yield f"{path}: an example of more than 30 lines"


# Up to its brace, a function's header ends in its parameters and what may follow them.
HEADER = re.compile(r"\)\s*(const|noexcept|override|final|mutable|HWY_\w+|\s)*(->[^;{}]*)?(:[^:;][^;]*)?$", re.S)
NO_FUNCTION = re.compile(r"^\s*(if|for|while|switch|catch|else|do|namespace|class|struct|enum|union|return)\b")


@cache
def functions(code):
    """(name, first line, last line) of every function."""
    found = []
    code = re.sub(r"(?m)^\s*#.*?(?<!\\)$", "", without_strings(code))
    depth, begin, header_at, line, header_line = 0, None, 0, 1, 1
    for match in re.finditer(r"[\n{};]", code):
        i, c = match.start(), match.group()
        if c == "\n":
            line += 1
            if not code[header_at:i].strip():
                header_at, header_line = i + 1, line
        elif c == "{":
            header = code[header_at:i]
            if begin is None and "(" in header and HEADER.search(header) and not NO_FUNCTION.match(header):
                name = re.search(r"([\w:~]+|operator\S+)\s*\(", header)
                begin = (depth, header_line, name.group(1) if name else "?")
            depth += 1
            header_at, header_line = i + 1, line
        elif c == "}":
            depth -= 1
            if begin is not None and depth == begin[0]:
                found.append((begin[2], begin[1], line))
                begin = None
            header_at, header_line = i + 1, line
        elif c == ";":
            header_at, header_line = i + 1, line
    return found


def function_sizes(tree):
    for path in tree.of(PROGRAM):
        for name, first, last in functions(tree.code[path]):
            if last - first + 1 > 60:
                yield f"{path}: {name} has more than 60 lines"


# Rule 3: a header that stands at a library's root is public.


def public_headers(tree):
    standard = re.compile(r"[a-z_0-9]+$")
    for path in tree.of(LIBRARIES, (".hpp",)):
        if path.count("/") > 1:
            continue
        for name in tree.includes[path]:
            ours = name.split("/")[0] in LIBRARIES and name.count("/") == 1
            if not (ours or standard.match(name) or name.startswith("Eigen/")):
                yield f"{path}: {name} is no public header"


# Rule 5: an option that is visited is read.
BOUND = re.compile(r",\s*([A-Za-z_][\w.>-]*)\s*\)\s*;")


def unread_options(tree):
    bound, rest = {}, []
    for path in tree.of(PROGRAM):
        code = tree.code[path].split("\n")
        for name, first, last in functions(tree.code[path]):
            if name.split("::")[-1] != "visit":
                continue
            body = "\n".join(code[first - 1:last])
            for member in BOUND.findall(body):
                member = re.split(r"\.|->", member)[-1]
                if not re.search(rf"[\w>][ &*]+{member}\s*[=({{;]", body):  # a local variable
                    bound.setdefault(member, path)
            code[first - 1:last] = [""] * (last - first + 1)
        rest += code
    read = set()
    names = re.compile(r"\b(" + "|".join(bound) + r")\b")
    for line in rest:
        for member in set(names.findall(line)) - read:
            if not re.match(rf"\s*(?!return\b|delete\b)[\w:<>, ]+[ >&*]{member}\s*(=[^=].*|\{{.*\}})?;", line):
                read.add(member)
    for member in sorted(set(bound) - read):
        yield f"{bound[member]}: option {member} is visited and read by nobody"


# Rule 6: tuned constants. A constant that nobody tunes says in its comment what it is fixed by.
CONSTANT = re.compile(
    r"\bconstexpr\s+(?:double|float|int|std::size_t|std::int64_t)\s+(k\w+)\s*=\s*([-+.\deE' ]+?)\s*;")


def is_fixed(lines, first, last):
    """Whether the comment above a constant or behind it says in three words or more what fixes it."""
    above = first
    while above > 0 and lines[above - 1].lstrip().startswith("//"):
        above -= 1
    over = " ".join(line.strip().lstrip("/").strip() for line in lines[above:first])
    behind = lines[last].partition("//")[2]
    return any(len(comment.partition("Fixed by:")[2].split()) >= 3 for comment in (over, behind))


def tuned_constants(tree):
    for path in tree.of(LIBRARIES):
        if path.endswith("/tuning.hpp"):
            blocks = tree.text[path].split("\n\n")
            for block in blocks:
                for name, _ in CONSTANT.findall(without_comments(block)):
                    for word in ("Source:", "Range tried:", "Doubled:", "Halved:"):
                        if word not in block:
                            yield f"{path}: {name} does not say \"{word}\""
            continue
        code, lines = tree.code[path], tree.text[path].split("\n")
        for match in CONSTANT.finditer(code):
            first, last = (code.count("\n", 0, place) for place in match.span())
            if not is_fixed(lines, first, last):
                yield f"{path}: constant {match.group(1)} stands outside tuning.hpp"


# Rule 7: names are compared by registries and parsers alone.
PARSERS = re.compile(r"experiments/(config|cli)/|libsim/records/|(.*/)?registry\.cpp$")


def compared_names(tree):
    compared = re.compile(r'[=!]=\s*("[^"\n]*[A-Za-z][^"\n]*")|("[^"\n]*[A-Za-z][^"\n]*")\s*[=!]=')
    for path in tree.of(PROGRAM):
        if PARSERS.match(path):
            continue
        for literal in sorted({a or b for a, b in compared.findall(tree.code[path])}):
            yield f"{path}: a name is compared with {literal}"


RULES = (circles, directions, folder_sizes, file_sizes, example_sizes, function_sizes, public_headers,
         unread_options, tuned_constants, compared_names)

LONG_FUNCTION = "int planted() {\n" + "  call();\n" * 60 + "}\n"
# An offender for every rule, several for those that hold several: file, what is appended to it.
PLANTED = {
    circles: [("libcalib/problem/budget.hpp", '#include "libcalib/objectives/planted.hpp"\n'),
              ("libcalib/objectives/planted.hpp", '#include "libcalib/problem/budget.hpp"\n')],
    directions: [
        ("libsim/base/error.hpp", '#include "libsim/dynamics/planted.hpp"\n'),
        ("libsim/model/transfer.cpp", '#include "libinverse/planted.hpp"\n'),
        ("libsim/dynamics/planted.hpp", '#include "libcalib/planted.hpp"\n'),
        ("libinverse/joint/planted.cpp", '#include "libsim/dynamics/planted.hpp"\n'),
        ("libinverse/joint/planted.cpp", '#include "libinverse/observer/planted.hpp"\n'),
        ("libcalib/planted.cpp", '#include "experiments/planted.hpp"\n'),
        ("experiments/planted.cpp", '#include "tests/planted.hpp"\n'),
        ("experiments/planted.cpp", "#include <fftw3.h>\n"),
        ("tests/planted.cpp", "#include <fftw3.h>\n"),
        ("libinverse/planted.cpp", "#include <gsl/gsl_multimin.h>\n"),
        ("experiments/planted.cpp", "#include <nlopt.hpp>\n"),
        ("libsim/model/planted.cpp", "#include <ceres/ceres.h>\n"),
        ("libcalib/planted.cpp", "#include <yaml-cpp/yaml.h>\n"),
        ("libcalib/planted.cpp", "#include <CLI/CLI.hpp>\n"),
        ("libsim/signal/planted.hpp", "#include <sndfile.hh>\n"),
        ("libinverse/planted.hpp", "#include <nlohmann/json.hpp>\n"),
        ("libsim/model/planted.hpp", "#include <csv.h>\n"),
    ],
    folder_sizes: [(f"libsim/planted/file_{i}.cpp", "\n") for i in range(31)],
    file_sizes: [("libsim/base/planted.cpp", "\n" * 301)],
    example_sizes: [("examples/planted.cpp", "\n" * 31), ("examples/simulate_stroke.cpp", "\n" * 30)],
    function_sizes: [("libsim/base/planted.cpp", LONG_FUNCTION),
                     ("libsim/base/planted.hpp", "struct S {\n  " + LONG_FUNCTION + "};\n")],
    public_headers: [("libsim/planted.hpp", "#include <fmt/format.h>\n"),
                     ("libcalib/planted.hpp", '#include "libcalib/problem/budget.hpp"\n')],
    unread_options: [("libsim/base/planted.cpp",
                      "struct Options {\n  double planted_option = 1.0;\n  void visit(OptionVisitor& visitor);\n};\n"
                      'void Options::visit(OptionVisitor& visitor) {\n  visitor.number({.key = "a"},\n'
                      "                 planted_option);\n}\n")],
    tuned_constants: [("libcalib/problem/planted.cpp", "constexpr double kPlanted = 0.3;\n"),
                      ("libcalib/problem/planted.cpp", "// Fixed by: it.\nconstexpr double kPlanted = 0.3;\n"),
                      ("libcalib/problem/planted.cpp", "constexpr int kPlanted = 3;  // Fixed by: a whim.\n"),
                      ("libcalib/problem/planted.cpp",
                       "// Fixed by: lanes of a vector.\n\nconstexpr int kPlanted = 3;\n"),
                      ("libcalib/problem/planted.cpp",
                       "// Fixed by: lanes of a vector.\nconstexpr int kFixed = 3;\nconstexpr int kPlanted = 3;\n"),
                      ("libcalib/problem/tuning.hpp", "\n\n// Source: none.\nconstexpr double kPlanted = 0.3;\n")],
    compared_names: [("libcalib/problem/planted.cpp", 'bool planted = name == "planted";\n')],
}


def self_check(tree):
    """What is planted for a rule and not noticed by it."""
    for rule in RULES:
        before = set(rule(tree))
        together = rule in (circles, folder_sizes)
        for planting in [PLANTED[rule]] if together else [[one] for one in PLANTED[rule]]:
            if not set(rule(tree.with_planted(planting))) - before:
                yield f"self-check: {rule.__name__} misses {planting[0]}"


def main():
    root = sys.argv[1]
    tree = Tree(root)
    if not tree.text:
        sys.exit(f"no sources below {root}")
    found = {f"{rule.__name__} {offender}" for rule in RULES for offender in rule(tree)}
    if "--list" in sys.argv:
        print("\n".join(sorted(found)))
        return 0
    known_file = Path(__file__).with_name("known.txt")
    known = {line for line in known_file.read_text().split("\n") if line and line[0] != "#"}
    errors = list(self_check(tree))
    errors += [f"{one}" for one in sorted(found - known)]
    errors += [f"{one}: gone, take it out of {known_file.name}" for one in sorted(known - found)]
    print("\n".join(errors) if errors else f"{len(RULES)} rules, {len(known)} known offenders, none new")
    return 1 if errors else 0


if __name__ == "__main__":
    sys.exit(main())
