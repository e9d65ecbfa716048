"""What the command line says of recordings."""
