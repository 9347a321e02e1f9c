"""``python -m signorini`` is the command line."""

import sys


def main() -> None:
    """Run the command line; Ctrl-C ends it with a word also while its modules are read."""
    try:
        from signorini.cli import main as run

        run()
    except KeyboardInterrupt:
        sys.stderr.write("Interrupted; nothing is written.\n")
        sys.exit(130)


if __name__ == "__main__":
    main()
