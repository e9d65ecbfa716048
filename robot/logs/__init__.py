"""Logs of the real arm beside the simulated lanes."""
