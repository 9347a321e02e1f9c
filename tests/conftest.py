"""One thread for NumPy's products, as on the command line: workers side by side would wait for each other's cores."""

import os

from signorini_command import POOLS

for pool in POOLS:
    os.environ.setdefault(pool, "1")
