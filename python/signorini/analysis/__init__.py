"""Analyses of a model: combinations, load paths, and checks before a solve."""
