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
from navsym.language import shapes
from navsym.models import modelfile
from navsym.prove.claimfile import NOTES as CLAIM_NOTES
from navsym.prove.relations import reading

ROOT = Path(__file__).parents[2]
FILES = {
    "claims": [ROOT / "examples" / "formulas.toml"],
    "models": [ROOT / "examples" / name for name in ("guard.toml", "schuler-velocity.toml", "conventions.toml")],
    "audits": sorted((ROOT / "examples" / "audit").glob("*.toml")),
}


def schema(kind):
    return json.loads((SCHEMAS / f"{kind}.schema.json").read_text(encoding="utf-8"))


@pytest.mark.parametrize(("kind", "path"), [(k, p) for k, paths in FILES.items() for p in paths], ids=lambda v: str(v))
def test_every_example_is_valid(kind, path):
    Draft7Validator.check_schema(schema(kind))
    errors = [error.message for error in Draft7Validator(schema(kind)).iter_errors(tomllib.loads(path.read_text()))]
    assert not errors


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
    assert set(schema("models")["properties"]) == {*modelfile.TABLES, *modelfile.BESIDE}
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
