"""What a log with torques knows of the arm: friction, payload, rotor inertia."""
