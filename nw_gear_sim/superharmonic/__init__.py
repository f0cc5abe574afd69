"""Superharmonic resonance 3 nu = w0 of one gear pair under delayed feedback (paper Sec. 5).

`pair` holds the parameters, `firstorder` the solution by multiple scales with its stability, `harmonics` the periodic
orbits of the delay equation itself and `floquet` their exponents, `direct` integrates it, `claims` tests what the paper
says in words. No ROS, no gearbox model: a gear pair here is one cubic oscillator.
"""
