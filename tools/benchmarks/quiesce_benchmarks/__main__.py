"""`python -m quiesce_benchmarks`."""

import sys

from quiesce_benchmarks.cli import main

if __name__ == "__main__":
    sys.exit(main())
