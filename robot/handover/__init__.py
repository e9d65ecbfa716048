"""What is handed over to whoever runs tuned gains on a real controller: code, gains, conditions."""
