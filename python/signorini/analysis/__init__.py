"""What is asked of a model: results of combinations, load paths, a check before any solve."""
