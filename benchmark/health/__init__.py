"""A month of a healthy gearbox before the alarms: recorded, described by its statistics, drawn again at length."""
