"""A workspace: what its list names is what every verb knows, and nothing is written anywhere else."""

from __future__ import annotations

import json
import os
import stat
from pathlib import Path

import pytest

import navsym as nav
from navsym.claims.workspace import find_workspace
from navsym.cli.main import run

CLAIMS = """\
[symbols]
x = "positive"
[[claim]]
id = "square"
left = "(x + 1)**2"
right = "x**2 + 2*x + 1"
[[claim]]
id = "sum"
left = "(x + 1)**2"
right = "x**2 + 1"
expect = "REFUTED"
reason = "the double product is missing"
[[claim]]
id = "sum*"
corrects = "sum"
left = "(x + 1)**2"
relation = ">"
right = "x**2 + 1"
[[claim]]
id = "cancelled"
left = "x/x"
right = "1"
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A workspace with blanks and letters of another alphabet in its name, verified once from a folder below."""
    root = tmp_path_factory.mktemp("home") / "my work Ähre"
    workspace = nav.init(root)
    assert workspace.root == root
    (root / "claims" / "baro.toml").write_text(CLAIMS, encoding="utf-8")
    (root / "claims" / "Höhe über Grund.toml").write_text(
        '[symbols]\na = "real"\n[[claim]]\nid = "square"\nleft = "a*a"\nright = "a**2"\n', encoding="utf-8"
    )
    return root


@pytest.fixture(scope="module")
def verified(folder):
    """The document of ``verify`` on all that is listed."""
    here = Path.cwd()
    os.chdir(folder / "claims")
    try:
        ledger = nav.verify()
        ledger.write()
        return ledger
    finally:
        os.chdir(here)


@pytest.fixture
def inside(folder, verified, monkeypatch):
    monkeypatch.chdir(folder / "models")
    return folder


def document(capsys, *words):
    status = run([*words, "--json"])
    return status, json.loads(capsys.readouterr().out)


def test_the_list_of_a_new_workspace_is_the_promised_one(folder):
    lines = (folder / "navsym.toml").read_text().splitlines()
    assert [line.split("#")[0].rstrip() for line in lines] == [
        "[workspace]",
        'claims = ["claims/*.toml"]',
        'models = ["models/*.toml"]',
        'audits = ["audits/*.toml"]',
        'papers = ["papers/*.py"]',
    ]
    assert {path.name for path in folder.iterdir()} >= {"claims", "models", "audits", "papers", "navsym.toml"}


def test_verify_decides_all_that_is_listed_from_any_folder_below(verified):
    assert verified.unexpected == () and verified.missing == ()
    assert {record.id: str(record.status) for record in verified} == {
        "claims/Höhe über Grund.toml:square": "PROVED",
        "claims/baro.toml:square": "PROVED",
        "claims/baro.toml:sum": "REFUTED",
        "claims/baro.toml:sum*": "PROVED",
        "claims/baro.toml:cancelled": "PROVED",
        "models/alignment.toml:drift": "CERTIFIED",
        "audits/ekf.toml:transition": "PROVED",
        "pendulum:2": "PROVED",
    }
    assert verified["models/alignment.toml:drift"].evidence.startswith("guaranteed standard deviation 5.82842712")
    assert "reads no model" in verified["models/alignment.toml:drift"].evidence


def test_a_verdict_is_the_one_of_prove_with_the_conditions_of_the_text(inside, verified, tmp_path):
    file = tmp_path / "zero.toml"
    file.write_text('[symbols]\na = "real"\n[[claim]]\nid = "one"\nleft = "a/a"\nright = "1"\n')
    (record,) = nav.show(f"{file}:one")
    (verdict,) = nav.prove(file)
    assert record.assumptions == verdict.assumptions == ("a != 0",) and record.scope == verdict.scope


def test_ledger_and_cache_stand_in_the_workspace_and_git_ignores_the_cache(inside):
    assert (inside / "ledger.json").is_file() and (inside / "certificates.json").is_file()
    assert (inside / ".navsym" / ".gitignore").read_text() == "*\n" and (inside / ".navsym/results.sqlite").is_file()
    assert not (inside / "README.md").exists() and not (inside / "models" / "ledger.json").exists()
    assert nav.Ledger.from_json(json.loads((inside / "ledger.json").read_text())).unexpected == ()


def test_check_replays_each_kept_certificate_and_names_the_damaged_one(inside, verified, tmp_path):
    kept = json.loads((inside / "certificates.json").read_text())
    checks = nav.check(inside / "certificates.json")
    assert checks.accepted and {row.path[:12] for row in checks} == {key[:12] for key in kept}
    damaged = next(key for key, entry in kept.items() if entry["certificate"]["kind"] == "proof")
    kept[damaged]["certificate"]["statement"]["right"] += " + 1"
    (tmp_path / "certificates.json").write_text(json.dumps(kept))
    assert [row.path for row in nav.check(tmp_path) if row.status == "REJECTED"] == [damaged[:12]]


def test_the_audit_of_a_new_workspace_has_a_certificate_and_a_fault_in_its_code_is_found(tmp_path, monkeypatch):
    nav.init(tmp_path / "new")
    monkeypatch.chdir(tmp_path / "new")
    (record,) = nav.verify("audits/ekf.toml")
    assert (str(record.status), record.certificate["kind"]) == ("PROVED", "all") and "unchecked" not in record.evidence
    code = Path("audits/ekf.c")
    code.write_text(code.read_text().replace("-x[3] * s", "x[3] * s"))
    (record,) = nav.verify("audits/ekf.toml")
    assert str(record.status) == "REFUTED" and "write -x[3] * s * dt" in record.evidence
    assert "unchecked" not in record.evidence


def test_an_error_model_is_a_claim_and_has_a_page_and_a_fault_in_it_is_found(tmp_path, monkeypatch):
    root = nav.init(tmp_path / "work").root
    text = (Path(__file__).parents[2] / "examples" / "conventions.toml").read_text(encoding="utf-8")
    (root / "models" / "strapdown.toml").write_text(text, encoding="utf-8")
    (root / "models" / "wrong.toml").write_text(text.replace('"f3"', '"-f3"', 1), encoding="utf-8")
    monkeypatch.chdir(root)
    ledger = nav.verify()
    found = {claim.id: (str(claim.status), claim.certificate) for claim in ledger.claims if "conventions" in claim.id}
    assert {name: status for name, (status, _) in found.items()} == {
        "models/strapdown.toml:conventions": "PROVED",
        "models/wrong.toml:conventions": "REFUTED",
    }
    assert all(certificate for _, certificate in found.values())
    site = nav.report(source=ledger)
    pages = [site.out / name for name in site.files if name.endswith(".conventions.html")]
    index = (site.out / "index.html").read_text(encoding="utf-8")
    assert len(pages) == 2 and all(page.name in index for page in pages)


def test_nothing_is_written_to_a_home_that_is_read_only(inside, monkeypatch, tmp_path, capsys):
    home = tmp_path / "home"
    home.mkdir()
    home.chmod(stat.S_IRUSR | stat.S_IXUSR)
    for name in ("HOME", "XDG_CACHE_HOME"):
        monkeypatch.setenv(name, str(home))
    monkeypatch.delenv("NAVSYM_CACHE", raising=False)
    assert run(["verify", "claims/Höhe über Grund.toml", "--write"]) == 0
    assert "the ledger ledger.json agrees" in capsys.readouterr().out and not list(home.iterdir())


def test_a_claim_file_of_no_workspace_passes_where_nothing_can_be_kept(tmp_path, monkeypatch, capsys):
    """No ledger waits for its verdicts: that a cache cannot be written is a remark, and no failure of a workflow."""
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("NAVSYM_CACHE", str(tmp_path / "file" / "cache"))
    monkeypatch.chdir(tmp_path)
    claim = '[[claim]]\nid = "one"\nleft = "1"\nright = "{}"\n'
    for right, status in (("1", 0), ("2", 1)):
        (tmp_path / "my.claims.toml").write_text(claim.format(right))
        assert run(["verify", "my.claims.toml"]) == status
        told = capsys.readouterr()
        assert "verdicts are not kept: " in told.err and "navsym init" in told.out and "unchecked" not in told.out


@pytest.mark.parametrize("wanted", ["claims/baro.toml:square", "../claims/baro.toml:square"])
def test_a_claim_is_shown_by_its_listed_name_or_its_path(inside, capsys, wanted):
    status, record = document(capsys, "show", wanted)
    assert status == 0 and record["id"] == "claims/baro.toml:square" and record["status"] == "PROVED"


def test_explain_names_file_line_and_correction_and_does_not_call_a_typed_side_derived(inside, capsys):
    status, told = document(capsys, "explain", "claims/baro.toml:sum")
    assert status == 0 and told["source"] == "claims/baro.toml:8" and told["corrected_by"] == "claims/baro.toml:sum*"
    assert not any("erived without" in step["words"] for step in told["steps"])
    assert nav.explain("pendulum:2").source == "papers/pendulum.py:22"
    assert any("Derived without" in step.words for step in nav.explain("pendulum:2").steps)


def test_list_and_cite_take_their_verdicts_from_the_ledger_of_the_workspace(inside, capsys):
    _, listed = document(capsys, "list", "--status", "REFUTED")
    assert [claim["id"] for claim in listed["claims"]] == ["claims/baro.toml:sum"] and listed["claims"][0]["decided"]
    _, cited = document(capsys, "cite", "claims/baro.toml:sum")
    assert "Corrected by claims/baro.toml:sum*, PROVED" in cited["bibtex"]


def test_a_target_of_a_model_is_exported_and_a_refuted_claim_names_its_correction(inside, capsys, tmp_path):
    words = ["export", "models/alignment.toml:drift", "--to", "python", "--vectors", "8", "--no-run"]
    status, exported = document(capsys, *words, "--out", str(tmp_path / "code"))
    assert status == 0 and exported["functions"][0]["name"] == "drift"
    status, answer = document(capsys, "export", "claims/baro.toml:sum", "--out", str(tmp_path / "no"))
    assert status == 2 and "export claims/baro.toml:sum*" in answer["error"]["message"]


def test_report_writes_its_pages_and_the_erratum_of_a_claim_file_into_the_workspace(inside):
    site = nav.report("claims/baro.toml", source=inside / "ledger.json")
    assert site.out == inside / "report"
    (sheet,) = [name for name in site.files if name.endswith("erratum.html")]
    assert "the double product is missing" in (site.out / sheet).read_text().lower()
    page = (site.out / sheet.replace(".erratum", "")).read_text()
    assert "derived from the model" not in page and "<h2>Equations" not in page and "(dashed) and other side" in page
    assert page.count("the other side, as the file states it") == 3
    assert page.count("beside the ledger, in certificates.json") == 4 and "none: unchecked" not in page


def test_diff_takes_ids_of_claims_and_two_ledgers(inside, capsys, tmp_path):
    status, answer = document(capsys, "diff", "claims/baro.toml:square", "claims/baro.toml:sum")
    assert status == 0 and answer["differences"][0]["status"] == "EQUAL"
    status, answer = document(capsys, "diff", "pendulum:2", "g*l*A**2/3")
    assert status == 1 and answer["differences"][0]["status"] == "DIFFERENT"
    status, answer = document(capsys, "diff", "models/alignment.toml:drift", "1")
    assert status == 2 and answer["error"]["kind"] == "shape"
    ledger = json.loads((inside / "ledger.json").read_text())
    first, second, *_ = ledger["claims"]
    first["status"], second["statement"] = "OPEN", "another"
    del ledger["claims"][-1]
    (tmp_path / "old.json").write_text(json.dumps(ledger))
    status, answer = document(capsys, "diff", str(tmp_path / "old.json"), str(inside / "ledger.json"))
    found = {d["name"]: (d["status"], d["why"]) for d in answer["differences"]}
    assert status == 1 and [kind for kind, _ in found.values()].count("EQUAL") == len(found) - 3
    assert found[first["id"]] == ("DIFFERENT", "PROVED, it was OPEN") and "another statement" in found[second["id"]][1]
    assert found["pendulum:2"][0] == "ONLY-NEW"
    assert document(capsys, "diff", "../ledger.json", "../ledger.json")[0] == 0


def test_a_paper_of_the_library_is_known_by_name_and_not_among_what_is_listed(inside):
    (record,) = nav.show("alpha_beta_filter:12.stable")
    assert record.status == "PROVED"
    assert "alpha_beta_filter" not in {claim.paper for claim in nav.claims()}


def test_new_paper_and_new_claim_write_into_the_workspace(tmp_path, monkeypatch, capsys):
    nav.init(tmp_path / "w")
    monkeypatch.chdir(tmp_path / "w")
    assert run(["new-paper", "circle", "--title", "Circles", "--equations", "1"]) == 0
    words = ["new-claim", "circle", "1", "--printed", "sin(2*a)", "--derived", "2*sin(a)*cos(a)", "--title", "Sine."]
    assert run(words) == 0 and (tmp_path / "w" / "papers" / "circle.py").is_file()
    assert [claim.id for claim in nav.claims("circle")] == ["circle:1"]
    (record,) = nav.show("circle:1")
    assert record.status == "PROVED"


def test_an_edited_claim_is_decided_again_and_an_edited_paper_run_again(tmp_path, monkeypatch):
    nav.init(tmp_path / "w")
    monkeypatch.chdir(tmp_path / "w")
    file = Path("claims/baro.toml")
    file.write_text('[symbols]\na = "real"\n[[claim]]\nid = "one"\nleft = "a + a"\nright = "2*a"\n')
    nav.verify("claims/baro.toml").write()
    assert nav.claims("claims/baro.toml")[0].status == "PROVED"
    file.write_text(file.read_text().replace("2*a", "3*a"))
    assert nav.claims("claims/baro.toml").changed == ("claims/baro.toml",)
    assert [str(r.status) for r in nav.verify("claims/baro.toml").unexpected] == ["REFUTED"]
    assert run(["verify", "claims/baro.toml"]) == 1
    paper = Path("papers/pendulum.py")
    paper.write_text(paper.read_text().replace("l * A**2 / 2,", "l * A**2 / 3,"))
    (record,) = nav.show("pendulum:2")
    assert record.status == "REFUTED"


def test_the_nearest_workspace_counts_and_an_outer_one_leaves_its_files_alone(tmp_path):
    outer = nav.init(tmp_path / "outer")
    inner = nav.init(tmp_path / "outer" / "claims" / "inner")
    (outer.root / "navsym.toml").write_text('[workspace]\nclaims = ["**/*.toml"]\n')
    assert find_workspace(inner.root / "papers").root == inner.root
    listed = find_workspace(outer.root / "claims").list_files("claims")
    assert listed == ["audits/ekf.toml", "claims/baro.toml", "models/alignment.toml"]


def test_a_workspace_is_not_made_over_another_one(folder, capsys):
    status, answer = document(capsys, "init", str(folder))
    assert status == 2 and answer["error"]["kind"] == "duplicate" and "navsym.toml" in answer["error"]["where"]


@pytest.mark.parametrize(
    ("text", "kind", "hint"),
    [
        ("[workspace]\nclaim = []\n", "syntax", "claims"),
        ("[work]\n", "syntax", "workspace"),
        ("workspace = 3\n", "shape", "[workspace]"),
        ('[workspace]\nclaims = "claims/*.toml"\n', "shape", '["claims/*.toml"]'),
        ("[workspace]\nclaims = [3]\n", "empty", "in quotes"),
        ('[workspace]\nclaims = ["../*.toml"]\n', "domain", "inside the workspace"),
        ('[workspace]\nclaims = ["/etc/*.toml"]\n', "domain", "inside the workspace"),
        ('[workspace]\npapers = ["papers/*"]\n', "domain", "end in .py"),
        ('[workspace]\nclaims = ["claims/none.toml"]\n', "missing-file", "take it off the list"),
        ('[workspace]\nclaims = ["claims/*.toml"]\nmodels = ["claims/*.toml"]\n', "duplicate", "list it once"),
        ('[workspace]\nclaims = ["nothing/*.toml"]\n', "empty", "correct the patterns"),
        ('[workspace]\nclaims = ["links/*.toml"]\n', "domain", "copy the file"),
        ("[workspace\n", "syntax", "correct it"),
    ],
)
def test_a_bad_list_is_refused_with_its_place(tmp_path, monkeypatch, capsys, text, kind, hint):
    root = nav.init(tmp_path / "w").root
    (tmp_path / "outside.toml").write_text(CLAIMS)
    (root / "links").mkdir()
    (root / "links" / "link.toml").symlink_to(tmp_path / "outside.toml")
    (root / "navsym.toml").write_text(text)
    monkeypatch.chdir(root)
    status, answer = document(capsys, "verify")
    assert status == 2 and answer["error"]["kind"] == kind, answer
    assert hint in answer["error"]["message"] and str(root) in answer["error"]["where"]


@pytest.mark.parametrize(
    ("source", "line", "hint"),
    [
        ("x = 1\n1/0\n", ": line 2", "ZeroDivisionError"),
        ("def f(:\n", ": line 1", "SyntaxError"),
        ("x = 1\n", "", "PAPER"),
    ],
)
def test_a_paper_that_does_not_run_is_an_error_with_its_line(tmp_path, monkeypatch, capsys, source, line, hint):
    root = nav.init(tmp_path / "w").root
    (root / "papers" / "pendulum.py").write_text(source)
    monkeypatch.chdir(root)
    status, answer = document(capsys, "list")
    assert status == 2 and answer["error"]["where"] == f"{root}/papers/pendulum.py{line}"
    assert hint in answer["error"]["message"]


def test_a_python_file_that_is_not_listed_is_never_run(tmp_path, monkeypatch):
    root = nav.init(tmp_path / "w").root
    (root / "papers" / "_helper.py").write_text("raise SystemExit('run')\n")
    (root / "other.py").write_text("raise SystemExit('run')\n")
    monkeypatch.chdir(root)
    made = {"claims/baro.toml", "models/alignment.toml", "audits/ekf.toml", "pendulum"}
    assert {claim.paper for claim in nav.claims()} == made


@pytest.mark.parametrize(
    ("wanted", "hint"),
    [
        ("claims/baro.toml:sqare", "take one of claims/baro.toml:square"),
        ("claims/none.toml:square", "nothing there"),
        ("pendulm:2", "did you mean pendulum?"),
        ("navsym.toml:claims", "expected [[claim]] blocks"),
    ],
)
def test_an_id_that_is_none_gets_advice(inside, monkeypatch, capsys, wanted, hint):
    monkeypatch.chdir(inside)
    status, answer = document(capsys, "show", wanted)
    assert status == 2 and hint in answer["error"]["message"], answer


def test_two_claims_of_one_id_are_refused(tmp_path, monkeypatch, capsys):
    root = nav.init(tmp_path / "w").root
    block = '[[claim]]\nid = "one"\nleft = "1"\nright = "1"\n'
    (root / "claims" / "baro.toml").write_text(block + block)
    monkeypatch.chdir(root)
    status, answer = document(capsys, "verify")
    assert status == 2 and answer["error"]["kind"] == "duplicate" and "claims/baro.toml" in answer["error"]["where"]


@pytest.mark.parametrize(
    ("line", "kind"), [('expect = "RIGHT"', "domain"), ("expect = 1", "syntax"), ('title = ""', "empty")]
)
def test_a_note_of_a_claim_is_checked(tmp_path, capsys, line, kind):
    file = tmp_path / "claims.toml"
    file.write_text(f'[[claim]]\nid = "one"\nleft = "1"\nright = "1"\n{line}\n')
    status, answer = document(capsys, "show", f"{file}:one")
    assert status == 2 and answer["error"]["kind"] == kind


def test_the_examples_of_the_documentation_come_with_the_library_and_replace_nothing(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert run(["init", "--examples"]) == 0 and find_workspace() is None
    ours = Path(__file__).resolve().parents[2] / "examples"
    for path in ours.rglob("*.*"):
        assert (tmp_path / "examples" / path.relative_to(ours)).read_bytes() == path.read_bytes()
    assert run(["init", "--examples"]) == 2 and "a folder without examples" in capsys.readouterr().err


def test_hook_and_workflow_outside_a_workspace_say_so_and_decide_no_paper_of_ours(tmp_path, monkeypatch, capsys):
    root = Path(__file__).resolve().parents[2]
    assert "entry: navsym verify --workspace" in (root / ".pre-commit-hooks.yaml").read_text(encoding="utf-8")
    assert "navsym verify ${CLAIMS:---workspace}" in (root / "action.yml").read_text(encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    assert run(["verify", "--workspace", "--json"]) == 2
    error = json.loads(capsys.readouterr().out)["error"]
    assert error["kind"] == "missing-file" and "run navsym init" in error["message"]
    (tmp_path / "navsym.toml").write_text('[workspace]\nclaims = ["*.claims.toml"]\n', encoding="utf-8")
    (tmp_path / "a.claims.toml").write_text(CLAIMS, encoding="utf-8")
    assert run(["verify", "--workspace", "--json"]) == 0
