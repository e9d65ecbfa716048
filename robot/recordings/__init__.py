"""Recordings of a real arm, or of what it should do: read from files, and made a reference."""
