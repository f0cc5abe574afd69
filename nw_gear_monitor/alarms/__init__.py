"""Baselines learned per operating bin and alarms against them; pure but for `store`, which reads and writes files."""
