"""The JSON schemas of the TOML files accept what navsym reads, know its keys and refuse what it refuses."""

import json
import tomllib
from pathlib import Path

import pytest
from jsonschema import Draft7Validator

import navsym as nav
from navsym.audit.questions import KINDS, NOTES, more_keys
from navsym.claims import Status
from navsym.claims.workspace import ENDINGS, SCHEMAS
from navsym.conventions import card, measuring, mechanisation
from navsym.conventions import reading as conventions_file
from navsym.language import shapes
from navsym.language.tomlfile import read_toml
from navsym.models import modelfile
from navsym.prove.claimfile import NOTES as CLAIM_NOTES
from navsym.prove.relations import reading

ROOT = Path(__file__).parents[2]
FILES = {
    "claims": [ROOT / "examples" / "formulas.toml"],
    "models": [p for p in sorted((ROOT / "examples").glob("*.toml")) if {"model", "card"} & {*read_toml(p)}],
    "audits": sorted((ROOT / "examples" / "audit").glob("*.toml")),
}


def schema(kind):
    return json.loads((SCHEMAS / f"{kind}.schema.json").read_text(encoding="utf-8"))


@pytest.mark.parametrize(("kind", "path"), [(k, p) for k, paths in FILES.items() for p in paths], ids=lambda v: str(v))
def test_every_example_is_valid(kind, path):
    Draft7Validator.check_schema(schema(kind))
    errors = [error.message for error in Draft7Validator(schema(kind)).iter_errors(tomllib.loads(path.read_text()))]
    assert not errors


@pytest.mark.parametrize("path", FILES["models"], ids=lambda path: path.name)
def test_a_file_that_the_schema_accepts_is_read_by_the_verb_that_it_is_for(path):
    tables = read_toml(path)
    if "roles" in tables:
        assert nav.conventions(path).problem.states
    if "measurement" in tables:  # the tables of one verb do not disturb another
        assert modelfile.read_model(path).states == tuple(tables["model"]["states"])


def test_tables_and_keys_that_only_conventions_read_do_not_disturb_other_verbs():
    document = read_toml(ROOT / "examples" / "conventions.toml")
    document["model"] |= {"H": [["1"] + ["0"] * 11], "G": [["0"]] * 12, "reset": [["0"] * 12] * 12}
    document |= {"measured": {"height": [1]}, "noises": {}, "card": {}}
    assert not [*Draft7Validator(schema("models")).iter_errors(document)]
    assert modelfile.model_from(document).F.shape == (12, 12)


def test_the_symbols_of_documents_have_the_schema_of_claims_and_may_stand_beside_claims(tmp_path):
    text = "[symbols]\nC_bn = { rotation = 'b to n' }\n[latex]\nC_bn = 'C_b^n'\n"
    claim = "[[claim]]\nid = 'a'\nleft = 'C_bn @ C_bn.T'\nright = 'eye(3)'\n"
    for whole in (text, text + claim):
        assert not [*Draft7Validator(schema("claims")).iter_errors(tomllib.loads(whole))]
    path = tmp_path / "symbols.toml"
    path.write_text(text + claim, encoding="utf-8")
    assert nav.prove(path).holds and nav.read("C_b^n = C_b^n", symbols=path).formulas[0].left == "C_bn"


def test_chapters_of_the_book_are_claims_under_the_schema():
    validator = Draft7Validator(schema("claims"))
    for entry in nav.book.values():
        assert not [error.message for error in validator.iter_errors(entry.document)], entry.id


def test_the_schemas_have_the_keys_that_the_readers_have():
    claim = schema("claims")["properties"]["claim"]["items"]["properties"]
    assert set(claim) == {*reading.KEYS, *CLAIM_NOTES}
    assert set(claim["expect"]["enum"]) == {str(status) for status in Status}
    declaration = schema("claims")["definitions"]["declaration"]["anyOf"][-1]["properties"]
    assert set(declaration) == set(shapes.KEYS)
    tables = schema("models")["properties"]
    assert set(tables) == {*modelfile.TABLES, *modelfile.BESIDE}
    assert set(tables["model"]["properties"]) == {*modelfile.KEYS, *modelfile.BESIDE_F}
    for name in ("card", "known"):
        assert {key: tuple(words["enum"]) for key, words in tables[name]["properties"].items()} == card.CHOICES
    for name, words in {
        "roles": mechanisation.ROLES,
        "quantities": conventions_file.QUANTITIES,
        "measured": measuring.MEASURED,
        "noises": measuring.NOISES,
    }.items():
        assert set(tables[name]["properties"]) == {*words}, name
    assert tables["code"]["items"] == schema("audits")["properties"]["code"]["items"]
    question = schema("audits")["properties"]["question"]["items"]["properties"]
    assert set(question["kind"]["enum"]) == set(KINDS)
    own = {key for kind, keys in KINDS.items() for key in (*keys, *more_keys(kind))}
    assert set(question) == {"name", "kind", *NOTES, *own}
    assert set(schema("workspace")["properties"]["workspace"]["properties"]) == set(ENDINGS)


@pytest.mark.parametrize(
    ("kind", "text"),
    [
        ("claims", '[[claim]]\nid = "a"\nleft = "1"\nrihgt = "1"'),
        ("claims", '[[claim]]\nid = "a"\nleft = "1"'),
        ("claims", '[[claim]]\nid = "a"\nleft = "1"\nright = "1"\nrelation = "=="'),
        ("claims", '[symbols]\nx = "postive"\n[[claim]]\nid = "a"\nleft = "x"\nright = "x"'),
        ("claims", '[symbols]\nx = { vektor = 3 }\n[[claim]]\nid = "a"\nleft = "x"\nright = "x"'),
        ("models", "[model]\nF = [[0]]"),
        ("models", '[parameters]\na = "real"'),
        ("audits", '[[question]]\nname = "a"\nkind = "jacobain"'),
        ("workspace", '[workspace]\nclaim = ["*.toml"]'),
    ],
)
def test_a_slip_is_seen_by_the_schema(kind, text):
    assert [*Draft7Validator(schema(kind)).iter_errors(tomllib.loads(text))]


def test_a_new_workspace_has_the_schemas_where_editors_look(tmp_path):
    nav.init(tmp_path)
    rules = tomllib.loads((tmp_path / ".taplo.toml").read_text())["rule"]
    for rule in rules:
        found = json.loads((tmp_path / rule["schema"]["path"]).read_text())
        for pattern in rule["include"]:
            for path in tmp_path.glob(pattern):
                assert not [*Draft7Validator(found).iter_errors(tomllib.loads(path.read_text()))], path
    assert {rule["include"][0].partition("/")[0] for rule in rules} == {"claims", "models", "audits", "navsym.toml"}
