"""Words that everybody uses: arrays, frames, streams of random numbers, exceptions, intervals, tables, legends.

Comes in: what several rooms say and none owns. Imports the libraries and nothing of ours.
"""
