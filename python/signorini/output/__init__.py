"""Write results as files: results.json, reactions.csv, a .vtu file and pictures of each combination, a table of all."""

from signorini.output.load_path import path_csv, path_json, write_path
from signorini.output.names import unique_slugs
from signorini.output.tables import reactions_csv, results_json
from signorini.output.writing import write, write_results

__all__ = [
    "path_csv",
    "path_json",
    "reactions_csv",
    "results_json",
    "unique_slugs",
    "write",
    "write_path",
    "write_results",
]
