#!/usr/bin/env python3
"""What the README and docs/ promise a reader: short sentences, links that lead somewhere, commands that exist.

prose.py ROOT MODCAL checks all of it. Before that every check has to find what is planted for it.
prose.py ROOT --figures prints the lengths of the sentences of every file.
"""
import re
import statistics
import subprocess
import sys
from pathlib import Path

MEDIAN, MOST = 18, 30  # words; of a tenth of the sentences there may be more
README_LINES = 150


def pages(root):
    return [root / "README.md"] + sorted((root / "docs").rglob("*.md"))


def blocks(text):
    """(kind, text, line) of every paragraph: kind "code" or "prose"; tables, headings, pictures left out."""
    text = re.sub(r"<!-- conclusion.*?<!-- end of[^>]*-->", lambda m: "\n" * m[0].count("\n"), text, flags=re.S)
    kind, lines, start, fence = None, [], 0, False
    in_list = False
    for number, line in enumerate(text.split("\n") + [""], 1):
        if line.startswith("```"):
            fence = not fence
            line = ""
        indented = line.startswith("    ") and line.strip() and (not in_list or line.startswith(" " * 7))
        now = "code" if fence or indented else "prose" if line.strip() else None
        if now == "prose" and re.match(r"\s*(\||#|!\[|<!--)", line):
            now = None
        item = now == "prose" and re.match(r"\s*([*-]|\d+\.) ", line)
        if now != kind or item:
            if kind and lines:
                yield kind, "\n".join(lines), start
            kind, lines, start = now, [], number
        if now:
            lines.append(line)
        if item:
            in_list = True
        elif line.startswith("#") and not fence:
            in_list = False
        elif now == "prose" and not line.startswith(" "):
            in_list = in_list and kind == "prose" and len(lines) > 1
    if kind and lines:
        yield kind, "\n".join(lines), start


ABBREVIATION = re.compile(r"\b(e\.g|i\.e|eq|eqs|fig|figs|cf|vs|no|[A-Z])\.$")


def sentences(prose):
    text = re.sub(r"\s+", " ", prose)
    text = re.sub(r"^\s*([*-]|\d+\.) ", "", text)
    text = re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", text)
    text = re.sub(r"`[^`]*`", "code", text)
    begin = 0
    for match in re.finditer(r"[.!?:][\"')*]* (?=[A-Z0-9\"'(*`Α-Ωα-ωζωκλ]|code)|[.!?:]?[\"')*]*\s*$", text):
        part = text[begin:match.end()].strip()
        before = text[begin:match.start() + 1]
        if match.end() < len(text) and (ABBREVIATION.search(before) or before.endswith(":")):
            continue
        if part:
            yield part
        begin = match.end()


def words(sentence):
    return sum(1 for word in sentence.split() if re.search(r"\w", word))


def lengths(text):
    return [words(s) for kind, block, _ in blocks(text) if kind == "prose" for s in sentences(block)]


def figures(counts):
    ordered = sorted(counts)
    return statistics.median(ordered), ordered[min(len(ordered) - 1, int(0.9 * len(ordered)))]


def long_sentences(name, text):
    counts = lengths(text)
    if len(counts) < 5:
        return
    median, tenth = figures(counts)
    if median > MEDIAN:
        yield f"{name}: the median sentence has {median:g} words, {MEDIAN} are allowed"
    if tenth > MOST:
        yield f"{name}: a tenth of the sentences has {tenth} words and more, {MOST} are allowed"


def leads_nowhere(folder, path):
    return path and not re.match(r"[a-z]+:", path) and not (folder / path).exists()


def dead_links(name, text, root):
    for target in re.findall(r"\]\(([^)\s]+)\)", re.sub(r"`[^`]*`", "", text)):
        if leads_nowhere((root / name).parent, target.split("#")[0]):
            yield f"{name}: {target} leads nowhere"


class Program:
    """The commands of modcal and their options, as its help has them."""

    def __init__(self, path):
        self.path, self.known = path, {}
        for command in re.findall(r"^  ([a-z]+) {2,}\S", self.run("help").split("Subcommands:")[1].split("\n\n")[0], re.M):
            self.known[command] = set(re.findall(r"(?<![\w-])(--?[a-z][a-z-]*)", self.run("help", command)))

    def run(self, *arguments):
        return subprocess.run([self.path, *arguments], capture_output=True, text=True, check=True).stdout


def command_lines(text):
    """Of code: what follows "modcal" up to the end of the command; of prose: the same in backquotes."""
    for kind, block, line in blocks(text):
        if kind == "code":
            for row in block.split("\n"):
                match = re.match(r"\s*(?:\$ )?modcal((?: \S+)*)", row)
                if match:
                    yield re.split(r" [#|>&]| {2}", match[1])[0]
        else:
            yield from re.findall(r"`modcal( [^`]*)`", block.replace("\n", " "))
    for row in re.findall(r"^\|.*", text, re.M):
        yield from re.findall(r"`modcal( [^`]*)`", row)


def wrong_commands(name, text, root, program):
    for line in command_lines(text):
        arguments = line.split()
        if not arguments or not re.match(r"[a-z]+$", arguments[0]):
            continue
        command = arguments[0]
        if command not in program.known:
            yield f"{name}: there is no command \"modcal {command}\""
            continue
        for word in arguments[1:]:
            option = word.strip("[]…").split("=")[0]
            if re.match(r"--?[a-z]", option) and option not in program.known[command]:
                yield f"{name}: modcal {command} has no option {option}"
            if re.match(r"(configs|examples|docs|benchmarks)/\S+\.\w+$", word) and not (root / word).exists():
                yield f"{name}: modcal {command} {word}: there is no such file"


def unknown_targets(name, text, root):
    """`make X` in code and the scripts that are called."""
    targets = set(re.findall(r"^([a-z][\w-]*):", (root / "Makefile").read_text(), re.M))
    for kind, block, _ in blocks(text):
        for target in re.findall(r"^\s*(?:\$ )?make ([a-z][\w-]*)", block, re.M) if kind == "code" else ():
            if target not in targets:
                yield f"{name}: there is no make {target}"


def too_long(name, text):
    if name == "README.md" and text.count("\n") > README_LINES:
        yield f"{name}: more than {README_LINES} lines"


def offenders(name, text, root, program):
    yield from long_sentences(name, text)
    yield from dead_links(name, text, root)
    yield from wrong_commands(name, text, root, program)
    yield from unknown_targets(name, text, root)
    yield from too_long(name, text)


def self_check(root, program):
    long = " ".join(["word"] * 40)
    planted = {
        "the median sentence": "".join(f"{long.capitalize()}. " for _ in range(9)),
        "a tenth of the sentences": "Short one. " * 8 + f"{long.capitalize()}. " * 2,
        "leads nowhere": "[there](nowhere.md)",
        "there is no command": "    modcal rnu a.yaml",
        "has no option": "It is `modcal run a.yaml --otu b` that does it.",
        "there is no such file": "    $ modcal run configs/nowhere.yaml",
        "there is no make": "    make nothing",
        "more than": "line\n" * (README_LINES + 1),
    }
    for expected, text in planted.items():
        if not any(expected in found for found in offenders("README.md", text, root, program)):
            yield f"self-check: \"{expected}\" goes unnoticed"
    right = "Words of a sentence. See `modcal run FILE --out DIR`.\n\n    modcal new simulate\n    make test\n"
    yield from (f"self-check: {found}" for found in offenders("README.md", right, root, program))


def main(root, program):
    if program == "--figures":
        for page in pages(root):
            counts = lengths(page.read_text())
            print(f"{page.relative_to(root)}: {len(counts)} sentences", *(figures(counts) if counts else ()))
        return 0
    program = Program(program)
    found = list(self_check(root, program))
    for page in pages(root):
        found += offenders(str(page.relative_to(root)), page.read_text(), root, program)
    print("\n".join(found) or "nothing found")
    return bool(found)


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]), sys.argv[2]))
