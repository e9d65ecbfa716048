"""A URDF as it is read, with the line of each element, and what is found about it."""
