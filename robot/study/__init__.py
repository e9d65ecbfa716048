"""Many runs that answer one question: which knob, which way, how far."""
