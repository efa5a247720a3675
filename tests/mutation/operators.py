"""Small wrong changes to a C++ text: each operator finds the places where it applies.

A site is (start, end, replacement): text[start:end] gives way to the replacement. Sources are those
of clang-format, which puts blanks around binary operators and none around unary ones.
"""
import re

TOKENS = re.compile(r'//[^\n]*|/\*.*?\*/|R"\((?:.|\n)*?\)"|"(?:\\.|[^"\\\n])*"'
                    r"|(?<![\w'])'(?:\\.|[^'\\\n])'|^[ \t]*#(?:[^\n]*\\\n)*[^\n]*", re.S | re.M)
# What says, states or refuses is no arithmetic: messages, options, output, and what a release leaves out.
STATEMENTS = re.compile(r"\b(MODCAL_REQUIRE|static_assert|assert|visitor|fmt::format\w*|throw_invalid_input|template <)")


def closing(text, start):
    """Index behind the parenthesis that closes the one at `start`."""
    depth = 0
    for i in range(start, len(text)):
        depth += text[i] in "(<[{" if text[start] != "(" else text[i] == "("
        depth -= text[i] in ")>]}" if text[start] != "(" else text[i] == ")"
        if depth == 0:
            return i + 1
    return len(text)


def masked(text):
    """The text with comments, strings, preprocessor lines and statements of no arithmetic blanked."""
    def blank(part):
        return re.sub(r"[^\n]", " ", part)

    code = TOKENS.sub(lambda m: blank(m.group(0)), text)
    for match in list(STATEMENTS.finditer(code)):
        if match.group(1) == "template <":
            end = closing(code, match.end() - 1)
        else:
            start = code.find("(", match.end())
            end = closing(code, start) if code[match.end():start].strip() == "" else match.end()
        code = code[:match.start()] + blank(code[match.start():end]) + code[end:]
    return code


def exchanged(pairs):
    """An operator that puts one token in the place of another, both ways."""
    table = dict(pairs) | {b: a for a, b in pairs}
    token = re.compile("|".join(re.escape(t) for t in sorted(table, key=len, reverse=True)))

    def sites(code):
        return [(m.start(), m.end(), table[m.group(0)]) for m in token.finditer(code)]
    return sites


def doubled(code):
    number = re.compile(r"(?<![\w.])(?:\d+\.\d*(?:e[+-]?\d+)?|\d+e[+-]?\d+)(?![\w.])")
    return [(m.start(), m.end(), f"(2.0 * {m.group(0)})") for m in number.finditer(code)
            if float(m.group(0)) != 0.0]


def dropped(code):
    """Terms + f(x) and - f(x) that no product goes on with."""
    found = []
    for m in re.finditer(r" [+-] (?=[A-Za-z_][\w:.>-]*\()", code):
        end = closing(code, code.find("(", m.end()))
        if re.match(r"\s*(?:[;,)\]]|[+-] )", code[end:]):
            found.append((m.start(), end, ""))
    return found


def unrooted(code):
    return [(m.start(), m.end(), "(") for m in re.finditer(r"\bstd::(?:sqrt|cbrt)\(", code)]


def shifted(code):
    """Subscripts one off. No lambda's captures, no sizes of arrays that are declared."""
    found = []
    for m in re.finditer(r"(?<=[\w)\]])\[([a-z]\w*|\d+)\](?!\s*(?:=\s*)?\{)", code):
        line = code[code.rfind("\n", 0, m.start()) + 1:m.start()]
        if re.match(r"\s*(?:static |constexpr |const |inline )*[\w:<>]+ \w+(?:\[\w+\])*$", line) \
                and "return" not in line:
            continue
        index = m.group(1)
        for way in ("+", "-") if index != "0" else ("+",):
            found.append((m.start(1), m.end(1), f"{index} {way} 1"))
    return found


OPERATORS = {
    "sign": exchanged([(" + ", " - "), (" += ", " -= ")]),
    "product": exchanged([(" * ", " / "), (" *= ", " /= ")]),
    "comparison": exchanged([(" < ", " <= "), (" > ", " >= ")]),
    "constant": doubled,
    "term": dropped,
    "root": unrooted,
    "index": shifted,
    "extreme": exchanged([("std::min(", "std::max("), ("std::min_element(", "std::max_element(")]),
    "logic": exchanged([(" && ", " || ")]),
}


class Mutant:
    """One change to one file of the tree."""

    def __init__(self, path, operator, text, site):
        self.path, self.operator = path, operator
        start, end, replacement = site
        self.changed = text[:start] + replacement + text[end:]
        self.line = text.count("\n", 0, start) + 1
        first = text.rfind("\n", 0, start) + 1
        self.old = text[first:(text + "\n").find("\n", end)].strip()
        last = (self.changed + "\n").find("\n", start + len(replacement))
        self.new = self.changed[first:last].strip()

    def key(self):
        """Says which change it is, whatever lines stand before it."""
        return f"{self.path}: {' '.join(self.new.split())}"

    def report(self):
        return f"{self.path}:{self.line} ({self.operator})\n  - {self.old}\n  + {self.new}"


def mutants_of(path, text):
    code = masked(text)
    return [Mutant(path, name, text, site) for name, sites in OPERATORS.items() for site in sites(code)]
