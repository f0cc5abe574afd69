"""What the simulator and the monitor share: names, quantities, tables, errors and the thin rim to ROS."""

__version__ = "0.1.0"
