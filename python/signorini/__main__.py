"""``python -m signorini`` is the command line."""

from signorini.cli import main

if __name__ == "__main__":
    main()
