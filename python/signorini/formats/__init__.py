"""Read and write files: TOML, VTK (.vtu), Parquet, .xlsx."""
