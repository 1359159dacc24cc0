"""Print, each ended by a NUL, the files of a compile_commands.json whose path in the project
matches a pattern: what xargs -0 feeds to clang-tidy. Where files are named, only these."""

import json
import re
import sys
from pathlib import Path


def main(commands: str, pattern: str, *named: str) -> int:
    root = Path.cwd()
    files = {Path(entry["file"]) for entry in json.loads(Path(commands).read_text())}
    inside = sorted(str(f.relative_to(root)) for f in files if f.is_relative_to(root))
    chosen = [name for name in inside if re.search(pattern, name)]
    if not chosen:
        print(f"{commands}: no file matches {pattern}", file=sys.stderr)
        return 1
    sys.stdout.write("".join(name + "\0" for name in chosen if not named or name in named))
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
