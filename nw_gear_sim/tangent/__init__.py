"""Variational equations of the gearbox: small deviations carried along a trajectory, and their exponents."""
