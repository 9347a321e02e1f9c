"""Many combinations on one factor: solved in blocks, each block's columns passed on, envelopes kept."""

from signorini.analysis.combinations.combined import Combined, Extremes, Layout, Sink, combine

__all__ = ["Combined", "Extremes", "Layout", "Sink", "combine"]
