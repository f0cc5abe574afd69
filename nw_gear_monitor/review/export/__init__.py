"""What `nw_gear review --format parquet|csv|json` writes: the data of a recording for other programs."""
