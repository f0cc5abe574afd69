"""What a real monitor would see of the simulated gearbox: accelerometers on the housings, pulses of a tacho.

    bearing force -> housing (`path`) -> sensor, filter, converter (`accelerometer`) -> acceleration
    shaft angle -> pulses (`tacho`)

Nothing here acts back on the gearbox.
"""
