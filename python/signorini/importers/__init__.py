"""Conversion of DXF drawings to input files; only the command `import-dxf` uses it."""
