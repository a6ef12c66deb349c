"""A headless Chromium for tests of pages: what it shows, how wide the page is, and what it asked for."""

import json
import re
import shutil
import subprocess

import pytest

PROBE = """<script>addEventListener('load', () => { document.title = JSON.stringify({
  needed: document.documentElement.scrollWidth, there: window.innerWidth,
  asked: performance.getEntriesByType('resource').length,
  ground: getComputedStyle(document.body).backgroundColor, ink: getComputedStyle(document.body).color,
  paper: getComputedStyle(document.querySelector('article')).backgroundColor,
  orders: [...document.querySelectorAll('input.order')].map(choice => { choice.checked = true;
    return [...document.querySelectorAll('table.ordered tbody tr')].sort((a, b) =>
      a.getBoundingClientRect().top - b.getBoundingClientRect().top).map(row => row.cells[0].textContent); }),
}); });</script></body>"""


def browser(*options):
    """Run Chromium without a window; skip where there is none."""
    program = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
    if program is None:
        pytest.skip("no Chromium here: the page is NOT TESTED in a browser")
    words = [program, "--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", *options]
    return subprocess.run(words, capture_output=True, timeout=100, check=False)


def probed(page, folder, width, *options):
    """What a browser of this width measures on a copy of the page, and what it wrote to its console."""
    copy = folder / f"probe-{width}.html"
    copy.write_text(page.read_text(encoding="utf-8").replace("</body>", PROBE), encoding="utf-8")
    done = browser(f"--window-size={width},900", "--virtual-time-budget=3000", "--enable-logging=stderr",
                   "--dump-dom", *options, copy.as_uri())  # fmt: skip
    found = json.loads(re.search(r"<title>(\{.*?\})</title>", done.stdout.decode()).group(1))
    found["console"] = [line for line in done.stderr.decode(errors="replace").splitlines() if "CONSOLE" in line]
    return found
