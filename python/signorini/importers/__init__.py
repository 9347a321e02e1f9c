"""Conversion of DXF drawings to input files, for the command `signorini import-dxf`."""
