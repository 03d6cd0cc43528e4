"""Equations between matrices of any size for Coq: multiplied out, modulo relations with the shares of a certificate."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from navsym import checker
from navsym.checker import Term, Typed
from navsym.export.coq.terms import Unwritten, defined, ranges, rename, write_term

#: What a declaration says of a matrix A; all that is not a word here only says more.
SAYS = {"orthogonal": ("{0} [*] turn {0} = unit", "turn {0} [*] {0} = unit"), "skew": ("turn {0} = (- 1) [.] {0}",)}
SAYS |= dict.fromkeys(("symmetric", "positive", "nonnegative", "diagonal"), ("turn {0} = {0}",))


class Asked(checker.Algebra):
    """What is answered, in order, where a statement has an inverse."""

    def __init__(self, statement: Any):
        super().__init__(statement)
        self.asked: list[Any] = []

    def invert(self, x: Typed, text: str) -> Typed:
        answer = super().invert(x, text)
        self.asked.append(answer.body)
        return answer


class Read(Asked, checker.Words):
    """Sums of words, as the checker has them."""


class Written(Asked):
    """Matrices as texts of ``words.v``, with hypotheses about the letters that stand in them."""

    def __init__(self, statement: Any):
        super().__init__(statement)
        self.texts = rename([*self.box, *statement["matrices"]])
        self.numbers = self.texts | {name: f"INR {self.texts[name]}" for name in self.dimensions}
        self.letters, self.inverses, self.says = dict[str, str](), dict[str, str](), dict[str, None]()
        self.sides: list[str] = []

    def write(self, term: Term) -> str:
        return f"({write_term(term, self.numbers)})"

    def make_letter(self, name: str, rows: Any, columns: Any, words: list[str]) -> str:
        text = self.texts.setdefault(name, name)
        self.letters[text] = f"mat {self.texts.get(rows, rows)} {self.texts.get(columns, columns)}"
        return text

    def declare(self, x: Typed, words: list[str]) -> None:
        self.says |= dict.fromkeys(said.format(x.body) for word in words for said in SAYS.get(word, ()))

    def make_body(self, is_unit: bool, rows: Any, columns: Any) -> str:
        return "unit" if is_unit else "zeros"

    def trace(self, body: Any, rows: Any) -> Term:
        raise Unwritten("a trace")

    def to_number(self, body: Any) -> Term:
        name = f"trace__{len(self.numbers)}"
        self.numbers[name] = f"number ({body})"
        return ("symbol", name)

    def add_bodies(self, x: Any, y: Any) -> str:
        return f"{x} [+] {y}"

    def scale_body(self, factor: Term, x: Any) -> str:
        return f"{self.write(factor)} [.] {enclose(x)}"

    def multiply_bodies(self, x: Any, y: Any) -> str:
        return f"{enclose(x, '[.]')} [*] {enclose(y)}"

    def transpose_body(self, x: Any) -> str:
        return f"turn {enclose(x)}"

    def invert_body(self, x: Any, rows: Any) -> str:
        """A letter whose products with the matrix are 1."""
        if x not in self.inverses:
            own = f"inv__{x}" if x.isidentifier() else f"inv__arg__text{len(self.inverses)}"
            self.inverses |= {x: own, own: x}
            self.make_letter(own, rows, rows, [])
            self.says |= {f"{enclose(x)} [*] {own} = unit": None, f"{own} [*] {enclose(x)} = unit": None}
        return self.inverses[x]

    def subtract(self, x: Any, y: Any) -> Any:
        self.sides = [side.body if isinstance(side, Typed) else self.write(side) for side in (x, y)]
        return super().subtract(x, y)

    def relate(self, x: Any) -> None:
        self.says[" = ".join(self.sides)] = None

    def write_sum(self, x: Mapping[Any, Term]) -> str:
        """A sum of words of the checker."""
        return " [+] ".join(f"{self.write(c)} [.] {self.write_word(word)}" for word, c in x.items()) or "zeros"

    def write_word(self, word: Any) -> str:
        """A product of letters; an inverse that the statement does not have is a letter of its own."""
        for name, _ in word:
            base = name.removeprefix("inv__")
            if name not in self.texts and base in self.texts:
                self.texts[name] = self.invert_body(self.texts[base], self.statement[4][base]["size"][0])
        letters = [f"turn {self.texts[name]}" if turned else self.texts[name] for name, turned in word]
        return f"({' [*] '.join(letters) or 'unit'})"

    def follow(self, algebra: Read) -> Iterator[str]:
        """Lines about letters of the checker's own for sums, and what their inverses are called."""
        found = {((f"inv__{name}", False),): name for _, name in algebra.arguments}
        for text, body in zip(self.asked, algebra.asked, strict=True):
            turned = [word[0][0] for word, c in body.items() if len(word) == 1 and word[0][1] and c == checker.ONE]
            if text in self.letters and turned and turned[0] in self.texts:
                yield f"assert ({text} = turn {self.texts[turned[0]]}) by turned_back; subst {text}."
            for name in (found.pop(word) for word, c in body.items() if word in found and c == checker.ONE):
                self.texts |= {name: name, f"inv__{name}": text}
                yield f"destruct (named _ _ ({self.inverses[text]})) as [{name} arg__E]."
                both = f"H : _ [*] {text} = _, K : {text} [*] _ = _"
                yield f"match goal with {both} |- _ => rewrite <- arg__E in H, K end."
                if name in algebra.symmetric:
                    yield f"assert (turn {name} = {name}) by (rewrite arg__E; words)."
                    yield f"assert (turn {text} = {text}) by (eapply turned_inverse; eassumption)."
                yield f"rename arg__E into {name}__E."


def enclose(text: str, *loose: str) -> str:
    """The text in parentheses, unless it is a letter or, on the left, a product of letters."""
    is_open = any(mark in text for mark in (" [+] ", "(", *loose)) if loose else " " in text
    return f"({text})" if is_open else text


def write_words(name: str, part: Mapping[str, Any]) -> str:
    """The theorem of an equation between matrices, and its script: the sides differ by a sum of relations."""
    statement, algebra, own = part["statement"], Read(part["statement"]), Written(part["statement"])
    algebra.state()
    relation, x = own.state()
    if relation != "=" or not isinstance(x, Typed):
        raise Unwritten("a number or an order of matrices of any size")
    claim, shares, facts = " = ".join(own.sides), list[str](), dict[str, str]()
    named = [*own.follow(algebra)]
    try:
        for share in part["shares"]:
            if share["word"] is not None:
                raise Unwritten("a trace")
            text = own.write_sum(algebra.relations[share["relation"]].body)
            facts.setdefault(f"({text})", f"S{len(facts)}")
            left, right = (own.write_word(algebra.read_word(share[side])) for side in ("left", "right"))
            shares.append(f"{own.write(checker.parse(share['coefficient']))} [.] ({left} [*] ({text}) [*] {right})")
    except KeyError as missing:
        raise Unwritten(f"the letter {missing}") from None
    names = {s: own.texts[s] for s in statement["symbols"]}
    needs = [*ranges({s: own.box[s] for s in names}, names), *defined(own.terms, own.numbers), *own.says]
    bound = [f"({' '.join(own.texts[d] for d in own.dimensions)} : nat)"] * bool(own.dimensions)
    bound += [f"({text} : R)" for text in names.values()] + [f"({a} : {mat})" for a, mat in own.letters.items()]
    lines = ["intros."]
    for a, b in own.inverses.items():
        if f"turn {a} = {a}" in own.says:
            lines.append(f"assert (turn {b} = {b}) by (eapply turned_inverse; eassumption).")
    lines += named + [f"assert ({fact} : {text[1:-1]} = zeros) by related." for text, fact in facts.items()]
    if shares:
        lines += [f"apply by_difference_0. transitivity ({' [+] '.join(shares)}); [words |]."]
        lines += [f"rewrite ?{fact}." for fact in facts.values()]
    printed = ", given ".join([f"{statement['left']} = {statement['right']}", *statement["given"]])
    known = [f"{a} {word}" for a, item in statement["matrices"].items() for word in item["is"]]
    says = f"forall {' '.join(bound)}, {''.join(f'{n} -> ' for n in needs)}{claim}"
    return "\n".join(
        [f"(* {'; '.join([printed, *known])} *)", f"Theorem {name} : {says}.", "Proof.", *lines, "words.", "Qed.", ""]
    )
