#!/usr/bin/env python3
"""Write the STM32F4's register headers and the rows of the tests' fakes from registers.toml.

`--crate FILE` first writes registers.toml anew: the registers that wanted.toml names, as the crate
stm32f4 (svd2rust's output) describes them. Deterministic: the same source gives the same bytes.
`--check` writes nothing and exits 1 where a committed file differs. What is wanted and not there is
refused with exit code 2.
"""

import argparse
import hashlib
import re
import sys
import tarfile
import tomllib
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
FOLDER = "hal/stm32f4"
WANTED, TABLE = f"{FOLDER}/wanted.toml", f"{FOLDER}/registers.toml"
HEADERS, FAKES = f"{FOLDER}/generated", "tests/unit/stm32f4/generated"
BLOCK = re.compile(
    r"///0x([0-9a-f]+)(?:\.\.0x([0-9a-f]+))? - [^\n]*\n(?:\s*///[^\n]*\n)*"
    r"\s*#\[inline\(always\)\]\n\s*pub const fn (\w+)\(&self(, n: usize)?\) -> &(\w+) \{"
)
ARRAY = re.compile(r"(\w+): \[(\w+); (?:0x)?(\w+)\]")
FIELD = re.compile(
    r"///Bits? (\d+)(?::(\d+))? - [^\n]*\n(?:\s*///[^\n]*\n)*\s*#\[inline\(always\)\]\n"
    r"\s*pub (?:const )?fn (\w+)\(&(mut )?self\) -> (\w+)"
)
WRITER = re.compile(r"pub type (\w+_W)<'a, REG> = crate::BitWriter([01][CS])?")
EFFECTS = {"1C": "1 clears", "0C": "0 clears", "1S": "1 sets"}
MASKS = ("readable", "writable", "1 clears", "0 clears", "1 sets")


class Refused(Exception):
    """One line says what is wrong."""


class Crate:
    """The description of a chip: text of files by their path below the chip's folder."""

    def __init__(self, archive: Path, name: str, chip: str) -> None:
        head = f"{name}/src/{chip}/"
        with tarfile.open(archive, "r:gz") as tar:
            self.text = {
                one.name.removeprefix(head): tar.extractfile(one).read().decode()
                for one in tar.getmembers()
                if one.name.startswith(head) and one.isfile()
            }

    def base(self, instance: str) -> int:
        found = re.search(
            rf"pub type {instance} = crate::Periph<\w+::RegisterBlock, 0x([0-9a-f_]+)>",
            self.text["mod.rs"],
        )
        if found is None:
            raise Refused(f"the crate has no {instance}")
        return int(found[1].replace("_", ""), 16)

    def interrupt(self, name: str) -> int:
        found = re.search(rf"\b{name} = (\d+),", self.text["mod.rs"])
        if found is None:
            raise Refused(f"the crate has no interrupt {name}")
        return int(found[1])

    def places(self, path: str) -> dict[str, tuple[int, int, str]]:
        """Of a block: a member's offset, the end of an array (0: none), its type's file."""
        text = self.text[f"{path}.rs"]
        return {
            m[3]: (int(m[1], 16), int(m[2] or "0", 16), m[5].lower()) for m in BLOCK.finditer(text)
        }

    def resolved(self, path: str) -> str:
        """A register that another block has, too, is described there."""
        block, _, name = path.rpartition("/")
        shared = re.search(
            rf"pub use (?:super::|crate::\w+::)(\w+)::{name};", self.text[f"{block}.rs"]
        )
        return f"{shared[1]}/{name}" if shared else path

    def register(self, path: str) -> dict:
        """Reset value and fields: bit, width, what reads and writes do."""
        text = self.text[f"{self.resolved(path)}.rs"]
        effects = {name: EFFECTS.get(kind, "writable") for name, kind in WRITER.findall(text)}
        fields: dict[str, dict] = {}
        for first, last, name, writes, kind in FIELD.findall(text):
            bit, end = int(first), int(last or first)
            field = fields.setdefault(name, {"bit": bit, "width": end - bit + 1, "does": []})
            field["does"].append(effects.get(kind, "writable") if writes else "readable")
        reset = re.search(r"const RESET_VALUE: \w+ = 0x([0-9a-f_]+);", text)
        return {"reset": int(reset[1].replace("_", ""), 16) if reset else 0, "fields": fields}


def wanted_rows(crate: Crate, block: dict) -> Iterator[tuple[str, dict]]:
    """(register, its description with offset, count and stride) of a block that is wanted."""
    name = next((n for n in block["name"].split("|") if f"{n}.rs" in crate.text), None)
    if name is None:
        raise Refused(f"the crate has no block {block['name']}")
    arrays = {m[0]: int(m[2]) for m in ARRAY.findall(crate.text[f"{name}.rs"]) if m[2].isdigit()}
    for register in block["registers"]:
        cluster, _, inner = register.rpartition(".")
        places = crate.places(f"{name}/{cluster}" if cluster else name)
        if inner not in places:
            raise Refused(f"{name} has no register {register}")
        offset, _, file = places[inner]
        row = {"offset": offset, "count": 1, "stride": 0}
        if cluster:
            begin, end, _ = crate.places(name)[cluster]
            count = arrays[cluster]
            row = {"offset": begin + offset, "count": count, "stride": (end - begin) // count}
        path = f"{name}/{cluster}/{file}" if cluster else f"{name}/{file}"
        yield register.replace(".", "_"), {**row, **crate.register(path)}


def with_effects(rows: dict, called: str, effects: list[dict]) -> None:
    """What the description does not say of a field takes the place of what it says of writing."""
    for effect in effects:
        block, _, register = effect["register"].partition(".")
        if block != called:
            continue
        for name in effect["fields"]:
            field = rows[register]["fields"].get(name)
            if field is None:
                raise Refused(f"{effect['register']} has no field {name}")
            field["does"] = ["readable", effect["what"]]


def described(wanted: dict, archive: Path) -> str:
    """registers.toml."""
    digest = hashlib.sha256(archive.read_bytes()).hexdigest()
    if digest != wanted["sha256"]:
        raise Refused(f"{archive.name} has the SHA-256 {digest}, wanted is {wanted['sha256']}")
    lines = [
        f"# {wanted['crate']} by tools/gen/stm32f4_registers.py, of what wanted.toml names.",
        f'wanted = "{hashlib.sha256((ROOT / WANTED).read_bytes()).hexdigest()}"',
    ]
    for chip in wanted["chips"]:
        crate = Crate(archive, wanted["crate"], chip)
        lines.append(f"\n[{chip}.interrupts]")
        lines += (f"{name} = {crate.interrupt(name)}" for name in wanted["interrupts"])
        for block in wanted["block"]:
            rows = dict(wanted_rows(crate, block))
            with_effects(rows, block.get("called", block["name"]), wanted["effect"])
            for instance in block["instances"]:
                lines += table_lines(chip, instance, crate.base(instance), rows)
    return "\n".join(lines) + "\n"


def table_lines(chip: str, instance: str, base: int, rows: dict) -> Iterator[str]:
    yield f"\n[{chip}.{instance}]\nbase = {base:#010x}"
    for register, row in rows.items():
        yield f"[{chip}.{instance}.registers.{register}]"
        yield f"offset = {row['offset']:#05x}\nreset = {row['reset']:#010x}"
        if row["count"] > 1:
            yield f"count = {row['count']}\nstride = {row['stride']}"
        for name, field in row["fields"].items():
            does = ", ".join(f'"{one}"' for one in sorted(set(field["does"])))
            place = f"bit = {field['bit']}, width = {field['width']}"
            yield f"fields.{name} = {{{place}, does = [{does}]}}"


def mask(field: dict) -> int:
    return ((1 << field["width"]) - 1) << field["bit"]


def common_fields(instances: list[dict], register: str) -> dict[str, dict]:
    """Fields that all of these have at the same place."""
    first, *others = [one["registers"][register].get("fields", {}) for one in instances]
    return {
        name: field
        for name, field in first.items()
        if all(mask(other[name]) == mask(field) if name in other else False for other in others)
    }


def head(what: str, guard: str) -> list[str]:
    made = "Made by tools/gen/stm32f4_registers.py\n/// from hal/stm32f4/registers.toml."
    return [f"/// {what} {made}", f"#ifndef {guard}\n#define {guard}\n"]


def header(called: str, instances: dict[str, list[dict]]) -> str:
    """Addresses, offsets and masks of a kind of block; the instances of both chips by name."""
    lines = head(f"Registers of the STM32F4's {called.upper()}.", f"STM32F4_{called.upper()}_H")
    for name, of_chips in instances.items():
        if len({one["base"] for one in of_chips}) != 1:
            raise Refused(f"{name} has two addresses")
        lines.append(f"#define {name}_BASE {of_chips[0]['base']:#010x}u")
    every = [one for of_chips in instances.values() for one in of_chips]
    for register, row in every[0]["registers"].items():
        macro = f"{called}_{register}".upper()
        offset = f"{row['offset']:#05x}u"
        if "count" in row:
            place = f"({offset} + {row['stride']}u * (n)) // n: 0 .. {row['count'] - 1}"
            lines.append(f"\n#define {macro}(n) {place}")
        else:
            lines.append(f"\n#define {macro} {offset}")
        for name, field in common_fields(every, register).items():
            full = f"{macro}_{name.upper()}"
            ones = (1 << field["width"]) - 1
            lines.append(f"#define {full} ({ones:#x}u << {field['bit']})")
            if field["width"] > 1:
                lines.append(f"#define {full}_AT {field['bit']}u")
    return "\n".join([*lines, "\n#endif", ""])


def interrupts(chips: list[dict]) -> str:
    """Places in the table of vectors, the same on both chips."""
    if any(chip["interrupts"] != chips[0]["interrupts"] for chip in chips):
        raise Refused("an interrupt has two numbers")
    lines = [
        *head("Interrupts of the STM32F4.", "STM32F4_INTERRUPTS_H"),
        *(f"#define {name}_INTERRUPT {n}u" for name, n in chips[0]["interrupts"].items()),
    ]
    return "\n".join([*lines, "\n#endif", ""])


def fake_rows(blocks: dict) -> Iterator[str]:
    """A row a register: its address and what the fake does with it."""
    for instance, block in blocks.items():
        for register, row in block.get("registers", {}).items():
            masks = dict.fromkeys(MASKS, 0)
            for field in row.get("fields", {}).values():
                for does in field["does"]:
                    masks[does] |= mask(field)
            words = ", ".join(f"{one:#x}u" for one in (row["reset"], *masks.values()))
            for n in range(row.get("count", 1)):
                address = block["base"] + row["offset"] + n * row.get("stride", 0)
                name = f"{instance}.{register.upper()}" + (f"[{n}]" if "count" in row else "")
                yield f'    {{"{name}", {address:#010x}u, {words}}},'


def fakes(chip: str, blocks: dict) -> str:
    rows = list(fake_rows(blocks))
    return "\n".join(
        [
            "// Made by tools/gen/stm32f4_registers.py from hal/stm32f4/registers.toml.",
            '#include "fake_registers.h"\n',
            "// Name, address, reset value; masks: readable, writable, 1 clears, 0 clears, 1 sets.",
            f"const fake_register_t {chip}_registers[] = {{",
            *rows,
            "};",
            f"const uint32_t {chip}_count = {len(rows)}u;",
            "",
        ]
    )


def outputs(wanted: dict, table: dict) -> dict[str, str]:
    """File -> its text."""
    if table["wanted"] != hashlib.sha256((ROOT / WANTED).read_bytes()).hexdigest():
        raise Refused(f"{TABLE} is of another {WANTED}: give --crate FILE")
    kinds: dict[str, dict[str, list[dict]]] = {}
    for block in wanted["block"]:
        kind = kinds.setdefault(block.get("called", block["name"]), {})
        for name in block["instances"]:
            kind[name] = [table[chip][name] for chip in wanted["chips"]]
    made = {f"{HEADERS}/stm32f4_{kind}.h": header(kind, of) for kind, of in kinds.items()}
    made[f"{HEADERS}/stm32f4_interrupts.h"] = interrupts([table[c] for c in wanted["chips"]])
    made |= {f"{FAKES}/{chip}.c": fakes(chip, table[chip]) for chip in wanted["chips"]}
    return made


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--check", action="store_true", help="compare, write nothing")
    parser.add_argument("--crate", type=Path, help="the crate's archive, as cargo keeps it")
    args = parser.parse_args()
    try:
        wanted = tomllib.loads((ROOT / WANTED).read_text())
        made = {TABLE: described(wanted, args.crate)} if args.crate else {}
        made |= outputs(wanted, tomllib.loads(made.get(TABLE) or (ROOT / TABLE).read_text()))
    except (Refused, OSError, tarfile.TarError, KeyError, tomllib.TOMLDecodeError) as error:
        print(f"stm32f4_registers: {error}", file=sys.stderr)
        return 2
    stale = [
        n for n, text in made.items() if not (ROOT / n).is_file() or (ROOT / n).read_text() != text
    ]
    for name in stale:
        if args.check:
            print(f"{name} does not match its source: run tools/gen/stm32f4_registers.py")
        else:
            (ROOT / name).parent.mkdir(parents=True, exist_ok=True)
            (ROOT / name).write_text(made[name])
    return int(bool(stale) and args.check)


if __name__ == "__main__":
    sys.exit(main())
