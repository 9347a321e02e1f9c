"""Studies: solve many variants of one model, in several processes or on a cluster."""
