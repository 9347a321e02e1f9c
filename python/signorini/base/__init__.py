"""Utilities without knowledge of plates: files, memory, arguments, pickling, numbers in text."""
