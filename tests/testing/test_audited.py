"""The assertion about source code: it passes what is proved, and names place, point and remedy of what is not."""

from pathlib import Path

import pytest

import navsym as nav
from navsym.core.errors import NavsymError
from navsym.testing import AuditFailedError, assert_audited

EXAMPLES = Path(__file__).parents[2] / "examples" / "audit"
SPEC, SOURCE = ((EXAMPLES / f"yaw_jacobian.{ending}").read_text() for ending in ("toml", "c"))
WRONG_LINE = 14


def write(folder, source=SOURCE, spec=SPEC):
    """A folder with a specification and its source."""
    (folder / "yaw_jacobian.c").write_text(source)
    (folder / "spec.toml").write_text(spec)
    return folder / "spec.toml"


def test_a_wrong_entry_fails_with_file_line_counterexample_and_suggestion(tmp_path):
    with pytest.raises(AuditFailedError) as caught:
        assert_audited(write(tmp_path))
    (message,) = str(caught.value).splitlines()
    assert f"yaw_jacobian.c:{WRONG_LINE}: transition[1,3] REFUTED: is " in message
    assert " expected " in message and " at " in message and message.endswith("; write -v * sinf(x[2]) * dt")
    assert caught.value.audit["transition"].status == nav.REFUTED


def test_the_suggestion_makes_it_pass(tmp_path):
    lines = SOURCE.splitlines(keepends=True)
    target = lines[WRONG_LINE - 1].partition("=")[0]
    lines[WRONG_LINE - 1] = f"{target}= -v * sinf(x[2]) * dt;\n"
    assert assert_audited(write(tmp_path, "".join(lines))).holds


def test_what_could_not_be_read_fails_with_its_reason(tmp_path):
    lines = SOURCE.splitlines(keepends=True)
    target = lines[WRONG_LINE - 1].partition("=")[0]
    lines[WRONG_LINE - 1] = f"{target}= mystery(x[2]);\n"
    with pytest.raises(AuditFailedError, match=rf":{WRONG_LINE}: .* OPEN: not read: "):
        assert_audited(write(tmp_path, "".join(lines)))


@pytest.mark.parametrize("spec", [SPEC.partition("[[question]]")[0], "question = []\n" + SPEC.partition("[[q")[0], "x"])
def test_a_specification_without_questions_is_an_error_and_does_not_pass(tmp_path, spec):
    with pytest.raises(NavsymError, match="expected"):
        assert_audited(write(tmp_path, spec=spec))
