"""The report: one HTML file with interactive maps, offline."""
