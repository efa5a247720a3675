#!/usr/bin/env python3
"""Prints pages to PDF by one headless Chromium: print_pages.py BROWSER PROFILE <PAIRS.

PAIRS: lines "page.html page.pdf". A browser for each page would spend most of its time on its own start.
"""
import base64
import pathlib
import shutil
import sys

from selenium import webdriver
from selenium.webdriver.chrome.service import Service

SECONDS = 100  # of a page or its PDF
DRAWN = "requestAnimationFrame(() => requestAnimationFrame(() => arguments[0]()))"


def start(browser, profile):
    options = webdriver.ChromeOptions()
    options.binary_location = browser
    for switch in ("headless", "no-sandbox", "disable-gpu", "no-first-run", "disable-background-networking",
                   "disable-component-update", "disable-sync", f"user-data-dir={profile}"):
        options.add_argument(f"--{switch}")
    driver = webdriver.Chrome(service=Service(shutil.which("chromedriver"), log_path=f"{profile}.log"), options=options)
    driver.set_page_load_timeout(SECONDS)
    driver.set_script_timeout(SECONDS)
    return driver


def main():
    browser, profile = sys.argv[1:]
    try:
        with start(browser, profile) as driver:
            for line in sys.stdin:
                page, pdf = line.split()
                driver.get(pathlib.Path(page).absolute().as_uri())
                driver.execute_async_script(DRAWN)
                printed = driver.execute_cdp_cmd("Page.printToPDF", {"printBackground": True, "preferCSSPageSize": True})
                pathlib.Path(pdf).write_bytes(base64.b64decode(printed["data"]))
    except Exception:
        log = pathlib.Path(f"{profile}.log")
        print(log.read_text(errors="replace") if log.exists() else "no chromedriver", file=sys.stderr)
        raise


if __name__ == "__main__":
    main()
