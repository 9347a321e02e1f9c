"""How far a mesh is from the plate: the same combinations on coarser or finer meshes, its twins."""

from signorini.analysis.twins.twins import Twins

__all__ = ["Twins"]
