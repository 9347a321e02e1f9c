"""``python -m signorini`` is the command line."""

from signorini_command import main

if __name__ == "__main__":
    main()
