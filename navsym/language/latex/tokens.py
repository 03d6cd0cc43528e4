r"""LaTeX as tokens of a regular expression: what the second reader reads."""

from __future__ import annotations

import re
from dataclasses import dataclass

from navsym.language.latex.notation import BOLD, GREEK, SETTINGS, SIZES, SPACES, WORDS
from navsym.language.latex.parts import Refusal

TOKEN = re.compile(r"\\(?:operatorname\*|[A-Za-z]+|.)|\s+|[^\\]", re.S)
DELIMITERS = {
    r"\lvert": "|<", r"\rvert": ">|", r"\lVert": "||<", r"\rVert": ">||", r"\|": "||", r"\Vert": "||", r"\vert": "|",
    r"\lfloor": "floor<", r"\rfloor": ">floor", r"\lbrack": "[", r"\rbrack": "]", r"\lparen": "(", r"\rparen": ")",
    r"\langle": "angle<", r"\rangle": ">angle", r"\{": "{<", r"\}": ">}",
}  # fmt: skip


@dataclass(slots=True)
class Token:
    r"""A command, a character, or a word of ``\mathrm``; where it stands in the text."""

    text: str
    at: int
    end: int
    bold: bool = False
    word: bool = False


def clean(text: str) -> list[Token]:
    """Tokens without spaces, sizes and bold commands; brackets of one kind have one spelling."""
    raw = [Token(m[0], m.start(), m.end()) for m in TOKEN.finditer(text) if not m[0].isspace()]
    tokens: list[Token] = []
    side, spaced = "", False
    for token in raw:
        name = token.text[1:] if token.text[0] == "\\" else ""
        if name in SETTINGS or name in SIZES:
            continue
        if name in SPACES or token.text == "~":
            spaced = True
            continue
        if spaced and token.text in ("_", "^"):
            tokens += [Token("{", token.at, token.at), Token("}", token.at, token.at)]
        spaced = False
        if name in ("left", "right"):
            side = name
            continue
        token.text = DELIMITERS.get(token.text, token.text)
        if token.text == "}" and [t.text for t in tokens[-3:-1]] == ["d", "{"]:  # the differential d{x}
            del tokens[-2]
            continue
        is_second = token.text == "|" and bool(tokens) and (tokens[-1].text, tokens[-1].end) == ("|", token.at)
        if is_second and not side and sum(t.text == "|" for t in tokens) % 2:  # no |a||b|
            tokens[-1].text, tokens[-1].end = "||", token.end
            continue
        if side:
            if token.text in ("|", "||"):
                token.text = f"{token.text}<" if side == "left" else f">{token.text}"
            elif (side, token.text) == ("right", "."):
                token.text = ">cases"
            elif token.text not in "()[]" and "<" not in token.text and ">" not in token.text:
                raise Refusal(token.at, f"a bracket behind \\{side}", token.text, "write one")
            side = ""
        tokens.append(token)
    return embolden(join_words(tokens, text))


def join_words(tokens: list[Token], text: str) -> list[Token]:
    r"""``\mathrm{ab}`` as one token."""
    done: list[Token] = []
    place = 0
    while place < len(tokens):
        token = tokens[place]
        if token.text[1:] in WORDS and token.text[0] == "\\" and place + 1 < len(tokens):
            stop = match_brace(tokens, place + 1) if tokens[place + 1].text == "{" else place + 1
            if token.text == r"\rm" and tokens[place - 1].text == "{" and place > 0:
                stop = match_brace(tokens, place - 1) - 1
            word = text[tokens[place + 1].at : tokens[stop].end].strip("{} ")
            done.append(Token(word, token.at, tokens[stop].end, word=True))
            place = stop + 1
        else:
            done.append(token)
            place += 1
    return done


def embolden(tokens: list[Token]) -> list[Token]:
    """Bold type as a flag of what it sets."""
    place = 0
    while place < len(tokens):
        switched = tokens[place].text in (r"\bf", r"\bfseries") and place > 0 and tokens[place - 1].text == "{"
        if switched:
            for token in tokens[place : match_brace(tokens, place - 1)]:
                token.bold = True
            del tokens[place]
        elif tokens[place].text[:1] == "\\" and tokens[place].text[1:] in BOLD and not tokens[place].word:
            if place + 1 == len(tokens):
                raise Refusal(tokens[place].at, "what is bold", "the end", "write it")
            del tokens[place]
            stop = match_brace(tokens, place) if tokens[place].text == "{" else place
            for token in tokens[place : stop + 1]:
                token.bold = True
        else:
            place += 1
    return tokens


def match_brace(tokens: list[Token], place: int, opening: str = "{", closing: str = "}") -> int:
    """Place of the brace, or of another mark, that closes the one here."""
    depth = 0
    for at in range(place, len(tokens)):
        depth += (tokens[at].text == opening) - (tokens[at].text == closing)
        if depth == 0:
            return at
    where = tokens[min(place, len(tokens) - 1)].at if tokens else 0
    raise Refusal(where, "a closing brace", "the end", "close it")


def split_tokens(tokens: list[Token], mark: str) -> list[list[Token]]:
    """Tokens cut at a mark outside of braces and inner matrices."""
    pieces: list[list[Token]] = [[]]
    depth = 0
    for token in tokens:
        depth += (token.text in ("{", r"\begin")) - (token.text in ("}", r"\end"))
        if depth == 0 and token.text == mark:
            pieces.append([])
        else:
            pieces[-1].append(token)
    return pieces


def plain_word(token: Token) -> str | None:
    """The name of a letter, a Greek letter or a word."""
    if token.word:
        return token.text if re.fullmatch("[A-Za-z][A-Za-z0-9]*", token.text) else None
    if token.text[:1] == "\\":
        return token.text[1:] if token.text[1:] in GREEK else None
    return token.text if token.text.isascii() and token.text.isalpha() else None


def underscore(sub: list[Token] | None) -> str:
    """``_eS`` for a subscript of letters and digits."""
    pieces = [t.text if t.text.isdigit() else plain_word(t) for t in sub or ()]
    return "" if not pieces or None in pieces else "_" + "".join(map(str, pieces))
