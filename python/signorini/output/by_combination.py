"""Numbers of supports, checks and punched columns in every combination."""

from __future__ import annotations

import numpy as np

from signorini.analysis.results import Results
from signorini.discretise.rows import Floats
from signorini.results.quantities import Number


def by_combination(results: Results) -> list[tuple[Number, Floats]]:
    """Numbers with their values (k,) in the k combinations; empty if the table of all combinations is not stored.

    Listed are the numbers of whole supports, and the utilisations of checks and of punched columns.
    """
    stored = results.combined.rows or {}
    wanted = [one for one in results.combined.layout.catalogue if one.home == "support" or one.what == "utilisation"]
    return [(one, np.asarray(stored[one.column], np.float64)) for one in wanted if one.column in stored]
