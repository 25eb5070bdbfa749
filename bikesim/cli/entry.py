"""What the program begins with: Ctrl-C while the rest is being imported needs no traceback."""

import sys


def main() -> int:
    """The command line; gives the exit status."""
    try:
        from bikesim.cli.main import main as command_line

        return command_line()
    except KeyboardInterrupt:
        if sys.stderr is not None:
            print("bikesim: interrupted", file=sys.stderr)
        return 130
