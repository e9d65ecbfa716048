"""An experiment that works with any arm: motion, disturbance and gains of the arm's own size."""
