"""Studies: many variants of one model, solved in several processes or on a cluster."""
