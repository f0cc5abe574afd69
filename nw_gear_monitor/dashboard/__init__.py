"""The live page: what came in is kept in buffers of fixed size, and every browser that looks gets what is new in them.

No ROS here: the node hands messages in as tables and numbers, and takes requests for parameters and services out.
"""
