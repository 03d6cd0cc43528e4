"""``nav.report``, ``nav.claims`` and ``nav.cite``: pages from verdicts that are there, and what is refused."""

from __future__ import annotations

import html.parser
import json
from pathlib import Path

import pytest

import navsym as nav
from navsym.cli.main import run

PAPER, LEDGER = "alpha_beta_filter", Path(__file__).parents[2] / "derivations" / "verdicts.json"


class Links(html.parser.HTMLParser):
    """Places that a page points to."""

    def __init__(self, page: Path):
        super().__init__()
        self.found: set[str] = set()
        self.feed(page.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attrs):
        self.found |= {value for name, value in attrs if name in ("href", "src") and value}


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    return nav.report(PAPER, out=tmp_path_factory.mktemp("site") / "new" / "pages", source=LEDGER)


def test_the_pages_show_the_verdicts_of_the_ledger_they_were_made_from(site):
    stored = [r for r in json.loads(LEDGER.read_text(encoding="utf-8"))["claims"] if r["id"].startswith(f"{PAPER}:")]
    counts = {status: sum(r["status"] == status for r in stored) for status in {r["status"] for r in stored}}
    assert {status: n for status, n in site.ledger.counts.items() if n} == counts
    page = (site.out / f"{PAPER}.html").read_text(encoding="utf-8")
    assert page.count("<article") == len(stored)


def test_every_file_is_there_and_every_link_between_pages_leads_to_one(site):
    assert set(site.files) == {str(p.relative_to(site.out)) for p in site.out.rglob("*") if p.is_file()}
    for name in (name for name in site.files if name.endswith(".html")):
        links = (link for link in Links(site.out / name).found if not link.startswith(("http", "data:")))
        local = {link.partition("#")[0] for link in links}
        assert {part for part in local if part and not (site.out / name).parent.joinpath(part).exists()} == set()


def test_the_answer_is_the_document_of_the_verb(site, tmp_path, capsys):
    assert run(["report", PAPER, "--from", str(LEDGER), "--out", str(tmp_path), "--json"]) in (0, 1)
    printed = json.loads(capsys.readouterr().out)
    assert {**site.document(), "out": str(tmp_path)} == printed
    assert repr(site) == f"<report: {len(site.files)} files; open {site.out / 'index.html'}>"


def test_a_ledger_in_memory_gives_the_pages_of_the_one_in_the_file(site, tmp_path):
    again = nav.report(PAPER, out=tmp_path, source=site.ledger)
    assert again.files == site.files
    name = f"{PAPER}.html"
    assert (tmp_path / name).read_bytes() == (site.out / name).read_bytes()


@pytest.mark.parametrize(
    ("papers", "options", "kind"),
    [
        (("no_such_paper",), {"source": LEDGER}, "domain"),
        ((PAPER,), {"source": "nothing.json"}, "missing-file"),
        ((PAPER,), {"source": Path(__file__)}, "syntax"),
    ],
)
def test_what_is_no_paper_and_no_document_is_refused_with_kind_and_place(tmp_path, papers, options, kind):
    with pytest.raises(nav.NavsymError) as caught:
        nav.report(*papers, out=tmp_path / "pages", **options)
    assert caught.value.kind == kind and caught.value.remedy
    assert not (tmp_path / "pages" / "index.html").exists()


def test_a_folder_that_cannot_be_made_is_an_error_before_anything_is_decided(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(nav.NavsymError) as caught:
        nav.report(PAPER, out=tmp_path / "file" / "pages", source=None, progress=lambda *_: pytest.fail("decided"))
    assert caught.value.kind == "output"
