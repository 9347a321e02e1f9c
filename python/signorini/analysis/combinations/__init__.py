"""Solve many combinations with one factorization, pass on their rows in batches, and accumulate envelopes."""

from signorini.analysis.combinations.combined import Combined, Sink, Ways, combine

__all__ = ["Combined", "Sink", "Ways", "combine"]
