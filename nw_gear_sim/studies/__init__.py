"""The paper's studies on the model of the gearbox: many runs, kept in a store that survives interruptions."""
