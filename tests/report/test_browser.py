"""The pages in a real browser: quiet console, visible formulas, a filter that filters, harmless words."""

from __future__ import annotations

import itertools
import json
from pathlib import Path

import pytest

import navsym as nav
from navsym.report.audit_page import audit_page
from navsym.report.page import visible
from navsym.report.wording import read_wording
from navsym.verification.ledger import Ledger
from tests.report import devtools
from tests.report.hostile import site

pytestmark = pytest.mark.browser


@pytest.fixture(scope="module")
def browser(tmp_path_factory):
    if devtools.found() is None:
        pytest.skip("no Chromium on this machine: install the package chromium to run the browser tests")
    browser = devtools.Browser(tmp_path_factory.mktemp("profile"))
    yield browser
    browser.close()


@pytest.fixture
def shown(browser, tmp_path):
    """A function that writes files, opens one of them, and forgets earlier trouble."""

    def show(files, name):
        for file, text in files.items():
            (tmp_path / file).parent.mkdir(exist_ok=True)
            (tmp_path / file).write_text(text, encoding="utf-8", errors="replace")
        browser.trouble.clear()
        browser.open((tmp_path / name).as_uri())
        return browser

    return show


@pytest.mark.parametrize("name", ["index.html", "sample.html", "sample.erratum.html"])
def test_the_console_stays_quiet_and_nothing_is_requested_from_outside(shown, files, name):
    page = shown(files, name)
    assert page.value("document.querySelector('h1').innerText.length") > 3
    assert not page.trouble


def test_formulas_take_room_on_the_page(shown, files):
    page = shown(files, "sample.html")
    sizes = page.value(
        "[...document.querySelectorAll('.sides math')].map(m => m.getBoundingClientRect())"
        ".map(r => [r.width, r.height])"
    )
    assert len(sizes) >= 10 and all(width > 5 and height > 5 for width, height in sizes)


VISIBLE = "[...document.querySelectorAll('article.claim')].filter(c => c.offsetHeight > 0).map(c => c.dataset.status)"


def test_the_filter_hides_verdicts_and_finds_words(shown, files):
    page = shown(files, "sample.html")
    assert len(page.value(VISIBLE)) == 8
    page.value("document.querySelector('[value=PROVED]').click()")
    assert sorted(page.value(VISIBLE)) == ["CERTIFIED", "CONFIRMED", "OPEN", "REFUTED", "REFUTED"]
    page.value(
        "(() => { const box = document.querySelector('[name=words]'); box.value = 'sign is lost';"
        "box.dispatchEvent(new Event('input', {bubbles: true})); return 0 })()"
    )
    assert page.value(VISIBLE) == ["REFUTED"]
    assert page.value("document.querySelector('.shown').innerText") == "1 of 8 claims"
    assert not page.trouble


def test_hostile_words_do_nothing(shown, hostile_files, hostile_words):
    page = shown(hostile_files, "sample.html")
    titles = page.value("[...document.querySelectorAll('article .title')].map(t => t.textContent)")
    assert set(titles) >= {visible(words) for words in hostile_words}
    assert page.value("document.querySelectorAll('script').length") == 1
    assert not page.trouble


def test_a_narrow_screen_does_not_scroll_sideways(shown, files, browser):
    browser.call("Emulation.setDeviceMetricsOverride", width=360, height=740, deviceScaleFactor=2, mobile=True)
    for name in ("index.html", "sample.html", "sample.erratum.html"):
        page = shown(files, name)
        assert page.value("document.documentElement.scrollWidth") <= 360, name
    browser.call("Emulation.clearDeviceMetricsOverride")


CONTRAST = """
(() => {
  const parts = (c) => c.match(/[\\d.]+/g).map(Number);
  const light = (c) => { const [r, g, b] = parts(c).map(v => v / 255)
      .map(v => v <= 0.03928 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4);
    return 0.2126 * r + 0.7152 * g + 0.0722 * b; };
  const ground = (e) => { for (; e; e = e.parentElement) {
      const c = getComputedStyle(e).backgroundColor; const p = parts(c);
      if (p.length < 4 || p[3] > 0) return c; } return 'rgb(255, 255, 255)'; };
  return [...document.querySelectorAll('p, a, li, dt, dd, h1, h2, h3, h4, summary, span, td, th, label, figcaption')]
    .filter(e => e.offsetHeight > 0 && e.textContent.trim()).map(e => {
      const [a, b] = [light(getComputedStyle(e).color), light(ground(e))].sort((x, y) => y - x);
      return [(a + 0.05) / (b + 0.05), e.tagName + '.' + e.className]; })
    .filter(([ratio]) => ratio < 4.5);
})()
"""


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_text_stands_out_from_its_ground(shown, files, browser, scheme):
    browser.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": scheme}])
    for name in ("index.html", "sample.html", "sample.erratum.html"):
        assert shown(files, name).value(CONTRAST) == []
    browser.call("Emulation.setEmulatedMedia", features=[])


def test_headings_labels_and_landmarks_are_there_for_those_who_listen(shown, files):
    for name in ("index.html", "sample.html", "sample.erratum.html"):
        page = shown(files, name)
        levels = page.value("[...document.querySelectorAll('h1,h2,h3,h4')].map(h => Number(h.tagName[1]))")
        assert levels[0] == 1 and levels.count(1) == 1
        assert all(b - a <= 1 for a, b in itertools.pairwise(levels)), levels
        tree = page.call("Accessibility.getFullAXTree")["nodes"]
        roles = [node.get("role", {}).get("value") for node in tree if not node.get("ignored")]
        assert {"main", "navigation", "heading", "link"} <= set(roles)
        nameless = [
            node["role"]["value"]
            for node in tree
            if not node.get("ignored")
            and node.get("role", {}).get("value") in ("link", "button", "checkbox", "searchbox", "img", "form")
            and not node.get("name", {}).get("value")
        ]
        assert nameless == []


def test_everything_can_be_reached_with_the_keyboard(shown, files):
    page = shown(files, "sample.html")
    wanted = page.value("document.querySelectorAll('a[href], summary, input').length")
    seen = set()
    for _ in range(wanted + 20):
        for kind in ("keyDown", "keyUp"):
            page.call("Input.dispatchKeyEvent", type=kind, key="Tab", code="Tab", windowsVirtualKeyCode=9)
        seen.add(page.value("[...document.querySelectorAll('*')].indexOf(document.activeElement)"))
    assert len(seen) >= wanted


LEDGER = Path(__file__).parents[2] / "derivations" / "verdicts.json"


@pytest.fixture(scope="module")
def real(tmp_path_factory):
    """Pages of the paper with the widest formulas, and of the one with the longest words, from the ledger."""
    chosen = ("joint_correction", "trajectory")
    cut = Ledger.from_json(json.loads(LEDGER.read_text(encoding="utf-8"))).restrict(chosen)
    words = {}
    for name in chosen:
        sheet = LEDGER.parent / "errata" / f"{name}.toml"
        words[name] = read_wording(sheet.read_text(encoding="utf-8"), sheet.name)
    folder = tmp_path_factory.mktemp("real")
    for name, text in site(cut, words).items():
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text(text, encoding="utf-8")
    return folder


@pytest.mark.long
@pytest.mark.parametrize("width", [360, 768, 1280])
def test_the_pages_of_real_papers_fit_phone_tablet_and_desk(real, browser, width):
    browser.call("Emulation.setDeviceMetricsOverride", width=width, height=800, deviceScaleFactor=1, mobile=width < 500)
    browser.trouble.clear()
    for page in sorted(real.glob("*.html")):
        browser.open(page.as_uri())
        assert browser.value("document.documentElement.scrollWidth") <= width, page.name
    browser.call("Emulation.clearDeviceMetricsOverride")
    assert not browser.trouble


def test_what_is_wider_than_the_page_can_be_reached_and_scrolled_with_the_keyboard(real, browser):
    browser.call("Emulation.setDeviceMetricsOverride", width=360, height=800, deviceScaleFactor=1, mobile=True)
    browser.open((real / "joint_correction.html").as_uri())
    wide = "[...document.querySelectorAll('.formula')].filter(b => b.scrollWidth > b.clientWidth)"
    assert browser.value(f"{wide}.length") > 20
    assert browser.value(f"{wide}.every(b => b.tabIndex === 0)")
    assert browser.value("[...document.querySelectorAll('.formula')].some(b => b.tabIndex === -1)")
    browser.call("Emulation.clearDeviceMetricsOverride")


def test_on_paper_wide_formulas_are_set_smaller_and_controls_are_left_out(real, browser):
    browser.open((real / "joint_correction.html").as_uri())
    widths = "[...document.querySelectorAll('.formula math')].map(m => m.getBoundingClientRect().width)"
    before = browser.value(f"Math.max(...{widths})")
    browser.value("window.dispatchEvent(new Event('beforeprint'))")
    assert browser.value(f"Math.max(...{widths})") < before
    browser.value("window.dispatchEvent(new Event('afterprint'))")
    assert browser.value(f"Math.max(...{widths})") == before
    browser.call("Emulation.setEmulatedMedia", media="print")
    assert browser.value("[...document.querySelectorAll('.sides details')].every(d => d.offsetHeight > 0)")
    assert browser.value("getComputedStyle(document.querySelector('.filters')).display") == "none"
    browser.call("Emulation.setEmulatedMedia", media="")


def test_the_sheet_of_a_real_paper_shows_place_wrong_and_right_formulas(real, browser):
    browser.open((real / "trajectory.erratum.html").as_uri())
    entries = browser.value("document.querySelectorAll('.erratum > li').length")
    assert entries >= 20
    assert browser.value("document.querySelectorAll('.change .wrong').length") == entries
    assert browser.value("document.querySelectorAll('.change .right math').length") >= 15
    assert browser.value("document.querySelectorAll('table.figures tbody tr').length") == 16


def test_a_browser_that_dies_is_an_error_and_not_a_wait(tmp_path):
    if devtools.found() is None:
        pytest.skip("no Chromium on this machine: install the package chromium to run the browser tests")
    lost = devtools.Browser(tmp_path / "profile")
    lost.process.kill()
    lost.process.wait(timeout=20)
    with pytest.raises(OSError, match=r"gone|Broken pipe"):
        for _ in range(100):
            lost.value("1 + 1")
    lost.close()


@pytest.mark.long
def test_the_page_of_an_audit_is_quiet_and_coloured_by_verdict(shown):
    page = shown({"audit.html": audit_page(nav.audit("examples/audit/yaw_jacobian.toml"))}, "audit.html")
    assert not page.trouble
    ground = "getComputedStyle(document.querySelector('{}')).backgroundColor"
    red, green, plain = (page.value(ground.format(f"tr{kind} > th")) for kind in (".refuted", ".proved", ":not([id])"))
    assert len({red, green, plain}) == 3
    sizes = page.value("[...document.querySelectorAll('tr.refuted math')].map(m => m.getBoundingClientRect().width)")
    assert len(sizes) == 2 and all(width > 5 for width in sizes)
