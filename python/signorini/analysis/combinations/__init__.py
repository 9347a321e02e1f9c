"""Solve many combinations with one factorization, as rows of a table, and extend envelopes by these rows."""

from signorini.analysis.combinations.combined import Combined, Sink, Ways, combine

__all__ = ["Combined", "Sink", "Ways", "combine"]
