"""What happens to a recorder under fire, as functions that tests and `benchmark/recorder_under_fire.py` call alike."""
