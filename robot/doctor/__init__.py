"""What is missing or wrong in the description of an arm, and what was assumed."""
