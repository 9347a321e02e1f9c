"""Run the command line when the package is started by ``python -m signorini``."""

from signorini_command import main

if __name__ == "__main__":
    main()
