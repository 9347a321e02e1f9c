"""Derivatives of numbers with respect to parameters of the input, and how far each parameter may move."""
