"""Mutates rule files and holds the readers to two promises.

A mutant gives a RuleBase or a UsageError with a place, never another exception. A mutant that is
read survives being written and read again; and where a number or a name that has a meaning was
changed, it is refused or gives another RuleBase: never the same controller, silently.

`fuzz_rules.py FORMAT --mutants N --seed N` runs longer than the test; a finding prints the mutant.
"""

import argparse
import random
import re
import sys
from collections import Counter
from collections.abc import Callable
from pathlib import Path

from quiesce.base.errors import UsageError
from quiesce.rules.formats import fcl, fis, fll
from quiesce.rules.formats.files import read_rules, read_text, write_text
from quiesce.rules.formats.scan import END, NAME, NUMBER, STRING, Source, Token, scan
from quiesce.rules.model import RuleBase
from rule_files import TEXTS, random_file_base

ROOT = Path(__file__).resolve().parents[3]
PATTERNS = {"fcl": fcl.PATTERN, "fll": fll.PATTERN, "fis": fis.PATTERN}
PLACED = re.compile(r"[^:]+:\d+:\d+: .")
# Lines whose tokens have no meaning, or do not reach the RuleBase by themselves.
UNSEEN = {
    # The numbers of rules, the name of the rule block; REAL or LREAL; operators without which the
    # same ones hold.
    "fcl": re.compile(r"^\s*(RULE \d+ :|RULEBLOCK|\w+ : REAL|(AND|OR|ACT) : \w+)"),
    "fll": re.compile(r"^\s*(enabled|lock-range|RuleBlock|(con|dis)junction|implication)"),
    # Operators that a Sugeno system, or one without such a rule, does not use.
    "fis": re.compile(r"^(Version|And|Or|Imp|Agg)"),
}
ODD = [
    "", "0", "-1", "1e999", "nan", "inf", "1.5", ";", ")", "(", "NOT", "not", "is", "'", "%", "#",
    "(*", "{", "[", "]", "\0", "\t", "\n", "ä", "=", ":=", "..", "9" * 400, "IF", "with 2",
]  # fmt: skip


class Finding(Exception):
    """A promise that does not hold."""


def seeds(format: str) -> list[str]:
    """Good files of the format."""
    found = [TEXTS[format]]
    for kind in ("singleton", "centroid"):
        base = read_rules(ROOT / f"tools/benchmarks/rules/reference_{kind}.fcl")
        if format != "fis" or kind == "centroid":
            found.append(write_text(base, format))
    for seed, method in ((1, "centroid"), (2, "weighted average, sum")):
        found.append(write_text(random_file_base(seed, method), format))
    return found


def tokens_of(format: str, text: str) -> list[Token]:
    """Of all lines, without ends; comments and the keys of FLL are no tokens."""
    source = Source(format, text)
    if format == "fcl":
        return scan(source, PATTERNS[format], 0, len(text))[:-1]
    found = []
    for start, end in source.lines():
        if format == "fll" and start < end:
            start += re.match(r"\s*[\w-]+:", text[start:end]).end()
        found += scan(source, PATTERNS[format], start, end)
    return [token for token in found if token.kind != END]


def line_of(text: str, offset: int) -> str:
    return text[text.rfind("\n", 0, offset) + 1 :].split("\n")[0]


def put(text: str, token: Token, new: str) -> str:
    return text[: token.offset] + new + text[token.offset + len(token.text) :]


def delete(text: str, tokens: list[Token], dice: random.Random) -> str:
    return put(text, dice.choice(tokens), "")


def duplicate(text: str, tokens: list[Token], dice: random.Random) -> str:
    token = dice.choice(tokens)
    return put(text, token, f"{token.text} {token.text}")


def swap(text: str, tokens: list[Token], dice: random.Random) -> str:
    first, second = sorted(dice.sample(tokens, 2), key=lambda token: token.offset)
    return put(put(text, second, first.text), first, second.text)


def replace_odd(text: str, tokens: list[Token], dice: random.Random) -> str:
    return put(text, dice.choice(tokens), dice.choice(ODD))


def insert_odd(text: str, tokens: list[Token], dice: random.Random) -> str:
    token = dice.choice(tokens)
    return put(text, token, f"{dice.choice(ODD)} {token.text}")


def noise(text: str, tokens: list[Token], dice: random.Random) -> str:
    characters = list(text)
    for _ in range(dice.randint(1, 3)):
        code = dice.choice([dice.randrange(256), 0x20AC])
        characters[dice.randrange(len(characters))] = chr(code)
    return "".join(characters)


def truncate(text: str, tokens: list[Token], dice: random.Random) -> str:
    return text[: dice.randrange(len(text))]


def drop_line(text: str, tokens: list[Token], dice: random.Random) -> str:
    lines = text.splitlines(keepends=True)
    del lines[dice.randrange(len(lines))]
    return "".join(lines)


def repeat_line(text: str, tokens: list[Token], dice: random.Random) -> str:
    lines = text.splitlines(keepends=True)
    lines.insert(dice.randrange(len(lines)), dice.choice(lines))
    return "".join(lines)


def swap_lines(text: str, tokens: list[Token], dice: random.Random) -> str:
    lines = text.splitlines(keepends=True)
    i, j = dice.randrange(len(lines)), dice.randrange(len(lines))
    lines[i], lines[j] = lines[j], lines[i]
    return "".join(lines)


Mutation = Callable[[str, list[Token], random.Random], str]
ANYWHERE: tuple[Mutation, ...] = (noise, truncate, drop_line, repeat_line, swap_lines)
MUTATIONS: tuple[Mutation, ...] = (
    delete, duplicate, swap, replace_odd, insert_odd, *ANYWHERE,
)  # fmt: skip


def meaningful(format: str, text: str, tokens: list[Token]) -> list[Token]:
    """Numbers, names and texts that reach the RuleBase."""
    kinds = (NUMBER, NAME, STRING)
    unseen = UNSEEN[format]
    seen = []
    for token in tokens:
        line = line_of(text, token.offset)
        ahead = unseen.match(line)
        inside = token.offset - (text.rfind("\n", 0, token.offset) + 1)
        if ahead and (format != "fcl" or inside < ahead.end() or "RULEBLOCK" in line):
            continue
        is_resolution = token.kind == NUMBER and "Centroid" in line
        if token.kind in kinds and not is_resolution:
            seen.append(token)
    return seen


def change(text: str, seen: list[Token], dice: random.Random) -> str | None:
    """One token with a meaning, changed to another of its kind that occurs in the file."""
    kind = dice.choice(sorted({token.kind for token in seen}))
    token = dice.choice([token for token in seen if token.kind == kind])
    if token.kind == NUMBER:
        value = float(token.text)
        new = repr(dice.choice([value + 0.25, value * 1.0000001, value - 1, -value, value + 1]))
        return None if float(new) == value else put(text, token, new)
    others = sorted({t.text for t in seen if t.kind == token.kind})
    new = dice.choice(others)
    return None if new.upper() == token.text.upper() else put(text, token, new)


def outcome(text: str, format: str) -> RuleBase | None:
    """The mutant's base, None where it is refused; Finding where a promise is broken."""
    try:
        base = read_text(text, format, "mutant")
    except UsageError as error:
        if not PLACED.match(str(error)) or "\n" in str(error):
            raise Finding(f"message without a place: {error}")
        return None
    except Exception as error:
        raise Finding(f"{type(error).__name__}: {error}")
    try:
        again = read_text(write_text(base, format), format, "again")
    except Exception as error:
        raise Finding(f"was read, but not written and read again: {error}")
    if again != base:
        raise Finding("reads differently once written")
    return base


def check(mutant: str, format: str, different_from: RuleBase | None = None) -> bool:
    """Whether it was read."""
    try:
        base = outcome(mutant, format)
        if base is not None and base == different_from:
            raise Finding("a changed number or name makes no difference")
    except Finding as error:
        raise Finding(f"{error}\n{mutant}")
    return base is not None


def fuzz(format: str, mutants: int, seed: int) -> Counter[str]:
    """Counts of the mutants: read or refused, by any mutation or by a change of meaning."""
    dice = random.Random(f"{format} {seed}")
    good = [(text, tokens_of(format, text)) for text in seeds(format)]
    bases = [read_text(text, format, "seed") for text, _ in good]
    seen = [meaningful(format, text, tokens) for text, tokens in good]
    counts: Counter[str] = Counter()
    while sum(counts.values()) < mutants:
        index = dice.randrange(len(good))
        text, tokens = good[index]
        if dice.random() < 0.4:
            mutant = change(text, seen[index], dice)
            if mutant is not None:
                read = check(mutant, format, bases[index])
                counts["changed, " + ("read" if read else "refused")] += 1
            continue
        mutant = dice.choice(MUTATIONS)(text, tokens, dice)
        if mutant and dice.random() < 0.3:
            mutant = dice.choice(ANYWHERE)(mutant, tokens, dice)
        counts["mutated, " + ("read" if check(mutant, format) else "refused")] += 1
    return counts


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("format", choices=PATTERNS)
    parser.add_argument("--mutants", type=int, default=100_000)
    parser.add_argument("--seed", type=int, default=0)
    args = parser.parse_args()
    try:
        print(dict(fuzz(args.format, args.mutants, args.seed)))
    except Finding as error:
        sys.exit(f"{args.format}: {error}")


if __name__ == "__main__":
    main()
