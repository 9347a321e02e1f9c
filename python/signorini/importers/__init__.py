"""DXF drawings to input files, for the command `import-dxf` only."""
