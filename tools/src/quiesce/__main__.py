"""What `quiesce` and `python -m quiesce` start."""

import sys


def start(arguments: list[str] | None = None) -> int:
    """As quiesce.cli.main.main; Ctrl-C before it has begun is one line, too."""
    try:
        from quiesce.cli.main import main
    except KeyboardInterrupt:
        print("quiesce: interrupted; nothing was written", file=sys.stderr)
        return 130
    return main(arguments)


if __name__ == "__main__":
    sys.exit(start())
