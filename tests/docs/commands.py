#!/usr/bin/env python3
"""Runs the commands of README and docs/ and holds what they print against what the pages show.

commands.py ROOT MODCAL [PAGE]. Every page has a folder of its own, with copies of examples/ and configs/, in which its blocks
of code run in their order. A block is one of commands if it begins with a prompt ("$ ", further lines "> ") or a program. What
stands behind a command with a prompt is what it prints to standard output, or to standard error where that stays empty:

* words are equal, so are whole numbers; other numbers agree to two units of the last digit shown;
* "…" in a line is any text, "…" in a line of its own any lines.

A block without prompts shows no output: its commands end with exit code 0. Comments in the lines before a block:

    <!-- not run: REASON -->       it takes long, or needs a cluster
    <!-- numbers vary: REASON -->  only its words are compared
    <!-- file: NAME -->            no commands: what the file NAME holds
    <!-- first: COMMAND -->        what the reader has done before
"""
import re
import shutil
import subprocess
import sys
import tempfile
import textwrap
from pathlib import Path

from prose import blocks, pages

MOST_SECONDS = 120  # a block that takes longer is marked
NUMBER = r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?"
MARKS = {"not run", "numbers vary", "file", "first"}
PROGRAM = re.compile(r"(\$ |(build/release/)?modcal |make |mpirun |benchmarks/)")


class Block:
    def __init__(self, text, line, comments):
        self.line, self.marks = line, dict(comments)
        self.text = textwrap.dedent(text) + "\n"
        self.is_file = "file" in self.marks
        self.has_commands = bool(PROGRAM.match(self.text)) and not self.is_file

    def commands(self):
        """(command, what is shown of its output; None: nothing)."""
        before = [(self.marks["first"], None)] if "first" in self.marks else []
        if not self.has_commands:
            return before
        if not self.text.startswith("$ "):
            return before + [(line, None) for line in self.text.splitlines()]
        parts = re.split(r"^\$ (.*(?:\n> .*)*)\n", self.text, flags=re.M)[1:]
        return before + list(zip((command.replace("\n> ", "\n") for command in parts[::2]), parts[1::2]))


def blocks_of(text):
    lines = text.split("\n")
    for kind, block, start in blocks(text):
        if kind != "code":
            continue
        comments, above = [], start - 2
        while above >= 0 and (not lines[above].strip() or lines[above].strip().startswith(("<!--", "```"))):
            comments += re.findall(r"<!-- ([a-z ]+): (.*?) -->", lines[above])
            above -= 1
        yield Block(block, start, reversed(comments))


def pattern(shown):
    """What the shown lines stand for, a group for every number."""
    text = ""
    for line in shown.rstrip().split("\n"):
        if line.strip() == "…":
            text += r"(?:.*\n)*?"
            continue
        parts = re.split(rf"({NUMBER}|…|\s+)", line.rstrip())
        text += "".join(f"({NUMBER})" if re.fullmatch(NUMBER, part) else ".*?" if part == "…" else
                        r"\s+" if part and not part.strip() else re.escape(part) for part in parts) + r"[ \t]*\n"
    return text


def differs(shown, printed):
    digits = re.match(r"[^.e]*\.?(\d*)(?:e(.*))?", shown)
    if "." not in shown and "e" not in shown:
        return shown != printed
    unit = 10.0 ** (int(digits[2] or 0) - len(digits[1]))
    return abs(float(shown) - float(printed)) > 2.001 * unit


def first_difference(shown, printed):
    """The line up to which the shown ones can be found in the printed ones."""
    lines = shown.rstrip().split("\n")
    for count in range(1, len(lines) + 1):
        if not re.match(pattern("\n".join(lines[:count])), printed):
            return f"this is not what is printed:\n      {lines[count - 1]}"
    return "there is more of it than is shown (\"…\" stands for lines left out)"


def comparison(shown, printed, numbers):
    match = re.fullmatch(pattern(shown), printed.rstrip() + "\n" if printed.strip() else "")
    if not match:
        yield first_difference(shown, printed)
    elif numbers:
        expected = [n for line in shown.split("\n") for n in re.findall(NUMBER, line)]
        yield from (f"{a} is shown, {b} is printed" for a, b in zip(expected, match.groups()) if differs(a, b))


class Folder:
    """Where the commands of one page run."""

    def __init__(self, root, program, path):
        self.path = path
        for name in ("examples", "configs"):
            shutil.copytree(root / name, path / name)
        (path / "build/release").mkdir(parents=True)
        (path / "build/release/modcal").symlink_to(program)

    def run(self, command):
        # /usr/bin: the python3 that has the packages of packages.txt
        return subprocess.run(["bash", "-c", f'PATH="$PWD/build/release:/usr/bin:$PATH"; {command}'], cwd=self.path, text=True,
                              capture_output=True, stdin=subprocess.DEVNULL, timeout=MOST_SECONDS)

    def faults(self, block):
        yield from (f"there is no mark \"{mark}\"" for mark in set(block.marks) - MARKS)
        if block.is_file:
            (self.path / block.marks["file"]).write_text(block.text)
        for command, shown in block.commands():
            try:
                done = self.run(command)
            except subprocess.TimeoutExpired:
                yield f"{command}: takes more than {MOST_SECONDS} s"
                continue
            printed = done.stdout or done.stderr
            found = list(comparison(shown, printed, "numbers vary" not in block.marks)) if shown is not None else \
                [f"exit code {done.returncode}"] if done.returncode else []
            yield from (f"{command}: {fault}" for fault in found)
            if found:
                yield "it prints:\n" + textwrap.indent(printed, "      ")


def self_check(folder):
    planted = {
        "there is no mark": "<!-- not ran: planted -->\n\n    some text",
        "false: exit code 1": "<!-- first: false -->\n\n    $ true",
        "exit code 3": "    modcal run nowhere.yaml",
        "this is not what is printed": "    $ echo right\n    wrong",
        "there is more of it": "    $ printf 'a\\nb\\n'\n    a",
        "0.5 is shown, 0.53 is printed": "<!-- first: echo 0.53 >x -->\n\n    $ cat x\n    0.50",
        "7 is shown, 8 is printed": "    $ echo 8 tasks\n    7 tasks",
    }
    for expected, text in planted.items():
        found = [fault for block in blocks_of(text) for fault in folder.faults(block)]
        if not any(expected in fault.replace("0.50", "0.5") for fault in found):
            yield f"self-check: \"{expected}\" goes unnoticed: {found}"
    right = ("<!-- numbers vary: planted -->\n\n    $ printf 'a 1.0 s\\nb\\nc\\nd  2e-3 of 7\\n'\n    a 1.5 s\n    …\n    d 1e-3 …\n\n"
             "<!-- file: x.txt -->\n\n    some text\n\nA word.\n\n    $ cat x.txt\n    some text\n\nA word.\n\n"
             "    $ echo 'R1 0.1234 f_12'\n    R1 0.123… f_12\n")
    yield from (f"self-check: {fault}" for block in blocks_of(right) for fault in folder.faults(block))


def main(root, program, only=None):
    found, ran, marked = [], 0, []
    with tempfile.TemporaryDirectory() as scratch:
        (Path(scratch) / "check").mkdir()
        found += self_check(Folder(root, program, Path(scratch) / "check"))
        for page in pages(root):
            name = str(page.relative_to(root))
            if only and name != only:
                continue
            folder = Folder(root, program, Path(tempfile.mkdtemp(dir=scratch)))
            for block in blocks_of(page.read_text()):
                if "not run" in block.marks:
                    marked.append(f"{name}:{block.line}: not run: {block.marks['not run']}")
                    continue
                ran += block.has_commands
                found += (f"{name}:{block.line}: {fault}" for fault in folder.faults(block))
    print("\n".join(found + marked))
    print(f"{ran} blocks of commands run, {len(marked)} marked as not run, {len(found)} faults")
    return bool(found)


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]), Path(sys.argv[2]).resolve(), *sys.argv[3:]))
