"""Files of other formats: TOML, .vtu, Parquet."""
