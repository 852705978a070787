"""Readers of the three binary formats of the ZD-065."""
