"""Clauses of design codes, one function for each, in the units of the code: N, mm and MPa."""
