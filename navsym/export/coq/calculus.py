"""Derivatives and integrals for Coq: how they are written, and scripts that put what the checker has in their place.

``diff(f, x)`` is ``Derive (fun x => f) x``; ``dot_(f)`` is the derivative by a time in which all symbols move along
their rates; ``integral(f, x, a, b)`` is ``RInt (fun x => f) a b``, or ``RInt_gen`` to infinity; ``sum`` and
``product`` are ``sum_over`` and ``product_over`` of ``calculus.v``.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from navsym import checker
from navsym.checker import Question, Term, Value
from navsym.export.coq.scripts import prove_equality
from navsym.export.coq.terms import RELATIONS, RESERVED, Unwritten, subterms, write_term

Names = Mapping[str, str]
ENDS = {checker.INFINITY: "Rbar_locally p_infty", checker.negate(checker.INFINITY): "Rbar_locally m_infty"}

NEAR = {">": "positive", "!=": "nonzero"}


class Slope(tuple[Any, ...]):
    """A derivative as the checker has it, which remembers what it is the derivative of: by a symbol, or along rates."""

    of: Term
    by: str
    rates: Mapping[str, Term]

    def bind(self, names: Names) -> tuple[dict[str, str], str, str]:
        """Names inside of the function, its variable, and the place of the derivative."""
        others = " ".join(text for name, text in names.items() if name != self.by)
        place = names[self.by] if self.by else "0"
        word = place if place.isidentifier() else self.by or "time"
        while re.search(rf"\b{word}\b", others):
            word += "_"
        if self.by:
            return {**names, self.by: word}, word, place if place.isidentifier() else f"({place})"
        moved = {s: f"{names[s]} + {word} * ({write_term(rate, names)})" for s, rate in self.rates.items()}
        return {**names, **moved}, word, place

    def write(self, names: Names) -> str:
        """The derivative for Coq."""
        inner, word, place = self.bind(names)
        return f"Derive (fun {word} : R => {write_term(self.of, inner)}) {place}"

    def prove(self, names: Names) -> list[str]:
        """A proof that the derivative is what the checker has; those inside of the function are so nearby."""
        inner, word, place = self.bind(names)
        unfold = "unfold tanh, sinh, cosh; " * ("tanh" in str(self.of))
        within, last = [*list_slopes(self.of)], f"apply is_derive_unique; {unfold}derive."
        if not within:
            return [last]
        varies = {self.by} if self.by else set(self.rates)
        needs = checker.set_union(checker.conditions(t, checker.DIFFERENTIABLE) for s in within for t in (s.of, s))
        said = [(write_term(strip(t), inner), r) for r, t in needs if varies & checker.symbols_of(t)]
        near = "".join(f"{text} {RELATIONS[r]} 0 /\\ " for text, r in said) + "True"
        other = {name: re.sub(rf"\b{word}\b", f"{word}0", text) for name, text in inner.items()}
        return [
            f"transitivity (Derive (fun {word} : R => {write_term(strip(self.of), inner)}) {place}).",
            f"{{ apply Derive_ext_loc, (filter_imp (fun {word} : R => {near})).",
            *(f"{{ intros {word}0 ?; destruct_all.", *put_slopes(within, other), "reflexivity. }"),
            *(f"apply filter_and; [ near_{NEAR[r]} (fun {word} : R => {text}) |]." for text, r in said),
            "now apply filter_forall. }",
            last,
        ]


class Writer(checker.Reader):
    """The reader of the checker, which marks derivatives."""

    def __init__(self, *arguments: Any):
        super().__init__(*arguments)
        self.marked: list[Slope] = []

    def differentiate(self, x: Value, name: str) -> Value:
        """The derivative by a symbol or by time, entry by entry."""
        slopes = super().differentiate(x, name)
        by = "" if name == "t" and "t" in self.rates else name
        if by and by not in self.box:
            raise Unwritten("a derivative by what is no symbol of the statement")

        def mark(f: Term, slope: Term) -> Term:
            found = Slope(slope)
            rates = {} if by else self.slopes
            found.of, found.by = f, by
            found.rates = {s: rate for s, rate in rates.items() if rate and s in symbols_typed(f)}
            if not by and any(rates.get(s, checker.ZERO) is None for s in symbols_typed(f)):
                raise Unwritten("a derivative of what has no rate")
            self.marked += [found] * (not self.dead)
            return found

        return checker.change_entries(mark, x, slopes)

    def expect(self, term: Term) -> Term:
        """Refuse a moment: what the checker reads as a polynomial of moments has no words here."""
        raise Unwritten("an order or a moment, which the checker reads")


def list_slopes(*terms: Term) -> Iterator[Slope]:
    """The derivatives in terms, but for those inside of others."""
    for term in terms:
        if isinstance(term, Slope):
            yield term
        else:
            yield from list_slopes(*(part for part in term[1:] if isinstance(part, tuple)))


def list_all(*terms: Term) -> Iterator[Slope]:
    """The derivatives in terms, with those inside of others."""
    for slope in list_slopes(*terms):
        yield from (slope, *list_all(slope.of))


def symbols_typed(term: Term) -> set[str]:
    """The symbols that a term is written with: also those that the derivative as the checker has it is without."""
    inside = (t for slope in list_slopes(term) for t in (slope.of, *slope.rates.values()))
    return set(checker.symbols_of(term)).union(*map(symbols_typed, inside))


def strip(term: Term) -> Term:
    """A term as the checker has it."""
    return tuple(strip(part) if isinstance(part, tuple) else part for part in term)


def put_slopes(slopes: Iterable[Slope], names: Names) -> Iterator[str]:
    """Lines of a script that put what they are in the place of derivatives."""
    for text, slope in {slope.write(names): slope for slope in slopes}.items():
        yield f"assert (D : {text} = {write_term(strip(slope), names)})."
        yield from ("{", *slope.prove(names), "}", "try rewrite D in *; clear D.")


def name_questions(questions: Iterable[Question], names: dict[str, str]) -> dict[str, str]:
    """Names with what is asked: integrals, finite sums and products of functions without such."""
    for q in questions:
        is_open = q.kind not in ("integral", "sum", "product") or (q.kind != "integral" and q.high in ENDS)
        if is_open or q.within or any(map(checker.is_asked, q.list_terms())):
            raise Unwritten(f"{q.kind} of this kind")
        own = q.variable.rpartition("__")[0]
        while own in RESERVED or own in names.values():
            own += "_"
        finite = "at_point ({})" if {q.low, q.high} & set(ENDS) else "{}"
        ends = [ENDS.get(end) or finite.format(write_term(end, names)) for end in (q.low, q.high)]
        function = f"(fun {own} : R => {write_term(q.term, {**names, q.variable: own})})"
        word = f"{q.kind}_over" if q.kind != "integral" else "RInt_gen" if finite != "{}" else "RInt"
        names |= {q.value: f"{word} {function} ({ends[0]}) ({ends[1]})"}
    return names


def put_answer(q: Question, entry: Mapping[str, Any], value: Term, names: Names) -> Iterator[str]:
    """Lines of a script that put its value in the place of an integral, a sum or a product."""
    yield f"assert (D : {names[q.value]} = {write_term(value, names)})."
    yield from put_integral(q, entry, names) if q.kind == "integral" else put_sum(q, entry, names)
    yield "cbv beta. real_equation. }"
    start = "rewrite atan_0; " * (("atan", checker.ZERO) in subterms(value))
    yield f"try rewrite D in *; clear D; {start}as_real."


def put_sum(q: Question, entry: Mapping[str, Any], names: Names) -> Iterator[str]:
    """A sum by its telescoper: G(x + 1) = G(x) + f(x), or G(x) f(x) of a product."""
    G, x = checker.parse(entry["telescoper"]), q.variable
    inner, following = {**names, x: x}, checker.substitute(G, {x: ("+", ("symbol", x), checker.ONE)})
    step = ("+" if q.kind == "sum" else "*", G, q.term)
    yield f"{{ eapply eq_trans; [ eapply (by_{q.kind} (fun {x} : R => {write_term(G, inner)})) |]; cbv beta."
    yield f"{{ whole. }}\n{{ lra. }}\n{{ intros {x} ? ?."
    yield from (*prove_equality((following, step), inner), "}", *["{ nonzero. }"] * (q.kind == "product"))


def put_integral(q: Question, entry: Mapping[str, Any], names: Names) -> Iterator[str]:
    """An integral by the difference of its antiderivative."""
    texts = {piece["antiderivative"] for piece in entry["pieces"]}
    if len(texts) > 1 or any(piece["equal"] is not None for piece in entry["pieces"]):
        raise Unwritten("an integral in pieces")
    F, x = checker.parse(texts.pop()), q.variable
    inner, slope, rule = {**names, x: x}, checker.differentiate(F, x), "antiderivative"
    function = f"(fun {x} : R => {write_term(F, inner)})"
    limits, intro = "", f"intros {x} X; try rewrite Rmin_left, Rmax_right in X by side"
    if {q.low, q.high} & set(ENDS):
        rule, intro = "limits", f"intros {x}"
        limits = "".join("apply at_place. " if end not in ENDS else "to_limit. " for end in (q.low, q.high))
    goal = f"(fun y : R => is_derive {function} {x} y)"
    equal = f"refine (@eq_ind R ({write_term(slope, inner)}) {goal} _ ({write_term(q.term, inner)}) _)."
    yield f"{{ eapply eq_trans; [ eapply (by_{rule} {function}) |]; try typeclasses eauto; cbv beta."
    yield from (f"{{ {intro}. {equal} derive.", *prove_equality((slope, q.term), inner), "}")
    yield f"{{ {intro}. has_slope. }}"
    yield limits
