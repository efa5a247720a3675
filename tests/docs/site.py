#!/usr/bin/env python3
"""The site that `make docs` builds: every link leads somewhere, nothing is loaded from the network.

site.py ROOT OUT builds it into OUT. Exit code 77: a program that it needs is missing.
"""
import re
import subprocess
import sys
from functools import cache
from pathlib import Path
from urllib.parse import unquote

from prose import leads_nowhere

LINK = re.compile(r'<[^>]*\s(?:href|src)="([^"]*)"')
LOADED = re.compile(r'<(?:script|link|img|iframe)\b[^>]*\s(?:href|src)="((?:https?:)?//[^"]*)"')
ALL = "included in the \"nav\" configuration"  # what mkdocs says of pages that no link of it leads to


@cache
def anchors(page):
    return set(re.findall(r'\b(?:id|name)="([^"]*)"', page.read_text(errors="replace")))


def faults(page, text):
    for target in sorted(set(LINK.findall(text))):
        path, _, anchor = unquote(target).partition("#")
        led_to = page.parent / path if path else page
        if leads_nowhere(page.parent, path):
            yield f"{page}: {target} leads nowhere"
        elif anchor and led_to.suffix == ".html" and anchor not in anchors(led_to):
            yield f"{page}: {target}: the page has no such place"
    yield from (f"{page}: {target} is loaded from the network" for target in LOADED.findall(text))


def self_check(site):
    planted = {
        "leads nowhere": '<a href="nowhere.html">',
        "no such place": '<a class="x" href="index.html#nowhere">',
        "loaded from the network": '<script src="https://example.org/a.js">',
    }
    for expected, text in planted.items():
        if not any(expected in found for found in faults(site / "index.html", text)):
            yield f"self-check: \"{expected}\" goes unnoticed"
    right = '<a href="index.html"><a href="https://example.org"><script src="js/theme.js">'
    yield from (f"self-check: {found}" for found in faults(site / "index.html", right))


def main(root, out):
    built = subprocess.run([root / "cmake/site/build.sh", out], capture_output=True, text=True)
    if built.returncode:
        print(built.stdout + built.stderr)
        return built.returncode
    found = [built.stderr] if ALL in built.stderr else []
    site = out / "html"
    found += self_check(site)
    # What Doxygen writes is its own affair, that pages lead there is ours; 404.html is for servers.
    pages = sorted(page for page in [*site.glob("*.html"), *site.glob("[!a]*/**/*.html")] if page.name != "404.html")
    for page in pages:
        found += faults(page, page.read_text(errors="replace"))
    print("\n".join(map(str, found)) or f"{len(pages)} pages, nothing found")
    return bool(found)


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]), Path(sys.argv[2])))
