"""An example of every command that works without a device, in an order in which each finds what
the ones before it have made. The folder that they run in has FILES, and nothing of a checkout."""

from pathlib import Path

RULES = """FUNCTION_BLOCK soft
VAR_INPUT
  v : REAL;
END_VAR
VAR_OUTPUT
  i : REAL;
END_VAR
FUZZIFY v
  RANGE := (-1 .. 1);
  TERM down := (-1, 1) (0, 0);
  TERM up := (0, 0) (1, 1);
END_FUZZIFY
DEFUZZIFY i
  TERM off := 0;
  TERM on := 1.8;
  METHOD : COGS;
  DEFAULT := 0;
  RANGE := (0 .. 1.88);
END_DEFUZZIFY
RULEBLOCK one
  RULE 1 : IF v IS down THEN i IS off;
  RULE 2 : IF v IS up THEN i IS on;
END_RULEBLOCK
END_FUNCTION_BLOCK
"""
SIGNS = """31475351 A625CF50 00000019 00000001 00000002 00000002 00000000 00000001 01312D00
00000005 00000004 01312D00 00000005 00F9FFFF 0000000F 00FFFFFF 00000000 00F9FFFF 0000000F 00000000
00FFFFFF 00000758 00000000 00000000 00000758
"""
FRAMES = """(0.000000) can0 010#00000E58
(0.000000) can0 100#27000000000000C2
(0.001000) can0 010#00001E95
"""
SAMPLES = "v_m_s,i_A\n" + "".join(f"{(i - 50) / 50},{int(i > 50)}\n" for i in range(101))
FILES = {"up.fcl": RULES, "sky.words": SIGNS, "bus.log": FRAMES, "samples.csv": SAMPLES}

DAMPER = "sim_hil/data/dampers/rd1005_kwok_tanh_smooth.toml"
PUBLISHED = "firmware/plants/squeeze_2012/rules.fcl"
# Command, and what is typed after it.
EXAMPLES: tuple[tuple[str, str], ...] = (
    (
        "new plant",
        "press --mass 120 --freq 2.9 --damper rd1005_kwok_tanh_smooth "
        "--drive force:1.5..6Hz,100N --accel pcb_333B32",
    ),
    ("plant check", "press/plant.toml"),
    ("board check", "press/board.toml"),
    ("board show", "press/board.toml"),
    ("board compile", "press/board.toml --out board.c"),
    ("params", ""),
    ("chain", ""),
    ("completion", "bash"),
    ("record", "step_10_20Hz --from-s 2 --to-s 8 --out step.csv"),
    ("replay", "step.csv --column accel_m_s2 --unit m_s2"),
    ("hil", "--target host --quick --scenario sine_10Hz --law fuzzy"),
    ("rules convert", f"{PUBLISHED} --to fis --out my.fis"),
    ("rules check", "up.fcl --quick"),
    ("rules show", "my.fis"),
    ("rules compile", "my.fis --out compiled"),
    ("rules diff", "my.fis my.fis"),
    ("rules lookup", "--freq 10,20 --drive 0.1 --step-mA 2500 --settle 2"),
    ("rules optimize", "--scenario sine_20Hz --population 4 --evaluations 6 --out searched"),
    ("compare", "--rig quarter_car --road C:72 --law off --law constant"),
    ("law list", ""),
    ("law make", "skyhook_on_off --board press/board.toml -o sky.table"),
    ("law rules", "up.fcl --board press/board.toml --map 'v=velocity of mass' -o up.table"),
    (
        "law fit",
        "samples.csv --board press/board.toml --output i_A --inputs 'velocity of mass=v_m_s' "
        "-o net.table",
    ),
    ("table show", "sky.table"),
    ("table check", "sky.table"),
    ("table diff", "sky.table sky.table"),
    ("table stamp", "sky.table --any"),
    ("table pack", "sky.words -o packed.table"),
    ("sweep", "--out excitation.csv --band 3 60 --drive 0.1 --max-current 2"),
    ("identify plan", "--stroke-mm 50 --max-force-N 2000 --max-current-A 2 --out plan"),
    ("identify example", "--out example.csv"),
    ("identify", "example.csv --model bingham --effort quick --out found"),
    ("identify compare", "found/models/bingham.toml example.csv"),
    ("identify inverse", f"{DAMPER} --max-current-A 1.88 --out inverse"),
    ("identify export", f"{DAMPER} --to c --out exported"),
    ("identify online", "example.csv --out online"),
    ("tune", "press/plant.toml --quick --from-Hz 2 --to-Hz 3 --out tuned"),
    ("tune law", "skyhook_on_off --rig quarter_car --road C:72 --trials 6 --out gains"),
    ("can list", ""),
    ("can bus-load", ""),
    ("can decode", "bus.log"),
)

# Commands that need a controller on a bus: refused in one line where there is none.
NEED_A_BUS = (
    ("can monitor", ""),
    ("can check", ""),
    ("can record", "--out run.log"),
    ("can replay", "bus.log"),
    ("can get", "law"),
    ("can set", "law=phase"),
    ("can stop", "--yes"),
    ("can freeze", ""),
    ("can load", f"rules {PUBLISHED}"),
    ("can tables", ""),
    ("can revert", "law"),
    ("can fetch", "law -o got.table"),
    ("can save-learnt", ""),
    ("can restore-learnt", ""),
    ("can forget-learnt", ""),
)
NO_BUS = "--bus socketcan:none0"

# What stands in the place of an example: an extra is asked for.
EXTRAS = (("mdf", f"can record --out run.mf4 {NO_BUS}"),)


def write_files(folder: Path) -> None:
    for name, text in FILES.items():
        (folder / name).write_text(text)
