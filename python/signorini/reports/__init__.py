"""The report: one HTML file with checks, results, maps and the input."""
