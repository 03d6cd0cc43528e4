"""Exact observability of a model: what each measurement observes, where that breaks, and how the problem splits."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import navsym as nav
from navsym.cli._settings import values_of
from navsym.cli.output import Told, table, write_text
from navsym.core.errors import NavsymError


def command(
    file: Path,
    *,
    split: str | None = None,
    poles: str | None = None,
    set_: list[str] | None = None,
    restoring: bool = False,
    candidate: list[str] | None = None,
    accuracy: bool = False,
    until: str | None = None,
    every: str | None = None,
    demand: list[str] | None = None,
    scale: list[str] | None = None,
    start: list[str] | None = None,
    jacobians: Path | None = None,
    html: Path | None = None,
    latex: Path | None = None,
) -> Told:
    """Show the exact observability of a model: dimensions, rank drops, splits, gains by poles.

    Example: navsym observe examples/schuler-velocity.toml

    Further measurements: navsym observe model.toml --restore --candidate "gps = x"

    How well a flight shows the states: navsym observe model.toml --accuracy --demand "bias = 1/100"
    """
    from navsym.observability.null_space import read_jacobians

    form, twice = "NAME = formula of the states", "expected one formula of {}; got two; rename one"
    settings = {"demand": demand, "scale": scale, "start": start}
    named = values_of(candidate, "--candidate", form, '"gps = x"', twice)
    try:
        answer = nav.observe(
            file, split=split, poles=poles, restore=restoring, candidates=named, values=values_of(set_)
        )
    except NavsymError as error:
        error.where = error.where.replace("observe: candidates.", "--candidate ").replace("observe: ", "--")
        raise
    if html is not None:
        write_text(html, answer.page())
    if latex is not None:
        write_text(latex, answer.latex())
    data = answer.document()
    if accuracy or until or every or any(settings.values()):
        demands, scales, first = (values_of(texts, f"--{word}") for word, texts in settings.items())
        data["accuracy"] = answer.accuracy(until, every=every, demands=demands, scales=scales, start=first).document()
    kept = answer.null_space(**read_jacobians(jacobians)) if jacobians is not None else None
    data |= {"null_space": kept.document()} if kept is not None else {}
    return Told(data, lambda: as_text(data), 0 if kept is None or kept.holds else 1)


# Text for people


def as_text(data: Mapping[str, Any]) -> str:
    """Tables of the document."""
    restored = restored_text(data["restore"]) if "restore" in data else ""
    chosen = split_text(data["split"]) if data["split"] else ""
    rows = [
        (s["i"], s["j"], s["det_L"], "least max(i, j)" if [s["i"], s["j"]] == data["best_split"] else "")
        for s in data["splits"]
    ]
    splits = "\n" + table(["split i", "j", "det L", "remark"], rows) if rows else ""
    gains = [f"{name} = ({', '.join(row)})\n" for name, row in data["gains"].items() if name != "stable" and row]
    gains += [f"stage of {s['measurement']}: K = ({', '.join(s['K'])})\n" for s in data.get("stages", [])]
    reached = accuracy_text(data["accuracy"]) if "accuracy" in data else ""
    kept = null_space_text(data["null_space"]["directions"]) if "null_space" in data else ""
    blocks = (overview(data), restored, drops_text(data), splits, chosen, *gains, reached, kept)
    return "\n".join(block for block in blocks if block)


def overview(data: Mapping[str, Any]) -> str:
    """The dimension that each measurement observes, and the unobservable directions."""
    verdict = "observable" if data["observable"] else "NOT observable"
    directions = data["unobservable_directions"]
    checked = "granted by the checker" if data["checked"] else f"unchecked: {data['unchecked']}"
    rows = [[m["name"], str(m["dimension"]), ", ".join(m["companion"])] for m in data["measurements"]]
    lines = [f"{data['n']} states, joint dimension {data['joint_dimension']}: {verdict} ({checked})\n"]
    lines.append(table(["measurement", "dimension", "companion"], rows))
    if directions:
        lines.append(f"unobservable directions: {'; '.join(directions)}\n")
        lines.append(f"observed combinations: {'; '.join(data['observable_functionals'])}\n")
    if data["redundant"]:
        lines.append(f"redundant: {', '.join(data['redundant'])}\n")
    if not data["proved"]:
        lines.append("the rank is proved from below only: no unobservable directions were found\n")
    rows = [[piece["from"], piece["to"], f"{piece['joint_dimension']} of {data['n']}"] for piece in data["pieces"]]
    return "\n".join([*lines, *([table(["piece from", "to", "observes alone"], rows)] if rows else [])])


def drops_text(data: Mapping[str, Any]) -> str:
    """Where a dimension drops, and for which subspaces the list of such places is proved complete."""
    heads = ["rank drops of", "where", "to", "list complete", "checker"]
    blocks = ["no rank drops found\n"]
    if data["rank_drops"]:
        blocks = [table(heads, [drop_row(d) for d in data["rank_drops"]])]
    instant = data["instant"]
    if instant and instant["rank_drops"]:
        blocks.append(table([f"at an instant, {heads[0]}", *heads[1:]], [drop_row(d) for d in instant["rank_drops"]]))
    if instant and instant["frozen_rank"] not in (None, data["joint_dimension"]):
        blocks.append(f"with F and h frozen at one time the rank would be {instant['frozen_rank']}: another model\n")
    unsure = [name for name, complete in data["rank_drops_complete"].items() if not complete]
    if unsure:
        blocks.append(f"list of rank drops not proved complete for {', '.join(unsure)}\n")
    return "\n".join(blocks)


def drop_row(drop: Mapping[str, Any]) -> list[str]:
    """One rank drop as a row: subspace, conditions, what is left, completeness of its list, and the checker's word."""
    where = " and ".join(f"{zero} = 0" for zero in drop["zeros"])
    excluded = " (excluded by declaration)" if drop["excluded_by_declaration"] else ""
    left = "" if drop["rank"] is None else str(drop["rank"])
    listed = "proved" if drop["complete"] else "not proved"
    checked = "granted" if drop["checked"] else f"unchecked: {drop['unchecked']}"
    return [drop["subspace"], where + excluded, left, listed, checked]


def split_text(chosen: Mapping[str, Any]) -> str:
    """The matrices of a split, row by row."""
    lines = [f"split i = {chosen['i']}, j = {chosen['j']} ({chosen['form']}), det L = {chosen['det_L']}"]
    for name in ("L", "Theta", "Phi_x", "Phi_z"):
        rows = chosen[name]
        if rows and rows[0]:
            lines += [f"{name}:", *("  [" + ", ".join(cells) + "]" for cells in rows)]
    return "\n".join(lines) + "\n"


def restored_text(data: Mapping[str, Any]) -> str:
    """The number of further measurements needed at least, and the smallest sets of candidates that are enough."""
    if not data["hidden"]:
        return "every state is shown already: no further measurement is needed\n"
    lines = [f"further measurements: at least {data['needed']} needed, whatever they measure"]
    if not data["sets"]:
        proved = "proved" if data["proved"] else "not proved"
        lines.append(f"not enough, all together: {', '.join(data['candidates'])} ({proved})")
    else:
        fewer = "proved that no fewer of them are" if data["proved"] else "not proved that no fewer of them are"
        lines.append(f"enough ({fewer}):")
        lines += ["  " + ", ".join(names) for names in data["sets"]]
    return "\n".join(lines) + "\n"


def accuracy_text(data: Mapping[str, Any]) -> str:
    """Deviations of the targets, when demands are met, and the weakest direction."""
    rows = []
    for found in data["targets"]:
        met = (
            ""
            if "demand" not in found
            else f"{found['demand']} {'from t = ' + found['reached'] if found['reached'] else 'not by then'}"
        )
        known = found["status"] == "certified"
        rows.append((found["target"], f"{float(found['lower']):.9g}" if known else found["status"], met))
    weakest = data["weakest"]
    parts = ", ".join(f"{value:.4g} {state}" for state, value in weakest["direction"].items())
    size = "" if weakest["deviation"] is None else f", deviation {float(weakest['deviation']['lower']):.9g}"
    lines = [table([f"at t = {data['at']}", "least standard deviation", "demand"], rows)]
    return "\n".join([*lines, f"weakest direction: {parts}{size}"] if parts else lines) + "\n"


def null_space_text(directions: Sequence[Mapping[str, Any]]) -> str:
    """Which directions the Jacobians of a filter keep, and the step that sees the others."""
    rows = []
    for found in directions:
        place = ", ".join(f"{name} = {value}" for name, value in (found["counterexample"] or {}).items())
        step = "" if found["step"] is None else f"step {found['step']}"
        rows.append((found["direction"], found["status"], f"{step}: {place}" if place else step))
    return table(["not shown by the model", "kept by the filter", "seen at"], rows)
