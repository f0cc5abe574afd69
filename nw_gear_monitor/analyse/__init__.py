"""`nw_gear analyse`: indicators and state of a signal in anybody's file."""
