"""Damaged files and random bytes for every reader: a value or a NavsymError, whatever comes, and soon.

Honest files are cut, spliced and sprinkled with the pieces that parsers trip over, and there are files made
to exhaust or mislead (:data:`BOMBS`). Thousands are read in one process, so that a million take minutes.
"""

from __future__ import annotations

import random
import re
import resource
import shutil
import struct
import time
from collections import Counter
from collections.abc import Iterable
from typing import Any

from navsym.core.errors import MissingEngineError, NavsymError
from tests.attacks.campaigns.batches import Batch, Result, deal, result
from tests.attacks.campaigns.readers import BOMBS, READERS, Reader, scratch

BATCH = 2000
SLOW = 1.0  # seconds of processor time for one input
MEGABYTES = 2048  # that one input may add to the memory of its process

PIECES = (
    *(bytes([byte]) for byte in b"\"'[]{}()=,.-+*/#\\\n\r\0 _^09twe"),
    b"**",
    b"[[",
    b"]]",
    b"1e999",
    b"nan",
    b"inf",
    b"true",
    b"null",
    b"\xff",
    b"\xd1\x85",
    b"\xe2\x80\xae",
    b"pi",
    b"sin(",
    b"sqrt(",
    b"log(",
    b"1/0",
    b"9**9**9",
    b"**-1",
    b"__import__('os')",
    b"lambda:0",
    b'"""',
    b"\\ud800",
    b"NaN",
    b"Infinity",
    b"\xef\xbb\xbf",
    b"((((((((",
    b"- - - -",
    b"0x10",
    b"1_0",
    b"[model]\n",
    b"[[claim]]\n",
    b"PK\x03\x04",
    b"PK\x05\x06",
    b"\x93NUMPY",
    b"|O",
    b"II*\0",
    b",,,",
    b";",
    b"\t",
    b"99999999999999999999",
    *(struct.pack("<I", n) for n in (0, 1, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF)),
)

TOKEN = re.compile(rb"[0-9]+(?:\.[0-9]+)?|[A-Za-z_]+|\*\*|[-+*/<>=]+")
NUMBERS = (
    b"0",
    b"-1",
    b"0.5",
    b"1e300",
    b"-1e-300",
    b"1/0",
    b"3/7",
    b"2**62",
    b"90",
    b"-90.0001",
    b"360",
    b"1e999",
    b"65536",
    b"-0",
    b"nan",
    b"1e9",
    b"true",
    b"null",
    b'"1"',
    b"[]",
    b"{}",
    b"[[1]]",
    b"pi",
    b"sqrt(2)",
)


def make_batches(inputs: int, seed: int = 0) -> list[Batch]:
    """``inputs`` damaged files in batches, the readers in turn; then the files made to exhaust."""
    return [*deal(list(READERS), inputs, BATCH, seed), Batch("bombs", ("bombs", len(BOMBS), 0))]


def judge(task: tuple[str, int, int]) -> Result:
    """Counts: read, refused, missing; wrong: another exception than a NavsymError, more than a second or 2 GB."""
    reader, size, seed = task
    source = random.Random(seed)
    if reader == "bombs":
        inputs = ((name, make()) for name, make in BOMBS.values())
    else:
        answer(*READERS[reader])  # what is loaded or compiled at the first call is not the file's doing
        inputs = ((reader, damage(READERS[reader][1], source)) for _ in range(size))
    try:
        return count_outcomes(reader, inputs)
    finally:
        shutil.rmtree(scratch())


def count_outcomes(reader: str, inputs: Iterable[tuple[str, bytes]]) -> Result:
    """The record of one batch: what the readers named beside the inputs make of them."""
    counts: Counter[str] = Counter()
    wrong: list[Any] = []
    slowest = 0.0
    for name, data in inputs:
        memory = peak()
        outcome, spent = time_fairly(READERS[name][0], data)
        grown = peak() - memory
        slowest = max(slowest, spent)
        counts[outcome if outcome in OUTCOMES else "crashed"] += 1
        if outcome not in OUTCOMES or spent > SLOW or grown > MEGABYTES:
            why = f"{outcome}, {spent:.3f} s, {grown:.0f} MB more"
            wrong.append({"reader": name, "data": data[:2000].decode("latin-1"), "why": why})
    return result(counts, wrong, kept=[{"reader": reader, "slowest": round(slowest, 4), "peak": round(peak())}])


def time_fairly(reader: Reader, data: bytes) -> tuple[str, float]:
    """As :func:`time_reading`, what seemed slow once more: on a shared core time goes to others too."""
    outcome, spent = time_reading(reader, data)
    return outcome, min(spent, time_reading(reader, data)[1]) if spent > SLOW else spent


def time_reading(reader: Reader, data: bytes) -> tuple[str, float]:
    """The answer of a reader and its seconds of processor time."""
    before = time.process_time()
    return answer(reader, data), time.process_time() - before


OUTCOMES = ("read", "refused", "missing")


def peak() -> float:
    """Largest memory of this process so far, in megabytes."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def answer(read: Reader, data: bytes) -> str:
    """The reader's answer to bytes.

    One of ``read``, ``refused`` (by a NavsymError), ``missing`` (an engine that is not installed), or the name and
    text of another exception.
    """
    try:
        read(data)
    except MissingEngineError:
        return "missing"
    except NavsymError:
        return "refused"
    except Exception as error:
        return f"{type(error).__name__}: {error}"
    return "read"


def damage(honest: bytes, source: random.Random) -> bytes:
    """Tokens exchanged, which reaches deep; or pieces cut and spliced in; or nothing but random bytes."""
    choice = source.random()
    if choice < 0.05:
        return source.randbytes(source.randint(0, 60))
    return exchange_tokens(honest, source) if choice < 0.5 else splice(honest, source)


def splice(data: bytes, source: random.Random) -> bytes:
    """One to four cuts, each filled with an awkward piece."""
    for _ in range(source.randint(1, 4)):
        at, width = source.randint(0, len(data)), source.choice([0, 0, 1, 2, 5, 12])
        piece = source.choice(PIECES) if source.random() < 0.9 else source.randbytes(3)
        data = data[:at] + piece + data[at + width :]
    return data


def exchange_tokens(data: bytes, source: random.Random) -> bytes:
    """One or two numbers or words replaced by others of the same file or by awkward ones, or left out."""
    tokens = [(match.start(), match.end()) for match in TOKEN.finditer(data)]
    for start, end in sorted(source.sample(tokens, min(len(tokens), source.randint(1, 2))), reverse=True):
        other = source.choice(tokens)
        new = source.choice((data[slice(*other)], source.choice(NUMBERS), b"", data[start:end] * 2))
        data = data[:start] + new + data[end:]
    return data
