"""DXF drawings to input files; the solver imports nothing from this folder."""
