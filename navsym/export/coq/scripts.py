"""Scripts of Coq: an identity by ``field`` modulo ``s^2 = 1 - c^2`` and ``r r = e``, a bound by ``interval``."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from math import isqrt, lcm
from typing import Any

from flint import fmpq, fmpq_mpoly, fmpq_mpoly_ctx

from navsym import checker
from navsym.checker import Range, Term
from navsym.export.coq.terms import Unwritten, defined, ranges, subterms, write_term

#: Fractions of pi whose sine and cosine are rules of the library, by the denominator.
OF_PI = {k: (f"sin_PI{k if k > 1 else ''}", f"cos_PI{k if k > 1 else ''}") for k in (1, 2, 3, 4, 6)}
#: Multiples of one angle that a script is written for.
MOST_TURNS = 24
#: Functions that become others, as the checker has them or without a sum below a line that is not seen to be positive.
MEANINGS = {"tan": "sin(x)/cos(x)", "sinh": "(exp(x) - exp(-x))/2", "cosh": "(exp(x) + exp(-x))/2"}
MEANINGS |= {"tanh": "(exp(x) - exp(-x))/(exp(x) + exp(-x))"}
#: Precision in bits and depth that ``interval`` is given, and seconds for one try.
BITS, DEPTH, PATIENCE = 60, 20, 20


@dataclass
class Script:
    """Lines of a proof; what subterms have become in the goal; rules that ``field`` may use."""

    names: Mapping[str, str]
    lines: list[str] = field(default_factory=list)
    now: dict[Term, str] = field(default_factory=dict)
    rules: list[str] = field(default_factory=list)

    def write(self, term: Term) -> str:
        """The term as the goal has it now."""
        return write_term(term, self.names, self.now)

    def rewrite(self, term: Term, new: str, proof: str) -> None:
        """Prove that a part of the goal is equal to a new text, and put that in its place."""
        old = self.write(term)
        if old != new:
            self.replace(old, new, proof)
            self.now[term] = new

    def replace(self, old: str, new: str, proof: str) -> None:
        """Prove that two texts are equal, and put the new one in the place of the old one."""
        name = f"E{len(self.lines)}"
        self.lines.append(f"assert ({name} : {old} = {new}) by ({proof}).")
        self.lines.append(f"try rewrite {name} in *; clear {name}.")

    def know(self, fact: str, proof: str) -> None:
        """Prove a rule for ``field``."""
        name = f"F{len(self.rules)}"
        self.lines.append(f"assert ({name} : {fact}) by ({proof}).")
        self.rules.append(name)


def prove_equality(terms: Iterable[Term], names: Mapping[str, str]) -> list[str]:
    """Functions of sums become those of single angles, logarithms and roots; ``field`` does the rest."""
    script = Script(names)
    parts = [*dict.fromkeys(part for term in terms for part in subterms(term))]
    for part in [*parts]:
        if part[0] in MEANINGS:
            meaning = checker.replace(checker.parse(MEANINGS[part[0]]), ("symbol", "x"), part[1])
            script.rewrite(part, script.write(meaning), "by_meaning")
            parts += [p for p in subterms(meaning) if p not in parts]
    write_angles([p for p in parts if p[0] in ("sin", "cos", "tan", "cot", "sec", "csc")], script)
    write_exponentials([p for p in parts if p[0] == "exp"], script)
    write_roots([p for p in parts if is_square_root(p)], script)
    write_absolutes([p for p in parts if p[0] == "abs"], script)
    write_logarithms([p for p in parts if p[0] == "log"], script)
    rules = f" [{' '.join(script.rules)}]" if script.rules else ""
    rewrites = "".join(f"rewrite ?{rule}; " for rule in script.rules)
    ways = [f"ring{rules}", f"timeout {PATIENCE} (field{rules}); nonzero"]
    ways += [f"progress same_denominators; ring{rules}", f"field{rules}; nonzero"]
    ways += [f"{rewrites}field; nonzero", f"field_simplify{rules}; first [ field; nonzero | nonzero ]"]
    ways += [f"whole_roots; field{rules}; nonzero"] if rules else []
    ways += ["by_signs"] if any(part[0] == "abs" for part in parts) else []
    inverse = "rewrite ?exp_plus, ?exp_Ropp, !exp_ln by positive; field; nonzero"
    ways += [inverse] if any(part[0] == "exp" and "'log'" in str(part) for part in parts) else []
    return [*script.lines, f"first [ {' | '.join(f'solve [{way}]' for way in ways)} ]."]


def prove_modulo(proof: Mapping[str, Any], zeros: Iterable[Term], term: Term, names: Mapping[str, str]) -> list[str]:
    """f = g + sum c_k h_k with the cofactors of a certificate, where hypotheses say h_k = 0; then g = 0."""
    rest, shares = checker.parse(proof["to"]), map(checker.parse, proof["cofactors"])
    products = [("*", c, h) for c, h in zip(shares, zeros, strict=True) if c != checker.ZERO]
    total = checker.make_sum(rest, *products)
    lines = [f"transitivity ({write_term(total, names)}).", "{", *prove_equality((term, total), names), "}"]
    lines += ["repeat match goal with Z : ?h = 0 |- _ => rewrite ?Z; clear Z end."]
    return lines + prove_equality((rest,), names)


def is_square_root(part: Term) -> bool:
    """A square root, or a power of one."""
    if part[0] == "sqrt":
        return True
    q = checker.constant_of(part[2]) if part[0] == "^" else None
    return q is not None and q.q == 2


Angle = dict[tuple[str, bool], fmpq]


def split_angle(term: Term, script: Script) -> Angle:
    """An argument as a sum of rational multiples of texts; pi is marked."""
    generators = [*dict.fromkeys(checker.list_generators(term))]
    ring = fmpq_mpoly_ctx.get([f"x{k}" for k in range(len(generators))] or ["x0"])
    top, bottom = checker.to_quotient(term, dict(zip(generators, ring.gens(), strict=False)), ring)
    if bottom == 0:
        raise Unwritten("a division by zero")
    common = top.gcd(bottom) if top != 0 else bottom
    top, bottom = top / common, bottom / common
    scale = bottom.leading_coefficient()
    top, bottom = top / scale, bottom / scale
    texts = [script.write(g) for g in generators]
    below = "" if bottom == 1 else f" / ({write_polynomial(bottom, texts)})"
    found: Angle = {}
    for exponents, coefficient in top.terms():
        monomial = write_monomial(exponents, texts)
        found[monomial + below, monomial + below == "PI"] = coefficient
    return found


def write_monomial(exponents: Iterable[int], texts: list[str]) -> str:
    """A product of powers."""
    powers = [
        (f"({t})" if not t.isalnum() else t) + (f" ^ {e}" if e > 1 else "")
        for t, e in zip(texts, map(int, exponents), strict=False)
        if e
    ]
    return " * ".join(powers) or "1"


def write_polynomial(polynomial: fmpq_mpoly, texts: list[str]) -> str:
    """A polynomial in given texts."""
    parts = []
    for exponents, q in polynomial.terms():
        coefficient = write_term(("number", q), {})
        parts.append(f"({coefficient}) * {write_monomial(exponents, texts)}")
    return " + ".join(parts) or "0"


def find_bases(angles: Iterable[Angle]) -> dict[tuple[str, bool], int]:
    """For each text the denominator of its multiples."""
    found: dict[tuple[str, bool], int] = {}
    for angle in angles:
        for key, q in angle.items():
            found[key] = lcm(found.get(key, 1), int(q.q))
    return found


def write_angles(parts: list[Term], script: Script) -> None:
    """Sines and cosines as polynomials in those of single angles, by the theorems of addition."""
    angles = {part[1]: split_angle(part[1], script) for part in parts}
    bases = find_bases(angles.values())
    keys = [*bases]
    ring = fmpq_mpoly_ctx.get([f"x{k}" for k in range(2 * len(keys))] or ["x0"])
    units = [write_unit(key, bases[key]) for key in keys]
    texts = [t for unit in units for t in (f"cos ({unit})", f"sin ({unit})")]
    used = set()
    for argument, angle in angles.items():
        turns = {keys.index(key): int(q * bases[key]) for key, q in angle.items()}
        if sum(map(abs, turns.values())) > MOST_TURNS:
            raise Unwritten("a large multiple of an angle")
        used |= set(turns)
        cosine, sine = ring.constant(1), ring.constant(0)
        for k, turn in turns.items():
            c, s = ring.gens()[2 * k], ring.gens()[2 * k + 1] * (1 if turn > 0 else -1)
            for _ in range(abs(turn)):
                cosine, sine = cosine * c - sine * s, sine * c + cosine * s
        total = write_sum({units[k]: turn for k, turn in turns.items()})
        for name, value in (("sin", sine), ("cos", cosine)):
            old, new = f"{name} ({script.write(argument)})", write_polynomial(value, texts)
            if total != f"({script.write(argument)})":
                proof = f"transitivity ({name} ({total})); [ f_equal; field; nonzero | by_addition ]"
                script.replace(old, new, proof)
                script.now[name, argument] = new
    for k in sorted(used):
        if keys[k][1] and bases[keys[k]] in OF_PI:
            script.lines += [f"try rewrite {rule} in *." for rule in (*OF_PI[bases[keys[k]]], "half_root")]
            square = {3: 3, 4: 2, 6: 3}.get(bases[keys[k]])
            if square:
                script.know(f"sqrt {square} ^ 2 = {square}", "square_of_root")
        elif keys[k][1]:
            raise Unwritten("a fraction of pi without a rule")
        else:
            fact = f"sin ({units[k]}) ^ 2 = 1 - cos ({units[k]}) ^ 2"
            script.know(fact, f"generalize (sin2_cos2 ({units[k]})); unfold Rsqr; intro; nra")


def write_unit(key: tuple[str, bool], denominator: int) -> str:
    """The angle of which others are multiples, as the rules about pi have it."""
    text = key[0]
    return text if denominator == 1 else f"{text} / {denominator}"


def write_sum(turns: Mapping[str, int]) -> str:
    """A sum of texts, each repeated or subtracted."""
    return " + ".join(f"({u})" if n > 0 else f"- ({u})" for u, n in turns.items() for _ in range(abs(n))) or "0"


def write_exponentials(parts: list[Term], script: Script) -> None:
    """Exponentials as products of powers of single ones."""
    arguments = {part: split_angle(part[1], script) for part in parts}
    bases = find_bases(arguments.values())
    for part, argument in arguments.items():
        turns = {key: int(q * bases[key]) for key, q in argument.items()}
        if sum(map(abs, turns.values())) > MOST_TURNS:
            raise Unwritten("a large multiple of an exponent")
        units = {write_unit(key, bases[key]): turn for key, turn in turns.items()}
        powers = [f"exp ({u}) ^ {n}" if n > 0 else f"/ (exp ({u}) ^ {-n})" for u, n in units.items()]
        new = " * ".join(powers) or "1"
        proof = f"transitivity (exp ({write_sum(units)})); [ f_equal; field; nonzero | by_multiplication ]"
        script.rewrite(part, new, proof)


def write_roots(parts: list[Term], script: Script) -> None:
    """Each square root with its square, and square roots of numbers by that of a number without squares."""
    known = set()
    for part in parts:
        base = part[1]
        text = script.write(base)
        if text in known:
            continue
        known.add(text)
        q = checker.constant_of(base)
        if q is not None and q > 0 and q != 1:
            factor, primes = split_root(q)
            before = len(script.rules)
            for prime in primes:
                script.know(f"sqrt ({prime}) ^ 2 = {prime}", "square_of_root")
            if (factor, len(primes)) != (1, 1):
                roots = " * ".join([f"({write_term(('number', factor), {})})", *(f"sqrt ({p})" for p in primes)])
                rules = f" [{' '.join(script.rules[before:])}]" if primes else ""
                script.replace(f"sqrt ({text})", roots, f"root_of ltac:(field{rules})")
            continue
        script.know(f"sqrt ({text}) ^ 2 = {text}", "square_of_root")


def write_absolutes(parts: list[Term], script: Script) -> None:
    """Absolute values of numbers, and the squares of others."""
    for part in parts:
        text, q = script.write(part[1]), checker.constant_of(part[1])
        if q is None:
            script.know(f"Rabs ({text}) ^ 2 = ({text}) ^ 2", "apply pow2_abs")
        else:
            script.rewrite(part, write_term(("number", abs(q)), {}), "unfold Rabs; destruct Rcase_abs; lra")


def write_logarithms(parts: list[Term], script: Script) -> None:
    """Logarithms of products and quotients by those of their factors, where these are seen to be positive."""
    for part in parts:
        generators = sorted({*checker.list_generators(part[1])}, key=script.write)
        ring = fmpq_mpoly_ctx.get([f"x{k}" for k in range(len(generators))] or ["x0"])
        fraction = checker.to_quotient(part[1], dict(zip(generators, ring.gens(), strict=False)), ring)
        if 0 in fraction:
            continue
        texts, sums, scale = [script.write(g) for g in generators], list[str](), fmpq(1)
        for sign, (number, factors) in zip((1, -1), (side.factor() for side in fraction), strict=True):
            for factor, power in factors:
                own = factor if factor.coeffs()[-1] > 0 else factor * -1
                sums += [f"{'' if sign > 0 else '- '}ln ({write_polynomial(own, texts)})"] * power
                number *= 1 if own == factor else (-1) ** power
            scale *= number**sign
        if scale > 0 and len(sums) <= MOST_TURNS:
            sums += [f"ln ({write_term(('number', scale), {})})"] * (scale != 1)
            old, new = f"ln ({script.write(part[1])})", " + ".join(sums) or "0"
            script.lines.append(f"try (assert (E : {old} = {new}) by by_logarithms; rewrite E; clear E).")


def split_root(q: fmpq) -> tuple[fmpq, list[int]]:
    """f and primes p with sqrt(q) = f times the product of all sqrt(p); what has no small factor stands as a prime."""
    n, d, primes, times = int(q.p) * int(q.q), 2, list[int](), 1
    while d * d <= min(n, 10**6):
        while n % (d * d) == 0:
            n, times = n // (d * d), times * d
        if n % d == 0:
            n, primes = n // d, [*primes, d]
        d += 1
    root = isqrt(n)
    whole, rest = (root, []) if root * root == n else (1, [n])
    return fmpq(times * whole, q.q), primes + rest


def prove_bound(box: Mapping[str, Range], names: Mapping[str, str], by_balls: bool) -> list[str]:
    """A bound on a box by bisection and Taylor models; a symbol with one value is that value."""
    wide = [names[name] for name, limit in box.items() if limit.low is None or limit.low != limit.high]
    cut = "".join(f", i_bisect {name}" for name in wide)
    tries = [f"i_prec {BITS}, i_depth {DEPTH}{cut}"]
    tries += [f"i_prec {BITS}, i_depth {DEPTH}, i_taylor {name}{cut}" for name in wide][:2]
    balls = [f"timeout {PATIENCE} by_difference ltac:(interval with ({options}))" for options in tries]
    ways = ["solve [ positive ]", "timeout 3 nra", "by_distances"]
    ways = ["lra", *(balls + ways if by_balls else ways + balls), f"timeout {PATIENCE} nra"]
    ways += ["by_signs", "by_roots", "by_falling"]
    return ["put_values.", f"first [ {' | '.join(ways)} ]."]


@dataclass(frozen=True)
class Follower:
    """Scripts along a certificate's proof: other forms and factors are as it has them; the rest is left to Coq."""

    box: Mapping[str, Range]
    names: Mapping[str, str]

    def prove(self, proof: Mapping[str, Any], term: Term, relation: str) -> list[str]:
        """The goal of a theorem, which says the relation of the term to 0 in some form."""
        proof = factor_roots(proof, term)
        if relation == "=" or proof.get("rule") not in ("equal", "product", "rewrite", "side", "sum"):
            return self.go(proof, term, relation)
        said = self.say(term, relation)
        return [f"enough (G : {said}) by (first [ lra | intro; apply G; lra ]).", *self.go(proof, term, relation)]

    def say(self, term: Term, relation: str) -> str:
        """The relation of a term to 0, as the lemmas have it."""
        text = write_term(term, self.names)
        return f"{text} <> 0" if relation == "!=" else f"0 {'<' if relation == '>' else '<='} {text}"

    def change(self, old: Term, new: Term, proof: Iterable[str]) -> list[str]:
        """Lines that put a term in the place of one that is equal to it."""
        equal = f"assert (E : {write_term(old, self.names)} = {write_term(new, self.names)})."
        return [equal, "{", *proof, "}", "rewrite E; clear E."]

    def go(self, proof: Mapping[str, Any], term: Term, relation: str) -> list[str]:
        """The goal in the lemmas' form, or an equation."""
        proof = factor_roots(proof, term)
        rule = proof.get("rule")
        own = proof["equal"] if rule == "rewrite" else proof
        if own.get("rule") == "solve":
            texts = (proof["from"], proof["to"]) if rule == "rewrite" else (own["atom"], own["value"])
            old, new = map(checker.parse, texts)
            if old[0] in ("abs", "sqrt"):
                roots = [part for part in subterms(term) if part[0] == old[0]]
                old = next((p for p in roots if checker.is_identity(checker.subtract(p[1], old[1]))), old)
                square = ["{", *prove_equality((new, old[1]), self.names), "}"]
                lines = [f"apply {old[0]}_by_square.", *square, *self.go(own["proofs"][1], new, ">=")]
                rest = self.go(proof.get("proof", {}), checker.replace(term, old, new), relation)
                return [*self.change(old, new, lines), *rest]
        if relation == "=":
            return prove_equality((term,), self.names)
        if rule == "equal":
            new = proof["to"] if isinstance(proof["to"], tuple) else checker.parse(proof["to"])
            lines = self.change(term, new, prove_equality((term, new), self.names))
            return [*lines, *self.go(proof["proof"], new, relation)]
        if rule == "side":
            one = term if proof["sign"] == 1 else checker.negate(term)
            return [f"enough ({self.say(one, '>')}) by lra.", *self.go(proof["proof"], one, ">")]
        if rule == "sum":
            parts = enumerate(zip(proof["proofs"], checker.list_terms(term), strict=True))
            return [*self.know(*((*p, relation if k == proof["strict"] else ">=") for k, p in parts)), "lra."]
        own = complete_square(term) if rule == "cones" else proof
        if own and own.get("rule") in ("squares", "quadratic"):
            return self.square(own, relation)
        if rule == "split":
            x, place = proof["symbol"], checker.parse(proof["at"])
            lines = [f"destruct (Rle_or_lt {self.names[x]} ({write_term(place, self.names)}))."]
            halves = self.box[x]._replace(high=place, open_high=False), self.box[x]._replace(low=place, open_low=False)
            for half, part in zip(halves, proof["proofs"], strict=True):
                lines += ["{", *Follower({**self.box, x: half}, self.names).go(part, term, relation), "}"]
            return lines
        if rule == "slope" and not (relation == ">" and proof["strict"]):
            return self.climb(proof, term, relation)
        if rule == "bounded":
            waves = dict.fromkeys(part for part in subterms(term) if part[0] in ("sin", "cos"))
            bounds = [f"pose proof ({f.upper()}_bound ({write_term(x, self.names)}))." for f, x in waves]
            return [*bounds, *prove_bound(self.box, self.names, by_balls=False)]
        if rule == "identity":
            return ["apply Req_le_sym.", *prove_equality((term,), self.names)]
        if rule == "product":
            return self.split(proof["factors"], checker.list_factors(term), term, relation)
        return prove_bound(self.box, self.names, rule == "balls")

    def know(self, *premises: tuple[Any, Term, str]) -> list[str]:
        """Lines that prove premises one after the other."""
        said = ((self.say(term, sign), self.go(proof, term, sign)) for proof, term, sign in premises)
        return [line for fact, proof in said for line in (f"assert ({fact}).", "{", *proof, "}")]

    def square(self, proof: Mapping[str, Any], relation: str) -> list[str]:
        """L >= |R| by L^2 >= R^2, or A v^2 + B v + C >= 0 by 4 A C >= B^2."""
        if proof["rule"] == "squares":
            x, y = parts = [checker.parse(proof[side]) for side in ("left", "right")]
            premises = [(checker.subtract(("*", x, x), ("*", y, y)), relation), (x, ">=")]
        else:
            a, b, c = parts = [t if isinstance(t, tuple) else checker.parse(t) for t in proof["coefficients"]]
            rest = checker.subtract(("*", checker.number(4), a, c), ("*", b, b))
            premises, parts = [(a, ">="), (c, ">="), (rest, relation)], [*parts, ("symbol", proof["symbol"])]
        lines = self.know(*((own, *said) for own, said in zip(proof["proofs"], premises, strict=True) if own))
        texts = " ".join(f"({write_term(part, self.names)})" for part in parts)
        sides = " ".join(["ltac:(intros; lra)"] * len(premises))
        lemma = f"{proof['rule']}_{'above' if relation == '>' else 'not_below'}"
        return [*lines, f"assert (Q := {lemma} {texts} {sides}).", "first [ lra | by_fraction Q ]."]

    def climb(self, proof: Mapping[str, Any], term: Term, relation: str) -> list[str]:
        """A function by its value at an end of the range of a symbol, from which it does not fall."""
        x, is_high, box = proof["symbol"], proof["end"] == 1, dict[str, Any](self.box)
        closed = {"open_high" if is_high else "open_low": False, "nonzero": False, "integer": False}
        limit, u, slope = box[x]._replace(**closed), f"{self.names[x]}_", checker.differentiate(term, x)
        end, change = (limit.high, checker.negate(slope)) if is_high else (limit.low, slope)
        start, inner = checker.replace(term, ("symbol", x), end), Follower(self.box, {**self.names, x: u})
        f, g = (f"(fun {u} : R => {write_term(t, inner.names)})" for t in (term, slope))
        facts = [f"assert ({fact}) by lra." for fact in ranges({x: limit}, inner.names)]
        facts += [f"try assert ({fact}) by side." for fact in defined([slope], inner.names)]
        (first, last), place = ("right", "left") if is_high else ("left", "right"), write_term(end, self.names)
        way = f"({place}) - {self.names[x]}" if is_high else f"{self.names[x]} - ({place})"
        return [
            *(f"assert ({self.say(start, relation)}).", "{", "rewrite ?ln_1, ?atan_0."),
            *(*self.go(proof["floor"], start, relation), "}"),
            f"enough ({write_term(start, self.names)} <= {write_term(term, self.names)}) by lra.",
            f"apply (rises {f} {g} ({place})); intros {u} U; rewrite Rmin_{first}, Rmax_{last} in U by lra.",
            *("destruct U. pose proof PI2_3_2.", *facts, "split; cbv beta.", "{ derive. }"),
            f"enough (P : {inner.say(change, '>=')}) by (assert (M := Rmult_le_pos _ ({way}) P ltac:(lra)); lra).",
            *inner.go(proof["slope"], change, ">="),
        ]

    def split(self, entries: Iterable[Any], factors: list[Term], term: Term, relation: str) -> list[str]:
        """A product of factors that are positive, or negative ones with their signs."""
        lines, signed = [], list[Term]()
        for factor, entry in zip(factors, entries, strict=True):
            power = factor[0] == "^"
            sign, premise = entry or (1, None)
            base = factor[1] if power else factor
            base = base if sign == 1 else checker.negate(base)
            if premise is not None:
                lines += [f"assert ({self.say(base, relation)}).", "{", *self.go(premise, base, relation), "}"]
            whole = ("number", abs(factor[1])) if factor[0] == "number" else base
            signed.append(("^", base, factor[2]) if power else whole)
        if signed != factors and relation != "!=":
            lines += self.change(term, ("*", *signed), ["first [ solve [unfold Rdiv; ring] | field; nonzero ]."])
        return [*lines, "first [ solve [ positive ] | solve [ nonzero ] ]."]


def complete_square(term: Term) -> Mapping[str, Any] | None:
    """The rule ``quadratic`` for a polynomial of degree 2 in a symbol, with a positive number before its square."""
    generators = [*dict.fromkeys(checker.list_generators(term))]
    ring = fmpq_mpoly_ctx.get([f"x{k}" for k in range(len(generators))] or ["x0"])
    top, bottom = checker.to_quotient(term, dict(zip(generators, ring.gens(), strict=False)), ring)

    def write(polynomial: fmpq_mpoly) -> Term:
        rows = ((q, zip(generators, map(int, powers), strict=False)) for powers, q in polynomial.terms())
        products = [("*", checker.number(q), *(("^", x, checker.number(k)) for x, k in row if k)) for q, row in rows]
        return checker.make_sum(*products) if products else checker.ZERO

    plain = generators * (bottom.is_constant() and all(g[0] == "symbol" for g in generators))
    for (_, name), x in zip(plain, ring.gens(), strict=False):
        slope = top.derivative(str(x)) / bottom.leading_coefficient()
        double = slope.derivative(str(x))
        if double.is_constant() and double != 0 and double.leading_coefficient() > 0:
            linear = slope - double * x
            constant = top / bottom.leading_coefficient() - (slope + linear) * x / 2
            rest = 2 * double * constant - linear**2
            squares = [(factor, power // 2 * 2) for factor, power in rest.factor()[1] if power > 1]
            for factor, power in squares:
                rest //= factor**power
            product = ("*", *(("^", write(f), checker.number(k)) for f, k in squares), write(rest))
            entries = [None if f[0] == "^" else [1, {"rule": "cones"}] for f in checker.list_factors(product)]
            last = {"rule": "equal", "to": product, "proof": {"rule": "product", "factors": entries}}
            proofs = [{"rule": "balls"}, None, last if rest != 0 else {"rule": "identity"}]
            parts = [write(double / 2), write(linear), write(constant)]
            return {"rule": "quadratic", "symbol": name, "coefficients": parts, "proofs": proofs}
    return None


def factor_roots(proof: Mapping[str, Any], term: Term) -> Mapping[str, Any]:
    """A polynomial that the rule ``roots`` judges, as its factors: squares, and others with their sign inside."""
    if proof.get("rule") != "roots":
        return proof
    top, bottom = checker.to_fraction(term)
    (scale, over), (unit, under) = top.factor(), bottom.factor()
    if len(over) + len(under) == 1 and (over + under)[0][1] == 1:
        return proof
    low, high = (None if proof[end] is None else checker.read_number(proof[end]) for end in ("from", "to"))
    place, symbol = checker.inner_number(low, high), ("symbol", *checker.symbols_of(term))
    while (top * bottom)(place) == 0:
        place = checker.inner_number(place, high)
    factors, entries = [checker.number(scale / unit)], list[Any]([None])
    for factor, power, sign in (*((*pair, 1) for pair in over), *((*pair, -1) for pair in under)):
        rows = enumerate(factor.coeffs())
        base = checker.make_sum(*(("*", checker.number(q), ("^", symbol, checker.number(k))) for k, q in rows))
        factors += [("^", base, checker.number(2 * sign))] * (power // 2)
        entries += [None] * (power // 2)
        if power % 2:
            factors += [base if sign > 0 else ("^", base, checker.MINUS_ONE)]
            entries += [[1 if factor(place) > 0 else -1, {"rule": "balls"}]]
    return {"rule": "equal", "to": ("*", *factors), "proof": {"rule": "product", "factors": entries}}


def refute(place: Mapping[str, str], lines: Iterable[str]) -> list[str]:
    """The statement at a point, and lines about what stands in it: its conditions hold, and its relation does not."""
    texts = " ".join(f"({text})" for text in place.values())
    return ["intro H.", *([f"specialize (H {texts})."] if place else []), *lines, "discharge H.", "contradict H."]
