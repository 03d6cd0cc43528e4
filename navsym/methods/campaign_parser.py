"""Damaged files and random bytes for the readers: a value or a NavsymError, whatever comes, and soon.

Honest files are cut, spliced and sprinkled with the pieces that parsers trip over.
"""

from __future__ import annotations

import random
import time
from collections import Counter
from collections.abc import Callable
from typing import Any

from navsym.errors import NavsymError
from navsym.methods.campaign import Batch, Result, result
from navsym.text.claimfile import claims_from
from navsym.text.expression import parse, symbol
from navsym.text.jsonfile import parse_json
from navsym.text.modelfile import model_from
from navsym.text.tomlfile import parse_toml

BATCH = 2000
SLOW = 1.0  # seconds of processor time for one input
SYMBOLS = {name: symbol(name) for name in ("x", "T", "w", "t")}
EXPRESSION = b"cos(T/2)/sin(T/4)**2 - sqrt(x*(1 + 0.25e-1))*atan2(x, -pi) + abs(log(x**2)/tan(T))"
MODEL = b"""[model]
name = "m"
states = ["x", "v"]
F = [["0", "w**2"], ["-1/w", "1/2"]]
[parameters]
w = ["1/2", "2"]
[[measurement]]
name = "position"
h = ["1", "sin(w*t)"]
sigma = "1"
[interval]
T = "pi/2"
"""
CLAIMS = b"""[symbols]
a = "real"
T = ["0", "2*pi"]
[[claim]]
id = "one"
left = "sin(2*a)/T"
right = "2*cos(a)"
relation = "<="
"""
BANK = b'{"models": [{"F": [[1.0, 2e3], [0, -1]], "Q": null}], "memoryless": true}'

Reader = Callable[[bytes], Any]
READERS: dict[str, tuple[Reader, bytes]] = {
    "expression": (lambda data: parse(data.decode("latin-1"), SYMBOLS, where="f"), EXPRESSION),
    "model": (lambda data: model_from(parse_toml(data, "f"), "f"), MODEL),
    "claims": (lambda data: claims_from(parse_toml(data, "f"), "f"), CLAIMS),
    "json": (lambda data: parse_json(data, "f"), BANK),
}
PIECES = (
    *(bytes([byte]) for byte in b"\"'[]{}()=,.-+*/#\\\n\r\0 _^09twe"),
    b"**", b"[[", b"]]", b"1e999", b"nan", b"inf", b"true", b"null", b"\xff", b"\xd1\x85", b"\xe2\x80\xae", b"pi",
    b"sin(", b"sqrt(", b"log(", b"1/0", b"9**9**9", b"**-1", b"__import__('os')", b"lambda:0", b'"""', b"\\ud800",
    b"NaN", b"Infinity", b"\xef\xbb\xbf", b"((((((((", b"- - - -", b"0x10", b"1_0", b"[model]\n", b"[[claim]]\n",
)  # fmt: skip


def batches(inputs: int, seed: int = 0) -> list[Batch]:
    """``inputs`` damaged files in batches, the readers in turn."""
    count = max(1, -(-inputs // BATCH))
    sizes = [BATCH] * (count - 1) + [inputs - BATCH * (count - 1)]
    readers = list(READERS)
    return [
        Batch(f"{seed} {k} {size}", (readers[k % len(readers)], size, seed * 10**6 + k))
        for k, size in enumerate(sizes)
    ]


def judge(task: tuple[str, int, int]) -> Result:
    """Counts: read, refused; wrong: another exception than a NavsymError, or more than a second."""
    reader, size, seed = task
    read, honest = READERS[reader]
    source = random.Random(seed)
    counts: Counter[str] = Counter()
    wrong: list[Any] = []
    slowest = 0.0
    for _ in range(size):
        data = damaged(honest, source)
        before = time.process_time()
        outcome = answer(read, data)
        spent = time.process_time() - before
        slowest = max(slowest, spent)
        counts[outcome if outcome in ("read", "refused") else "crashed"] += 1
        if outcome not in ("read", "refused") or spent > SLOW:
            wrong.append(
                {"reader": reader, "data": data.decode("latin-1"), "why": f"{outcome}, {spent:.3f} s"}
            )
    return result(counts, wrong, [], [{"reader": reader, "slowest": round(slowest, 4)}])


def answer(read: Reader, data: bytes) -> str:
    try:
        read(data)
    except NavsymError:
        return "refused"
    except Exception as error:
        return f"{type(error).__name__}: {error}"
    return "read"


def damaged(honest: bytes, source: random.Random) -> bytes:
    """One to four cuts, each filled with an awkward piece; one time in twenty nothing but random bytes."""
    if source.random() < 0.05:
        return source.randbytes(source.randint(0, 60))
    data = honest
    for _ in range(source.randint(1, 4)):
        at, width = source.randint(0, len(data)), source.choice([0, 0, 1, 2, 5, 12])
        piece = source.choice(PIECES) if source.random() < 0.9 else source.randbytes(3)
        data = data[:at] + piece + data[at + width :]
    return data
