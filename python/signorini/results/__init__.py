"""Results: fields, reactions and contact states of a plate under one load, or along a load path."""
