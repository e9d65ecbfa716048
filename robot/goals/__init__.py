"""What a response has to keep to, and over which unknowns."""
