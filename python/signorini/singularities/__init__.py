"""Singularities of a plate, found before it is solved: results that diverge as the mesh is refined."""
