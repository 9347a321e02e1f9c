"""Run the command line by ``python -m signorini``."""

from signorini_command import main

if __name__ == "__main__":
    main()
