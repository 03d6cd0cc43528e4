"""The screenshots of the documentation: ``python docs/screens.py`` writes docs/pictures/*.png.

Every page is made here by the verb that makes it for a user, opened in the Chromium of the tests, and must leave its
console silent. A notebook is run and opened in JupyterLab. Chromium and the optional packages of
``python3 bootstrap.py extras`` have to be there.
"""

from __future__ import annotations

import base64
import io
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from PIL import Image

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from tests.report.devtools import Browser  # noqa: E402

#: Name of the picture: the page in the folder of pages, and what is scrolled to the top of the window.
SCREENS = {
    "report": ("site/index.html", "h1"),
    "claim": ("site/guaranteed_velocity.html", "[id='c-4.3.u2']"),
    "erratum": ("site/guaranteed_velocity.erratum.html", "h1"),
    "trust": ("site/trust.html", "h1"),
    "audit": ("yaw_jacobian.html", "h1"),
}
NOTEBOOK = "00_tour"
PORT = "8899"  # of JupyterLab, on this machine only


def make_pages(folder: Path) -> None:
    """The report of one paper, the page of an audit, and a notebook with its results."""
    results = ["--execute", "--to", "ipynb", "--output", str(folder / f"{NOTEBOOK}.ipynb")]
    for command, allowed in [
        (["navsym", "report", "guaranteed_velocity", "--out", str(folder / "site")], (0, 1)),
        (["navsym", "audit", "examples/audit/yaw_jacobian.toml", "--html", str(folder / "yaw_jacobian.html")], (1,)),
        (["jupytext", *results, f"notebooks/{NOTEBOOK}.py"], (0,)),
    ]:
        done = subprocess.run([sys.executable, "-m", *command], cwd=ROOT, capture_output=True, text=True)
        if done.returncode not in allowed:
            raise SystemExit(f"{' '.join(command)}: status {done.returncode}\n{done.stderr[-2000:]}")


@contextmanager
def jupyter_lab(folder: Path) -> Iterator[str]:
    """JupyterLab on a folder, with no settings of the user; gives its address."""
    own = {f"JUPYTER_{what}_DIR": str(folder / what.lower()) for what in ("CONFIG", "DATA", "RUNTIME")}
    options = ["--no-browser", "--allow-root", f"--port={PORT}", "--IdentityProvider.token="]
    command = [sys.executable, "-m", "jupyter", "lab", *options, f"--ServerApp.root_dir={folder}"]
    quiet = subprocess.DEVNULL
    server = subprocess.Popen(["env", *(f"{k}={v}" for k, v in own.items()), *command], stdout=quiet, stderr=quiet)
    try:
        yield f"http://127.0.0.1:{PORT}"
    finally:
        server.terminate()
        server.wait(timeout=20)


def wait_for(condition: Callable[[], object], what: str, seconds: float = 90) -> None:
    """Until the condition holds; an error when it never does."""
    end = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > end:
            raise SystemExit(f"{what}: not after {seconds:g} s")
        time.sleep(0.5)


def photograph(browser: Browser, picture: str) -> None:
    """The window as a small file."""
    data = base64.b64decode(browser.call("Page.captureScreenshot", format="png")["data"])
    target = ROOT / "docs" / "pictures" / f"{picture}.png"
    Image.open(io.BytesIO(data)).convert("RGB").quantize(96).save(target, optimize=True)
    print(target.relative_to(ROOT))


def show_page(browser: Browser, page: Path, place: str) -> None:
    """One window of a page; whatever its console has to complain about is an error."""
    browser.trouble.clear()
    browser.open(page.as_uri())
    if not browser.value(f"!!document.querySelector({place!r})"):
        raise SystemExit(f"{page.name}: nothing at {place}")
    browser.value(f"(document.querySelector({place!r}).scrollIntoView(), 0)")
    if browser.trouble:
        raise SystemExit(f"{page.name}: {browser.trouble}")


def show_notebook(browser: Browser, address: str) -> None:
    """The notebook in JupyterLab, its formulas set; only the server itself may be asked for anything."""

    def is_there() -> object:
        browser.open(f"{address}/doc/tree/{NOTEBOOK}.ipynb")
        return browser.value("document.title.length")

    wait_for(is_there, "JupyterLab")
    wait_for(lambda: browser.value("document.querySelectorAll('mjx-container').length > 3"), "formulas")
    wait_for(lambda: browser.value("document.querySelectorAll('.Toastify__toast button').length"), "news")
    buttons = "[...document.querySelectorAll('.Toastify__toast button')]"
    browser.value(f"({buttons}.filter(b => b.innerText === 'No').map(b => b.click()), 0)")
    wait_for(lambda: not browser.value("document.querySelectorAll('.Toastify__toast').length"), "no news")
    browser.value("(document.querySelectorAll('.jp-CodeCell')[1].scrollIntoView(), 0)")
    outside = [words for words in browser.trouble if not words.startswith(f"request: {address}")]
    if outside:
        raise SystemExit(f"{NOTEBOOK}: {outside}")


def main() -> None:
    """Write all screenshots."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        make_pages(folder)
        browser = Browser(folder / "profile")
        try:
            browser.call(
                "Emulation.setDeviceMetricsOverride", width=1100, height=760, deviceScaleFactor=1, mobile=False
            )
            for picture, (page, place) in SCREENS.items():
                show_page(browser, folder / page, place)
                photograph(browser, picture)
            with jupyter_lab(folder) as address:
                browser.trouble.clear()
                show_notebook(browser, address)
                photograph(browser, "notebook")
        finally:
            browser.close()


if __name__ == "__main__":
    main()
