"""Mesh error: comparison of numbers on several meshes, and refinement to a requested accuracy."""
