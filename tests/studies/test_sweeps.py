"""Sweeps: the same bits whoever computes, resumed by missing shards, closed forms met."""

from __future__ import annotations

import gc
import json
import socket
from fractions import Fraction
from threading import Thread

import pytest
from dask.distributed import Client

from navsym.cli.main import run
from navsym.core.errors import DomainError, MissingEngineError, NavsymError
from navsym.core.store import code_digest, key_of
from navsym.studies import run as sweep_shards
from navsym.studies.cluster import greet
from navsym.studies.plan import Sweep, fingerprint, run_job, sweep_from
from navsym.studies.run import cut
from navsym.studies.run import sweep as run_sweep


@pytest.fixture(autouse=True)
def own_store(monkeypatch, tmp_path):
    monkeypatch.setenv("NAVSYM_CACHE", str(tmp_path))


SMALL = Sweep("filter", jobs=6, seed=3, runs=4, steps=6)


def embedded(sweep, **options):
    return run_sweep(sweep, workers=0, size=2, **options).document()


def test_a_job_depends_on_its_index_and_nothing_else():
    backwards = [run_job(SMALL, index) for index in reversed(range(6))][::-1]
    assert backwards == embedded(SMALL)["rows"]
    assert len({row["mse0"] for row in backwards}) == 6


def test_the_cut_into_shards_does_not_change_a_bit(tmp_path):
    whole = run_sweep(SMALL, size=6, out=tmp_path / "a").document()["rows"]
    assert json.dumps(whole) == json.dumps(run_sweep(SMALL, size=1, out=tmp_path / "b").document()["rows"])


def test_shards_cover_every_job_once():
    assert [list(part) for part in cut(5, 2)] == [[0, 1], [2, 3], [4]]
    assert len(cut(25_600)) == 256 and sum(map(len, cut(10**6))) == 10**6


def test_of_a_million_jobs_few_are_lost_with_their_process():
    assert max(map(len, cut(10**6))) <= 100


def test_a_second_run_computes_what_is_missing_only(monkeypatch, tmp_path):
    first = embedded(SMALL, out=tmp_path / "s")
    files = sorted((tmp_path / "s").glob("*.parquet"))
    assert len(files) == 3
    files[1].unlink()
    files[2].write_bytes(files[2].read_bytes()[:-7])  # cut short
    seen = []
    monkeypatch.setattr("navsym.studies.run.run_job", lambda sweep, k: seen.append(k) or run_job(sweep, k))
    second = embedded(SMALL, out=tmp_path / "s")
    assert seen == [2, 3, 4, 5] and second["resumed"] == 2 and second["rows"] == first["rows"]


def test_a_shard_with_any_byte_changed_is_right_or_not_read(tmp_path):
    rows = run_sweep(SMALL, out=tmp_path / "s", size=6).document()["rows"]
    (file,) = (tmp_path / "s").iterdir()
    honest = file.read_bytes()
    study = key_of("sweep", fingerprint(SMALL), code_digest())
    for place in range(len(honest)):
        file.write_bytes(honest[:place] + bytes([honest[place] ^ 16]) + honest[place + 1 :])
        assert sweep_shards.Shards(tmp_path / "s", study).read(range(6)) in (None, rows)


def test_a_folder_in_the_place_of_a_shard_is_named_and_the_rows_are_there(tmp_path):
    (tmp_path / "s" / "jobs-0000002-0000004.parquet").mkdir(parents=True)
    document = embedded(SMALL, out=tmp_path / "s")
    assert document["done"] == 6 and len(document["unsaved"]) == 1 and "0000002" in document["unsaved"][0]


@pytest.mark.parametrize("kind", ["two-stage", "phases"])
def test_a_job_without_a_finite_answer_is_named(kind, tmp_path):
    far = "99999999999999999999999999999"
    study = Sweep(kind, jobs=2, columns=2, start=far, end=far)
    with pytest.raises(NavsymError, match="job 0: expected"):
        embedded(study, out=tmp_path / "s")


@pytest.mark.parametrize("patience", [0.0, -1.0, float("nan")])
def test_a_patience_that_never_ends_anything_is_refused(patience, tmp_path):
    with pytest.raises(DomainError, match="patience"):
        embedded(SMALL, out=tmp_path / "s", patience=patience)


def test_shards_of_another_study_are_not_mixed_in(tmp_path):
    embedded(SMALL, out=tmp_path / "s")
    other = Sweep("filter", jobs=6, seed=4, runs=4, steps=6)
    assert embedded(other, out=tmp_path / "s")["resumed"] == 0


def test_a_shard_that_cannot_be_kept_is_named_and_the_rows_are_there(monkeypatch, tmp_path):
    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(sweep_shards.os, "replace", full)
    document = embedded(SMALL, out=tmp_path / "s")
    assert len(document["unsaved"]) == 3 and "No space" in document["unsaved"][0]
    assert document["done"] == 6 and not list((tmp_path / "s").iterdir())


def test_the_guaranteed_slope_over_lengths_is_two_over_T():
    """The slope of a line on [0, T] has the guaranteed standard deviation 2/T."""
    document = embedded(Sweep("guaranteed", jobs=3, degree=1, start="1", end="2"))
    for row in document["rows"]:
        assert Fraction(row["lower"]) <= 2 / Fraction(row["T"]) <= Fraction(row["upper"])


def test_the_value_over_length_and_frequency_depends_on_their_product():
    """Beside cos(w t) and sin(w t) a constant is as hard to estimate on [0, T] as beside cos(s), sin(s) on [0, w T]."""
    grid = Sweep("phases", jobs=4, columns=2, start="1", end="2", second_start="1/2", second_end="1")
    rows = {(row["T"], row["w"]): row for row in embedded(grid)["rows"]}
    assert set(rows) == {("1", "1/2"), ("1", "1"), ("2", "1/2"), ("2", "1")}
    one, two = rows["1", "1"], rows["2", "1/2"]
    assert Fraction(one["lower"]) <= Fraction(two["upper"]) and Fraction(two["lower"]) <= Fraction(one["upper"])


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["terrain", "two-stage"])
def test_other_studies_run_too(kind):
    document = embedded(Sweep(kind, jobs=2, columns=1 if kind == "terrain" else 2))
    assert document["done"] == 2 and document["rows"][0] != document["rows"][1]


@pytest.mark.parametrize(
    "address", ["tcp://127.0.0.1:9", "tcp://nowhere.invalid:8786", "", "file", "http://127.0.0.1:80"]
)
def test_a_scheduler_that_does_not_answer_is_said(tmp_path, capsys, monkeypatch, address):
    monkeypatch.setattr("navsym.studies.cluster.SECONDS_TO_ANSWER", 1)
    config = tmp_path / "c.json"
    config.write_text('{"kind": "filter", "jobs": 2}')
    assert run(["sweep", str(config), "--scheduler", address, "--json"]) == 3
    assert json.loads(capsys.readouterr().out)["error"]["kind"] == "missing"
    clients = [thing for thing in gc.get_objects() if isinstance(thing, Client) and thing.status != "closed"]
    assert clients == []  # the garbage collector would close one while another starts, and both would wait for ever


def answer(server, word):
    """Say one word to whoever comes, and listen until he goes."""
    guest, _ = server.accept()
    with guest:
        guest.sendall(word)
        while guest.recv(4096):
            pass


WORDS = {"nothing": b"", "http": b"HTTP/1.1 400 Bad Request\r\n\r\n", "zeros": bytes(64)}


@pytest.mark.parametrize("word", WORDS.values(), ids=WORDS)
def test_who_answers_without_being_a_scheduler_is_not_waited_for(monkeypatch, word):
    monkeypatch.setattr("navsym.studies.cluster.SECONDS_TO_ANSWER", 1)
    with socket.create_server(("127.0.0.1", 0)) as server:
        Thread(target=answer, args=(server, word), daemon=True).start()
        with pytest.raises(MissingEngineError, match="scheduler"):
            greet(f"tcp://127.0.0.1:{server.getsockname()[1]}")


@pytest.mark.parametrize(
    "document",
    [
        {"kind": "filter"},
        {"kind": "other", "jobs": 3},
        {"kind": "filter", "jobs": 0},
        {"kind": "filter", "jobs": True},
        {"kind": "filter", "jobs": 2, "seed": -1},
        {"kind": "guaranteed", "jobs": 2, "start": "2", "end": "1"},
        {"kind": "guaranteed", "jobs": 2, "start": "1e9999999"},
        {"kind": "filter", "jobs": 2, "surplus": 1},
        {"kind": "phases", "jobs": 3, "columns": 2},
        {"kind": "phases", "jobs": 4, "columns": 2, "second_start": "0"},
        [1],
    ],
)
def test_a_configuration_that_is_none_is_refused(document):
    with pytest.raises(DomainError):
        sweep_from(document)
