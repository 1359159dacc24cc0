"""What the static analysis of a rule base finds, one remark each."""

from dataclasses import dataclass

ERROR, WARNING, NOTE = "error", "warning", "note"

# Kinds
UNCOVERED = "uncovered"
UNUSED = "unused"
EMPTY = "empty"
UNREACHABLE = "unreachable"
CONTRADICTORY = "contradictory"
DUPLICATE = "duplicate"
NON_MONOTONE = "non-monotone"
DISCONTINUOUS = "discontinuous"

# How it is known
PROVED, SAMPLED = "proved", "sampled"


@dataclass(frozen=True)
class Finding:
    kind: str
    severity: str
    text: str  # one line, complete without the rest
    place: str  # `input f`, `output I`, `rule 7`, or a region of the inputs
    basis: str = PROVED


def rule_place(index: int) -> str:
    """Rules count from 1, in the order of the file."""
    return f"rule {index + 1}"


def number(x: float) -> str:
    return f"{x:.6g}"
