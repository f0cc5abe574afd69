"""Which faults the monitor finds, and how small."""
