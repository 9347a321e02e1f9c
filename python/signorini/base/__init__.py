"""General utilities: checks of arguments, atomic writing of files, memory, pickling, numbers in text."""
