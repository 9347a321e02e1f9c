"""Results: fields, reactions and contact of one load, or along a load path."""
