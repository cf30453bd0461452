"""The command ``simcompare``, also ``python -m simcompare``.

What follows takes a second to be imported. Ctrl-C before it is there ends the process at once:
nothing has begun yet.
"""

from __future__ import annotations

import os
import signal


def _leave(*_: object) -> None:
    os.write(2, b"simcompare: interrupted\n")
    os._exit(130)


def main() -> None:
    """Entry point of the command."""
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, _leave)
    from simcompare.cli import main as command

    command()


if __name__ == "__main__":
    main()
