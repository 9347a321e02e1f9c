"""Many combinations on one factor: solved in blocks, each block's columns passed on, envelopes kept."""

from signorini.analysis.combinations.combined import Combined, Sink, combine

__all__ = ["Combined", "Sink", "combine"]
