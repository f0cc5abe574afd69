"""Readers of files of samples: CSV, NPY, WAV, MAT; each refuses what it can't read in one line."""
