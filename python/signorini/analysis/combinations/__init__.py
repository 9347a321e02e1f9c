"""Many combinations on one factor: solved in blocks, each block's columns passed on, envelopes kept."""

from signorini.analysis.combinations.block import Bearing, Layout
from signorini.analysis.combinations.combined import Combined, combine
from signorini.analysis.combinations.envelope import Concurrent, Extremes

__all__ = ["Bearing", "Combined", "Concurrent", "Extremes", "Layout", "combine"]
