"""Clauses of design codes: functions of numbers and arrays, each with the number of its clause."""
"""Clauses of design codes, one function for each, in the units of the code: N, mm and MPa."""
