"""The slab that tests of load paths follow."""

SLAB = """
title = "Slab on pads"
units = { length = "m", force = "kN" }
material = { E = 30e6, nu = 0.2 }
plate = { shape = "rectangle", size = [4, 4], thickness = 0.2 }
mesh = { divisions = [4, 4] }
support = [
  { name = "pads", at = [[1, 1], [3, 1], [3, 3], [1, 3]], resists = "down" },
  { name = "prop", at = [2, 2], resists = "down", gap = 1e-3 },
]
load = [{ case = "G", pressure = 5 }, { case = "Q", force = 10, at = [3.5, 2.5] }]
combination = [{ name = "service", factors = { G = 1, Q = 1 } }, { name = "nothing", factors = { Q = 0 } }]
probe = [{ at = [[2, 2], [3.5, 3.5]] }]
"""
