"""The running gearbox."""

from nw_gear_sim.dynamics.simulation import Block, Divergence, Simulation, compile_kernels, steps_per_sample

__all__ = ["Block", "Divergence", "Simulation", "compile_kernels", "steps_per_sample"]
