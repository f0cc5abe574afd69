"""State of any vibration signal: period n, quasi-periodic or chaotic, with the noise estimated from the signal."""
