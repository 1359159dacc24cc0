"""What the actions of `quiesce identify` share on the command line."""

import argparse


def fill(parser: argparse.ArgumentParser, epilog: str) -> None:
    parser.epilog = epilog
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
