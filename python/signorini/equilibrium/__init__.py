"""The plate as a rigid body: whether any reactions balance a load, and how far that is from its end."""
