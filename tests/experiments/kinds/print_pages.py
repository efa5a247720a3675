#!/usr/bin/env python3
"""Prints pages to PDF by one headless Chromium: print_pages.py BROWSER PROFILE <PAIRS.

PAIRS: lines "page.html page.pdf". A browser for each page would spend most of its time on its own start.
"""
import base64
import json
import os
import pathlib
import subprocess
import sys

SWITCHES = ["--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking",
            "--disable-component-update", "--disable-sync", "--remote-debugging-pipe"]
VIRTUAL_SECONDS = 100  # of the page's own clock: what it draws later is missing


class Browser:
    """Chromium's protocol of its developer tools: JSON that ends with a zero byte, in on 3, out on 4."""

    def __init__(self, program, profile):
        to_read, self.write = os.pipe()
        self.read, to_write = os.pipe()
        command = f"exec 3<&{to_read} 4>&{to_write}; exec \"$@\""
        self.process = subprocess.Popen(
            ["bash", "-c", command, "bash", program, *SWITCHES, f"--user-data-dir={profile}"],
            pass_fds=(to_read, to_write), stderr=subprocess.DEVNULL)
        os.close(to_read)
        os.close(to_write)
        self.number = 0
        self.waiting = b""

    def messages(self):
        while True:
            while b"\0" in self.waiting:
                message, self.waiting = self.waiting.split(b"\0", 1)
                yield json.loads(message)
            more = os.read(self.read, 1 << 20)
            if not more:
                raise RuntimeError("the browser has ended")
            self.waiting += more

    def call(self, method, session=None, until=None, **parameters):
        """The result, once the event `until` has come, too."""
        self.number += 1
        message = {"id": self.number, "method": method, "params": parameters}
        if session:
            message["sessionId"] = session
        os.write(self.write, json.dumps(message).encode() + b"\0")
        result, seen = None, until is None
        for answer in self.messages():
            if answer.get("id") == self.number:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']}")
                result = answer["result"]
            seen = seen or answer.get("method") == until
            if result is not None and seen:
                return result

    def print(self, page, pdf):
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        self.call("Page.enable", session)
        self.call("Page.navigate", session, until="Page.loadEventFired", url=pathlib.Path(page).absolute().as_uri())
        self.call("Emulation.setVirtualTimePolicy", session, until="Emulation.virtualTimeBudgetExpired",
                  policy="pauseIfNetworkFetchesPending", budget=1000 * VIRTUAL_SECONDS)
        printed = self.call("Page.printToPDF", session, printBackground=True, preferCSSPageSize=True)
        pathlib.Path(pdf).write_bytes(base64.b64decode(printed["data"]))
        self.call("Target.closeTarget", targetId=target)


def main():
    browser = Browser(*sys.argv[1:])
    for line in sys.stdin:
        browser.print(*line.split())
    browser.call("Browser.close")
    browser.process.wait()


if __name__ == "__main__":
    main()
