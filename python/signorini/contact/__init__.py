"""The contact problem of a plate, the methods that solve it, and the certificate that judges their answers."""
