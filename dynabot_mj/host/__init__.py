"""This computer: files and folders of results, processes, progress, OpenGL, and what works of it.

Comes in: what any program of ours would need of a machine. Knows nothing of robots.
"""
