"""The command ``frfid``."""

import signal
import sys

from . import _core


def main() -> int:
    """Runs the command line of this process and returns its exit code."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)  # Ctrl-C is the command's own business
    return _core.cli(sys.argv)
