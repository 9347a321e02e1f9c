"""Equilibrium of the plate as a rigid body: whether reactions balance a load, and at which factor they no longer do."""
