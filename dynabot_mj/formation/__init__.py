"""The task: the leader, where robots start, the law that they follow, and what a trial is judged by.

Comes in: what is true of any robots that form around a leader. Knows neither studies nor the loop.
"""
