"""Writes a picture of a page: shoot.py PAGE FRAGMENT OUT [WIDTHxHEIGHT]. The picture of the README was made with it."""

import pathlib
import sys

from driver import Browser, Failure


def main():
    page, fragment, out = pathlib.Path(sys.argv[1]).resolve(), sys.argv[2], pathlib.Path(sys.argv[3])
    width, height = (int(part) for part in (sys.argv[4] if len(sys.argv) > 4 else "1280x760").split("x"))
    with Browser() as browser:
        browser.size(width, height)
        browser.open(page, fragment)
        out.write_bytes(browser.screenshot())


if __name__ == "__main__":
    try:
        main()
    except Failure as failure:
        sys.exit(f"error: {failure}")
