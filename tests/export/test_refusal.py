"""What does not hold does not leave; what leaves stays in its folder."""

from __future__ import annotations

import json
import os
import random
import re
from pathlib import Path

import pytest
import sympy as sp

import navsym as nav
from navsym.claims import CONFIRMED, OPEN, PROVED, Bound, Equation, Finding, Property, Verdict
from navsym.cli.main import run
from navsym.core.errors import DomainError, NavsymError
from navsym.export.folder import FolderError, write_folder
from navsym.export.functions import RefusedError, function_of, material
from navsym.export.languages.names import function_name, identifier
from navsym.export.languages.targets import TARGETS, find_targets
from navsym.export.package import Order, files_of
from navsym.export.roundtrip import check_export, hash_trouble, sealed, unsealed
from navsym.prove.ladder import decide
from tests.export import samples

a = sp.Symbol("a", real=True)
TRUE = Equation(sp.sin(2 * a), 2 * sp.sin(a) * sp.cos(a))


def test_a_refuted_claim_names_its_correction(capsys, tmp_path: Path) -> None:
    assert run(["export", "guaranteed_velocity:4.14.y2", "--out", str(tmp_path / "x"), "--json"]) == 2
    error = json.loads(capsys.readouterr().out)["error"]
    assert error["kind"] == "refused" and "export guaranteed_velocity:4.14.y2*" in error["message"]
    assert not (tmp_path / "x").exists()


def test_a_user_formula_that_is_wrong_is_refused(capsys, tmp_path: Path) -> None:
    file = tmp_path / "mine.toml"
    file.write_text('[symbols]\na = "real"\n[[claim]]\nid = "half"\nleft = "sin(2*a)"\nright = "2*sin(a)"\n')
    assert run(["export", f"{file}:half", "--out", str(tmp_path / "x")]) == 2
    assert "refuted" in capsys.readouterr().err


def test_a_user_formula_that_holds_is_exported_and_checked(capsys, tmp_path: Path) -> None:
    file = tmp_path / "mine.toml"
    text = '[symbols]\nlambda = "real"\nT = ["0", "2"]\nt = ["0", "2"]\n[[claim]]\nid = "double"\n'
    file.write_text(f'{text}left = "sin(2*lambda)*T*t"\nright = "2*t*T*sin(lambda)*cos(lambda)"\n')
    out = tmp_path / "out"
    assert run(["export", f"{file}:double", "--to", "c,python", "--out", str(out), "--vectors", "12", "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert {row["language"]: row["status"] for row in document["languages"]} == {"c": "verified", "python": "verified"}
    assert run(["check", str(out), "--json"]) == 0
    rows = json.loads(capsys.readouterr().out)["checked"]
    assert rows and all(row["status"] == "ACCEPTED" for row in rows)
    assert {row["kind"] for row in rows} >= {"manifest", "code:c", "code:python", "proof"}


def test_open_and_confirmed_claims_are_refused() -> None:
    with pytest.raises(RefusedError, match="OPEN"):
        material("m:1", TRUE, Verdict(OPEN, "none", evidence="not decided"))
    with pytest.raises(RefusedError, match="allow_confirmed=True"):
        material("m:1", TRUE, Verdict(CONFIRMED, "sampling"))
    assert material("m:1", TRUE, Verdict(CONFIRMED, "sampling"), allow_confirmed=True).source.status == "CONFIRMED"


def test_an_inequality_and_a_fact_have_nothing_to_compute() -> None:
    for statement in (Bound(a**2, ">=", 0), Property(True, Finding(True, "by hand", PROVED))):
        with pytest.raises(RefusedError, match="nothing to compute"):
            material("m:1", statement, decide(statement))


def test_regimes_with_a_gap_are_refused() -> None:
    T = sp.Symbol("T", positive=True)
    parts = [Equation(T, T, {T: (0, 1)}), Equation(T**2, T**2, {T: (2, 3)})]
    with pytest.raises(DomainError, match="adjoin"):
        function_of([material(f"m:{k}", s, decide(s)) for k, s in enumerate(parts)])


@pytest.mark.parametrize(
    "name", ["lambda", "for", "E", "I", "y0", "gamma", "t1", "pi", "class", "fn", "ω", "x'", "1a", "*/"]
)
def test_every_name_becomes_one_that_all_languages_accept(name: str) -> None:
    made = identifier(name)
    assert made.isascii() and made.isidentifier() and made != "lambda"


def test_names_differ_without_regard_to_case() -> None:
    assert identifier("t", ["T"]).lower() != "t"
    assert function_name("guaranteed_velocity:4.8*") == "guaranteed_velocity_4_8_corrected"


def test_nothing_is_overwritten_unasked(tmp_path: Path) -> None:
    write_folder(tmp_path / "e", {"c/a.c": "one"})
    with pytest.raises(FolderError, match="force=True"):
        write_folder(tmp_path / "e", {"c/a.c": "two"})
    write_folder(tmp_path / "e", {"c/a.c": "two"}, force=True)
    assert (tmp_path / "e" / "c" / "a.c").read_text() == "two"


@pytest.mark.parametrize("name", ["../a", "/etc/x", "c/../../a", "c\\a", "", ".hidden", "a\0b", "c//a"])
def test_names_that_could_leave_the_folder_are_refused(tmp_path: Path, name: str) -> None:
    with pytest.raises(FolderError):
        write_folder(tmp_path / "e", {name: "x"}, force=True)


def test_links_are_not_followed(tmp_path: Path) -> None:
    outside = tmp_path / "outside"
    outside.mkdir()
    out = tmp_path / "e"
    out.mkdir()
    (out / "c").symlink_to(outside)
    (out / "manifest.json").symlink_to(outside / "stolen")
    for name in ("c/a.c", "manifest.json"):
        with pytest.raises(FolderError, match="symbolic link"):
            write_folder(out, {name: "x"}, force=True)
    (tmp_path / "link").symlink_to(out)
    with pytest.raises(FolderError, match="symbolic link"):
        write_folder(tmp_path / "link", {"a": "x"})
    assert not list(outside.iterdir())


def test_a_changed_file_is_noticed(capsys, tmp_path: Path) -> None:
    out = tmp_path / "e"
    assert run(["export", "guaranteed_velocity:4.12.Phi31", "--to", "python", "--out", str(out), "--vectors", "8"]) == 0
    capsys.readouterr()
    source = out / "python" / "navsym_functions.py"
    source.write_text(source.read_text() + "\n# touched\n")
    assert run(["check", str(out), "--json"]) == 1
    rows = json.loads(capsys.readouterr().out)["checked"]
    assert any(row["kind"] == "manifest" and "hash" in row["why"] for row in rows)


@pytest.mark.parametrize("change", ["removed", "a line more"])
def test_code_without_its_manifest_as_written_is_rejected(change: str, tmp_path: Path) -> None:
    files = files_of([samples.by_name("versine")], Order(tuple(find_targets(["python"], "double")), count=4))
    write_folder(tmp_path, files)
    manifest = tmp_path / "manifest.json"
    assert [row["status"] for row in check_export(tmp_path)] == ["ACCEPTED"] * 2
    if change == "removed":
        manifest.unlink()
    else:
        manifest.write_text(manifest.read_text() + "\n")
    assert "REJECTED" in [row["status"] for row in check_export(tmp_path)]


def test_a_byte_altered_anywhere_is_noticed(tmp_path: Path) -> None:
    """In every file of every language, and at every place of the manifest: by hash or seal, before anything runs."""
    targets = tuple(TARGETS[name] for name in TARGETS if name != "html")
    files = files_of([samples.by_name("Phi33")], Order(targets, count=4))
    write_folder(tmp_path, files)
    hashes = json.loads(files["manifest.json"])["files"]
    assert not hash_trouble(tmp_path, hashes) and set(hashes) == set(files) - {"manifest.json"}
    generator = random.Random(1)
    for name in hashes:
        whole = (tmp_path / name).read_bytes()
        place = generator.randrange(len(whole))
        (tmp_path / name).write_bytes(altered(whole, place))
        assert name in hash_trouble(tmp_path, hashes)
        (tmp_path / name).write_bytes(whole)
    whole = files["manifest.json"].encode()
    assert not unsealed(whole)[1]
    for place in range(len(whole)):
        try:
            assert unsealed(altered(whole, place))[1], whole[max(0, place - 20) : place + 20]
        except ValueError:
            continue


def altered(whole: bytes, place: int) -> bytes:
    return whole[:place] + bytes([whole[place] ^ 1]) + whole[place + 1 :]


def test_only_what_the_manifest_lists_is_run(tmp_path: Path) -> None:
    write_folder(tmp_path, files_of([samples.by_name("versine")], Order(tuple(find_targets(["c"], "double")), count=4)))
    (tmp_path / "c" / "planted.c").write_text("int main(void) { return 7; }\n")
    assert all(row["status"] == "ACCEPTED" for row in check_export(tmp_path))


def test_a_manifest_cannot_make_the_check_read_elsewhere(tmp_path: Path) -> None:
    files = files_of([samples.by_name("versine")], Order(tuple(find_targets(["python"], "double")), count=4))
    write_folder(tmp_path / "e", files)
    (tmp_path / "outside").write_text("secret")
    manifest = json.loads(files["manifest.json"])
    del manifest["seal"]
    for name in ("python/../../outside", str(tmp_path / "outside"), "python//navsym_functions.py"):
        manifest["files"][name] = "0" * 64
        (tmp_path / "e" / "manifest.json").write_text(sealed(manifest))
        first, *_ = check_export(tmp_path / "e")
        assert first["status"] == "REJECTED" and "plain file" in first["why"]
        del manifest["files"][name]


def test_a_folder_of_certificates_needs_no_manifest(tmp_path: Path) -> None:
    (tmp_path / "c").mkdir()
    (tmp_path / "c" / "claim.json").write_text("{}")
    assert check_export(tmp_path) == []


def test_a_full_disk_leaves_nothing_behind(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    calls = []

    def full(path: str, mode: int) -> None:
        calls.append(path)
        if len(calls) == 3:
            raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.chmod", full)
    with pytest.raises(FolderError, match="No space left") as error:
        write_folder(tmp_path / "e", {"c/a.c": "x", "c/b.c": "x", "certificates/d.json": "x"})
    assert error.value.kind == "output" and not (tmp_path / "e").exists()


def test_what_is_replaced_stays_when_the_disk_is_full(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write_folder(tmp_path, {"a": "old", "b": "old"})
    monkeypatch.setattr("os.chmod", lambda path, mode: os.close(-1))
    with pytest.raises(FolderError):
        write_folder(tmp_path, {"a": "new", "b": "new"}, force=True)
    assert sorted((p.name, p.read_text()) for p in tmp_path.iterdir()) == [("a", "old"), ("b", "old")]


def test_a_comment_cannot_be_closed_by_a_title() -> None:
    function = function_of([material("m:1", TRUE, decide(TRUE), title='*/ int x; /* """ ??/')])
    files = files_of([function], Order(tuple(find_targets(["c", "cpp", "javascript"], "double")), count=4))
    assert "*/ int x" not in "".join(text for name, text in files.items() if not name.endswith(".json"))


@pytest.mark.parametrize("license_", ["", "MIT\n*/", "x" * 100, "Ünicode"])
def test_a_licence_is_an_identifier(license_: str) -> None:
    with pytest.raises(DomainError, match="SPDX"):
        files_of([samples.by_name("versine")], Order(tuple(find_targets(["c"], "double")), license=license_, count=4))


@pytest.mark.parametrize(
    "argument", ["nothing", "guaranteed_velocity:", "guaranteed_velocity:9.9", "no_module:1", "x.toml:a"]
)
def test_bad_arguments_are_bad_input(argument: str, tmp_path: Path, capsys) -> None:
    assert run(["export", argument, "--out", str(tmp_path / "o")]) == 2
    assert "expected" in capsys.readouterr().err


def test_unknown_languages_are_named() -> None:
    with pytest.raises(NavsymError, match="cobol"):
        find_targets(["cobol"], "double")
    with pytest.raises(NavsymError, match="only double"):
        find_targets(["javascript"], "float")


def test_a_function_is_not_called_like_one_that_a_language_has() -> None:
    for name in ("sum", "main", "printf", "test_vectors", "size", "value", "AUX", "step"):
        assert function_name(name) == f"{name}_"
    assert function_name("drift") == "drift" and function_name("navsym_numbers") == "navsym_numbers_"


def test_no_function_bears_the_name_of_a_variable_of_its_test_program(tmp_path: Path) -> None:
    nav.export("guaranteed_velocity:4.12.Phi31", to=["c", "cpp", "fortran", "rust"], out=tmp_path, vectors=4, run=False)
    programs = "c/test_main.c", "cpp/test_main.cpp", "rust/test_main.rs"
    texts = [(tmp_path / name).read_text() for name in programs]
    found = {name for text in texts for name in re.findall(r"\b(?:let(?: mut)?|int|double|for) (\w+)", text)}
    lists = re.findall(r":: (.*)", (tmp_path / "fortran" / "test_vectors.f90").read_text())
    found |= {name for line in lists for name in re.findall(r"[a-z_]\w*", re.sub(r"\(.*?\)|=.*", "", line))}
    names = {name for name in found if not name.startswith("test_guaranteed_velocity")} - {"only"}
    assert {"v", "k", "line", "worst", "lower"} <= names
    assert [name for name in sorted(names) if function_name(name) == name] == []


def test_a_function_is_not_called_like_one_of_its_arguments() -> None:
    """Fortran has one name for one thing, in capitals or not."""
    found = function_of([material("m:1", TRUE, decide(TRUE))], name="A")
    assert found.name == "A_" and [i.name for i in found.inputs] == ["a"]


CLAIM = '[symbols]\nx = "real"\n' + "".join(
    f'[[claim]]\nid = "{label}"\nleft = "{k}*x + x"\nright = "{k + 1}*x"\n'
    for k, label in enumerate(("a", "a+b", "a+b:c", "x+1.2*"), 1)
)


@pytest.mark.parametrize(("label", "name"), [("a+b", "f_a_b"), ("a+b:c", "f_a_b_c"), ("x+1.2*", "f_x_1_2_corrected")])
def test_a_plus_in_the_id_of_a_claim_is_no_join(tmp_path: Path, label: str, name: str) -> None:
    (tmp_path / "f.toml").write_text(CLAIM)
    found = nav.export(f"{tmp_path / 'f.toml'}:{label}", to="python", out=tmp_path / "out", run=False, vectors=4)
    assert [f["name"] for f in found.document()["functions"]] == [name]


def test_a_remedy_names_the_argument_in_python_and_the_option_on_the_command_line(tmp_path: Path, capsys) -> None:
    (tmp_path / "f.toml").write_text(CLAIM)
    what, out = f"{tmp_path / 'f.toml'}:a", tmp_path / "out"
    nav.export(what, to="python", out=out, run=False, vectors=4)
    with pytest.raises(nav.NavsymError, match=r"; add force=True, or choose another folder$"):
        nav.export(what, to="python", out=out, run=False, vectors=4)
    words = ["export", what, "--out", str(out), "--no-run", "--vectors", "4"]
    assert run([*words, "--to", "python"]) == 2
    said = capsys.readouterr().err
    assert "; add --force, or choose another folder" in said and "=True" not in said
    with pytest.raises(nav.NavsymError) as caught:
        nav.export(what, to="cobol", out=out)
    assert caught.value.where == "export: to"
    assert run([*words, "--to", "cobol"]) == 2 and "--to: expected languages" in capsys.readouterr().err
