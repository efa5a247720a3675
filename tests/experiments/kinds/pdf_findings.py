"""What is wrong with a report or a figure on paper, by the boxes of its words.

pdf_findings.py FOLDER <LIST: prints a line for every mistake. LIST has lines "figure.pdf" and
"report.pdf report.html", of paths in FOLDER; the report is one that check_config_pdfs.sh marked.
"""
import collections
import html
import os
import re
import subprocess
import sys

Word = collections.namedtuple("Word", "text left top right bottom")

MARK = re.compile(r"qq(top|end|table|head)([0-9x]+)")
MARGIN = 20  # points of paper that stay white
SHEET_MARGIN = 1  # of a figure
WIDTHS = {"1": 525, "2": 256}  # of charts alone in a row and of two
LETTERS = 0.22  # a box is so much taller, above and below, than its letters


def pages_of(lines):
    """(width, height, words) of every page."""
    pages = []
    for line in lines:
        page = re.search(r'<page width="([\d.]+)" height="([\d.]+)"', line)
        if page:
            pages.append((float(page[1]), float(page[2]), []))
        word = re.search(r'xMin="(.*)" yMin="(.*)" xMax="(.*)" yMax="(.*)">(.*)</word>', line)
        if word:
            pages[-1][2].append(Word(html.unescape(word[5]), *(float(word[i]) for i in range(1, 5))))
    return pages


def overlap(a, b):
    """Of letters; a word written upwards is narrower than its box, one along the line lower."""
    def inner(word):
        high, wide = word.bottom - word.top, word.right - word.left
        if len(word.text) > 1 and high > 1.5 * wide:
            return word.left + LETTERS * wide, word.top, word.right - LETTERS * wide, word.bottom
        return word.left, word.top + LETTERS * high, word.right, word.bottom - LETTERS * high
    one, other = inner(a), inner(b)
    return (min(one[2], other[2]) - max(one[0], other[0]) > 1 and
            min(one[3], other[3]) - max(one[1], other[1]) > 1)


def findings_of_words(place, width, height, words, margin=MARGIN):
    if not words:
        yield f"{place} is blank"
    for word in words:
        if (word.left < margin or word.right > width - margin or word.top < margin
                or word.bottom > height - margin):
            yield f'{place}: "{word.text}" leaves the page'
        if margin < MARGIN and re.fullmatch(r"[0-9.]{9,}", word.text):
            yield f'{place}: "{word.text}": numbers run together'
    words = sorted((word for word in words if not MARK.search(word.text)), key=lambda w: w.top)
    for i, word in enumerate(words):
        for other in words[i + 1:]:
            if other.top > word.bottom:
                break
            if overlap(word, other):
                yield f'{place}: "{word.text}" over "{other.text}"'


def findings_of_marks(pages, charts, tables):
    marks = {}
    for number, (_, _, words) in enumerate(pages):
        for word in words:
            for kind, name in MARK.findall(word.text):
                marks[kind, name] = (number + 1, word)
    tops = [name for kind, name in marks if kind == "top"]
    if len(tops) != charts:
        yield f"{len(tops)} of {charts} charts begin on a page"
    seen_tables = sum(kind == "table" for kind, _ in marks)
    if seen_tables != tables:
        yield f"{seen_tables} of {tables} tables show their last column"
    for (kind, _), (page, mark) in marks.items():
        below = [word for word in pages[page - 1][2] if word.top > mark.bottom and not MARK.search(word.text)]
        if kind == "head" and not below:
            yield f"page {page}: a heading ends the page"
    for name in tops:
        figure, chart, columns, share = name.split("x")
        page, top = marks["top", name]
        if ("end", name) not in marks:
            yield f"page {page}: chart {name} is cut"
            continue
        end_page, end = marks["end", name]
        if end_page != page or end.bottom < top.top:
            yield f"chart {name} stands on pages {page} and {end_page}"
        if abs(end.right - top.left - WIDTHS[share]) > 6:
            yield f"page {page}: chart {name} is {end.right - top.left:.0f} points wide"
        before = marks.get(("top", f"{figure}x{int(chart) - 1}x{columns}x{share}"))
        if columns == "2" and int(chart) % 2 == 1 and before:
            if before[0] != page or abs(before[1].top - top.top) > 40 or before[1].left >= top.left:
                yield f"page {page}: chart {name} is not beside the one before it"


def words_of(pdf):
    return subprocess.run(["pdftotext", "-bbox", pdf, "-"], check=True, capture_output=True).stdout.decode(
        errors="replace").splitlines()


def findings(pdf, report=None):
    pages = pages_of(words_of(pdf))
    margin = MARGIN if report else SHEET_MARGIN
    for number, (width, height, words) in enumerate(pages):
        yield from findings_of_words(f"page {number + 1}", width, height, words, margin)
    if report:
        source = open(report, encoding="utf-8").read()
        charts = len(re.findall(r'<div class="chart[" ]', source))
        yield from findings_of_marks(pages, charts, source.count("<table>"))


def main():
    for line in sys.stdin:
        files = line.split()
        for finding in findings(*files):
            print(f"{os.path.relpath(files[0], sys.argv[1])}: {finding}")


if __name__ == "__main__":
    main()
