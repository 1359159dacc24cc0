"""`quiesce completion SHELL`: the script by which a shell completes commands, options and files."""

import argparse
from pathlib import Path

from quiesce.base.errors import one_line

SHELLS = ("bash", "zsh", "tcsh")
FILES, FOLDERS = ("FILE", ".csv", ".toml", "PATH"), ("DIR", "FOLDER")

EPILOG = """examples:
  eval "$(quiesce completion bash)"             in this shell; in ~/.bashrc for all
  quiesce completion bash > ~/.local/share/bash-completion/completions/quiesce
  quiesce completion zsh > "${fpath[1]}/_quiesce"
  quiesce completion tcsh > ~/.quiesce.tcsh     and 'source ~/.quiesce.tcsh' in ~/.tcshrc
"""


def add_parser(commands: argparse._SubParsersAction) -> None:
    parser = commands.add_parser(
        "completion",
        description="Print the script by which a shell completes commands, options and files.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("shell", choices=SHELLS)
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    import shtab

    from quiesce.cli.main import whole_parser

    parser = whole_parser()
    nest_actions(parser)
    mark(parser)
    script = shtab.complete(parser, args.shell)
    # Of bash: where nothing else fits, a file does; `identify` takes an action or files.
    print(script.replace("complete -o filenames", "complete -o default -o filenames"))
    return 0


def commands_of(parser: argparse.ArgumentParser) -> argparse._SubParsersAction | None:
    found = (one for one in parser._actions if isinstance(one, argparse._SubParsersAction))
    return next(found, None)


def nest_actions(parser: argparse.ArgumentParser) -> None:
    """`identify-plan` as it is typed: `identify plan`, beside the files that identify takes."""
    commands = commands_of(parser)
    assert commands is not None
    for name in [one for one in commands.choices if "-" in one]:
        command, _, action = name.partition("-")
        own = commands.choices[command]
        nested = commands_of(own)
        if nested is None:
            nested = own.add_subparsers(parser_class=type(own))
            own._actions.insert(0, own._actions.pop())
        nested.choices[action] = commands.choices.pop(name)


def mark(parser: argparse.ArgumentParser) -> None:
    """Commands as told of, which shtab leaves out where they have no line of help in a list; and
    arguments that are files or folders, to complete as such."""
    import shtab

    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            told = {one.dest for one in action._choices_actions}
            for name, one in action.choices.items():
                mark(one)
                if name not in told:
                    line = action._ChoicesPseudoAction(name, [], one_line(one.description or name))
                    action._choices_actions.append(line)
        elif action.choices is None and action.nargs != 0:
            metavar = str(action.metavar or "")
            if metavar.endswith(FOLDERS):
                action.complete = shtab.DIRECTORY  # type: ignore[attr-defined]
            elif action.type is Path or any(one in metavar for one in FILES):
                action.complete = shtab.FILE  # type: ignore[attr-defined]
