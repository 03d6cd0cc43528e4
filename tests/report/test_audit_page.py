"""The page of an audit: lines coloured by verdict, formulas beside them, words of the source as words."""

from __future__ import annotations

import re

import pytest

import navsym as nav
from navsym.cli.main import run
from navsym.core.errors import NavsymError
from navsym.report.audit_page import audit_page
from tests.report.hostile import HOSTILE

SOURCE = """\
float rate(float a, float b, float out[2])
{
    out[0] = a * b;
    out[1] = a - b;
    log_it(b);
    return a;
}
"""
SPEC = """\
[[code]]
name = "m"
file = "code.c"
function = "rate"
[[question]]
name = "sum"
kind = "equal"
left = ["m:out[0]", "m:out[1]"]
right = ["a*b", "a + b"]
"""


def write(folder, source=SOURCE, spec=SPEC):
    """The audit of a source in a folder of its own."""
    (folder / "code.c").write_text(source, encoding="utf-8")
    (folder / "spec.toml").write_text(spec)
    return nav.audit(folder / "spec.toml")


def rows(page):
    """Line number -> class and text of the row."""
    found = re.findall(r'<tr id="f1-(\d+)" class="(\w*)">(.*?)</tr>', page, re.DOTALL)
    return {int(number): (kind, text) for number, kind, text in found}


def test_each_line_has_the_colour_of_its_worst_verdict_and_says_why(tmp_path):
    found = rows(audit_page(write(tmp_path)))
    assert {n: kind for n, (kind, _) in found.items() if kind} == {3: "proved", 4: "refuted", 5: "open"}
    assert "sum 1,1" in found[3][1] and "<math" in found[3][1]
    assert "expected" in found[4][1] and "write a + b" in found[4][1]
    assert "log_it" in found[5][1] and "does not define" in found[5][1]


def test_the_mended_source_has_no_red_line(tmp_path):
    kinds = {kind for kind, _ in rows(audit_page(write(tmp_path, SOURCE.replace("a - b", "a + b")))).values()}
    assert "proved" in kinds and "refuted" not in kinds


def test_without_questions_the_formulas_stand_beside_their_lines(tmp_path):
    write(tmp_path)
    found = rows(audit_page(nav.audit(tmp_path / "code.c", function="rate")))
    assert found[4][0] == "formula" and "out[1] = a - b" in found[4][1]


@pytest.mark.parametrize("words", HOSTILE)
def test_words_of_a_source_reach_the_page_as_words(tmp_path, words):
    plain = words.replace("\x00", "").replace("*/", "")
    page = audit_page(write(tmp_path, SOURCE.replace("a * b;", f"a * b; /* {plain} */")))
    harmless = audit_page(write(tmp_path))
    tags = [re.findall(r"<(/?[a-z]+|!)", text) for text in (page, harmless)]
    assert tags[0] == tags[1]
    assert "7 * 7" not in page or "{{ 7 * 7 }}" in page


def test_lines_far_from_all_that_is_said_are_left_out_and_counted_as_the_reader_counts(tmp_path):
    page = audit_page(write(tmp_path, "/* \u2028 \x0c */\n" * 40 + SOURCE + "// end\n" * 40))
    found = rows(page)
    assert found[44][0] == "refuted" and "a - b" in found[44][1]
    assert 1 not in found and 80 not in found and page.count("…</th>") == 1


def test_the_command_writes_the_page_and_keeps_its_status(tmp_path, capsys):
    write(tmp_path)
    assert run(["audit", str(tmp_path / "spec.toml"), "--html", str(tmp_path / "page.html")]) == 1
    assert 'class="refuted"' in (tmp_path / "page.html").read_text(encoding="utf-8")


def test_a_source_that_is_gone_is_said(tmp_path):
    answer = write(tmp_path)
    (tmp_path / "code.c").unlink()
    with pytest.raises(NavsymError, match=r"code\.c"):
        audit_page(answer)
