"""What is found: fields, reactions and contact of one load, or along a load that grows."""
