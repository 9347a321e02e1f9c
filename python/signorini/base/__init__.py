"""Foundations: files, memory, arguments, pickling."""
