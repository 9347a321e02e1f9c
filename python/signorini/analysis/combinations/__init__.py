"""Many combinations on one factor: solved in blocks, each block's columns passed on, envelopes kept."""

from signorini.analysis.combinations.combined import Combined, Sink, Ways, combine

__all__ = ["Combined", "Sink", "Ways", "combine"]
