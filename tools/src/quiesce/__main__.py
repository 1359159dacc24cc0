"""What `quiesce` and `python -m quiesce` start."""

import sys


def start() -> int:
    """The command's exit code; Ctrl-C before it has begun is one line, too."""
    try:
        from quiesce.cli.main import main
    except KeyboardInterrupt:
        print("quiesce: interrupted; nothing was written", file=sys.stderr)
        return 130
    return main()


if __name__ == "__main__":
    sys.exit(start())
