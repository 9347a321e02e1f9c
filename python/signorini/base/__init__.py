"""What all else stands on: files, memory, arguments, pickling."""
