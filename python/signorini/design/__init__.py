"""Clauses of design codes: functions of numbers and arrays, each with the number of its clause."""
