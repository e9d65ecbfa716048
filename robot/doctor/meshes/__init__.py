"""Meshes: where their files are, how large and heavy they are, how they are drawn."""
