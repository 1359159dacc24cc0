"""Tables for pages, of the fuzzy benchmark's committed result."""

from typing import Any

from quiesce_benchmarks.house.markdown import count, markdown

KINDS = {"straight": "straight-line C", "table": "table"}
FORMATS = {"q15": "Q15 inputs", "physical": "physical inputs"}


def engine_table(fuzzy: dict[str, Any]) -> str:
    """Instructions and bytes of one evaluation on the image: ours, then libfuzzylite's."""
    context = fuzzy["context"]
    rows = []
    for kind, words in KINDS.items():
        for engine in context["engines"]:
            _, method, unit = engine["variant"].split("_")
            if engine["kind"] == kind:
                rows.append(
                    [
                        f"{words}, {method}, {FORMATS[unit]}",
                        f"{engine['mean_instr']:.1f}",
                        count(engine["worst_instr"]),
                        count(engine["code_bytes"]),
                        count(engine["table_bytes"]) if engine["table_bytes"] else "",
                    ]
                )
    for peer in context["peers"]:
        samples = peer["resolution"]
        method = f"centroid of {samples} samples" if samples else "sum"
        cells = [count(peer["mean_instr"]), count(peer["worst_instr"])]
        rows.append(
            [f"libfuzzylite 6, {method}", *cells, f"{count(peer['code_bytes'])} (image)", ""]
        )
    return markdown(["", "mean", "worst", "code, bytes", "table, bytes"], rows)


def host_table(fuzzy: dict[str, Any]) -> str:
    """Instructions of one evaluation on this machine, under callgrind, by method."""
    rows = [
        [one["method"], one["what"], count(one["mean_instr"])]
        for one in sorted(
            fuzzy["context"]["host_instr"], key=lambda one: one["method"] == "centroid"
        )
    ]
    return markdown(["method", "", "mean"], rows)


def ratio_table(fuzzy: dict[str, Any]) -> str:
    """How many of our worst evaluations libfuzzylite's mean one is."""
    names = {"singleton": "sum", "centroid_100": "centroid, 100 samples"}
    names["centroid_200"] = "centroid, 200 samples"
    ratios = fuzzy["context"]["ratios"]
    return markdown(
        ["method", "times"], [[text, f"{ratios[key]:.0f}"] for key, text in names.items()]
    )
