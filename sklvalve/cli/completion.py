# SPDX-License-Identifier: BSD-3-Clause
"""``sklvalve completion``: a script by which a shell completes commands, options and files on Tab."""

from argparse import ArgumentParser, Namespace, RawDescriptionHelpFormatter, _SubParsersAction

SHELLS = ("bash", "zsh", "fish")
_EXAMPLES = """examples:
  bash   sklvalve completion bash > ~/.local/share/bash-completion/completions/sklvalve
  zsh    sklvalve completion zsh > "${fpath[1]}/_sklvalve"
  fish   sklvalve completion fish > ~/.config/fish/completions/sklvalve.fish

It holds from the next shell on; for this one: eval "$(sklvalve completion bash)"
"""
# what the words of the help stand for
_FILES = ("RECORDING", "EXPORT", "VALVE.toml", "MODEL.skops", "FILE", "FILE.csv")
_FOLDERS = ("DIR",)


def add_parser(commands) -> None:
    """Declare the command."""
    parser = commands.add_parser(
        "completion",
        help="print a script for completion by Tab",
        description="Print a script by which a shell completes commands, options, their choices and names of "
        "files.",
        epilog=_EXAMPLES,
        formatter_class=RawDescriptionHelpFormatter,
    )
    parser.add_argument("shell", choices=SHELLS, help="which shell it is for")
    parser.set_defaults(run=run)


def run(args: Namespace) -> int:
    """Print the script."""
    from sklvalve.cli.entry import build_parser

    # shtab and not argcomplete: its script is static, so that Tab starts no Python
    try:
        import shtab
    except ImportError:
        raise ImportError('the completion needs shtab: pip install "sklvalve[cli]"') from None
    parser = build_parser()
    _prepare(parser, shtab.FILE, shtab.DIRECTORY)
    print(shtab.complete(parser, shell=args.shell))
    return 0


def _prepare(parser: ArgumentParser, file: dict, folder: dict) -> None:
    """Say where names of files and folders are completed; commands are described by their short help."""
    for action in parser._actions:
        if isinstance(action, _SubParsersAction):
            for listed in action._choices_actions:
                command = action.choices[listed.dest]
                command.description = listed.help
                _prepare(command, file, folder)
        elif action.metavar in _FILES + _FOLDERS:
            action.complete = file if action.metavar in _FILES else folder  # type: ignore[attr-defined]
